"""Check interfaces against message definitions: missing types, fields and constants.

Needs genpy only.
"""

from typing import Any, List

import genpy

from rosoclingo.interfaces.answers import Rule, pattern_of
from rosoclingo.interfaces.config import ConfigError, InterfaceSpec
from rosoclingo.interfaces.message_filling import field_faults, field_types
from rosoclingo.interfaces.templates import references


def load_type(name: str, place: str, kind: str = "message") -> Any:
    """Return the class of a message or action; raises ConfigError."""
    try:
        found = genpy.message.get_message_class(name)
    except (ImportError, ValueError) as error:
        raise ConfigError(f"{place}: {name} cannot be loaded: {error}") from error
    if found is None:
        raise ConfigError(f"{place}: no {kind} {name} on the Python path; is its package installed, built and sourced?")
    return found


def type_faults(spec: InterfaceSpec) -> List[str]:
    """Return the faults of an entry against its message types, each with its place; none without a type."""
    faults: List[str] = []
    for look in (_action_faults, _done_faults):
        try:
            faults += look(spec)
        except ConfigError as error:
            faults.append(str(error))
    return faults


def _done_faults(spec: InterfaceSpec) -> List[str]:
    if spec.done is None or not spec.done.type:
        return []
    message = load_type(spec.done.type, f"{spec.key}.done.type")()
    return field_faults(message, spec.done.when, f"{spec.key}.done.when")


def _action_faults(spec: InterfaceSpec) -> List[str]:
    if not spec.type:
        return []
    action = load_type(spec.type, f"{spec.key}.type", "action")()
    faults = field_faults(action.action_goal.goal, spec.goal, f"{spec.key}.goal")
    for index, rule in enumerate(spec.rules):
        faults += _rule_faults(rule, action.action_result.result, f"{spec.key}.returns[{index}]")
    return faults


def _rule_faults(rule: Rule, result: Any, place: str) -> List[str]:
    types = field_types(result)
    texts = [text for text in (rule.returns, *rule.facts) if isinstance(text, str)]
    used = [reference.split(".") for text in texts for reference in references(text)]
    named = [*(name.split(".")[0] for name in rule.when), *(one[1] for one in used if one[0] == "result" and one[1:])]
    known = ", ".join(types) or "no fields"
    missing = [name for name in dict.fromkeys(named) if name not in types]
    faults = [f"{place}: {result._type} has no field {name}; it has {known}" for name in missing]
    for name, wanted in rule.when.items():
        number = types.get(name, "").rstrip("0123456789") in ("int", "uint", "byte", "char")
        if number and isinstance(wanted, str) and pattern_of(wanted) is None and not hasattr(type(result), wanted):
            known = ", ".join(name for name in dir(type(result)) if name.isupper()) or "none"
            faults.append(f"{place}.when.{name}: {result._type} has no constant {wanted}; its constants are {known}")
    return faults
