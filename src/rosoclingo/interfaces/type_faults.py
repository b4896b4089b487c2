"""Interfaces against the definitions of messages: types that cannot be loaded, fields and constants that they lack.

Needs genpy only.
"""

from typing import Any, List, Tuple

import genpy

from rosoclingo.interfaces.answers import Rule, pattern_of
from rosoclingo.interfaces.config import ConfigError, InterfaceSpec
from rosoclingo.interfaces.message_filling import field_faults, field_types
from rosoclingo.interfaces.templates import references
from rosoclingo.interfaces.world_checks import check_faults


def load_action(spec: InterfaceSpec) -> Any:
    """Return an empty message of the action type; raises ConfigError."""
    return loaded(spec.type, f"{spec.name}.type", "action")()


def loaded(name: str, place: str, kind: str = "message") -> Any:
    """Return the class of a message or action; raises ConfigError."""
    try:
        found = genpy.message.get_message_class(name)
    except (ImportError, ValueError) as error:
        raise ConfigError(f"{place}: {name} cannot be loaded: {error}") from error
    if found is None:
        raise ConfigError(f"{place}: no {kind} {name} on the Python path; is its package installed, built and sourced?")
    return found


def type_faults(spec: InterfaceSpec) -> List[str]:
    """What of an entry does not fit its types, each fault with its place; nothing where it names no type."""
    return [*_action_faults(spec), *_done_faults(spec)]


def _done_faults(spec: InterfaceSpec) -> List[str]:
    if spec.done is None or not spec.done.type:
        return []
    try:
        message = loaded(spec.done.type, f"{spec.name}.done.type")()
    except ConfigError as error:
        return [str(error)]
    return check_faults(message, spec.done.when, f"{spec.name}.done.when")


def _action_faults(spec: InterfaceSpec) -> List[str]:
    if not spec.type:
        return []
    try:
        action = load_action(spec)
    except ConfigError as error:
        return [str(error)]
    faults = field_faults(action.action_goal.goal, spec.goal, f"{spec.name}.goal")
    for index, rule in enumerate(spec.rules):
        faults += _rule_faults(rule, action.action_result.result, f"{spec.name}.returns[{index}]")
    return faults


def _rule_faults(rule: Rule, result: Any, place: str) -> List[str]:
    types = field_types(result)
    missing = dict.fromkeys(name for name in _result_fields(rule) if name not in types)
    faults = [
        f"{place}: {result._type} has no field {name}; it has {', '.join(types) or 'no fields'}" for name in missing
    ]
    for name, wanted in rule.when.items():
        number = types.get(name, "").rstrip("0123456789") in ("int", "uint", "byte", "char")
        if number and isinstance(wanted, str) and pattern_of(wanted) is None and not hasattr(type(result), wanted):
            known = ", ".join(name for name in dir(type(result)) if name.isupper()) or "none"
            faults.append(f"{place}.when.{name}: {result._type} has no constant {wanted}; its constants are {known}")
    return faults


def _result_fields(rule: Rule) -> Tuple[str, ...]:
    texts = [text for text in (rule.returns, *rule.facts) if isinstance(text, str)]
    used = [reference.split(".") for text in texts for reference in references(text)]
    named = [steps[1] for steps in used if steps[0] == "result" and len(steps) > 1]
    return (*(name.split(".")[0] for name in rule.when), *named)
