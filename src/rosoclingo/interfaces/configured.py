"""Interfaces without code: an entry of config/interfaces.yaml drives any actionlib action."""

import functools
from pathlib import Path
from typing import Any, List, Mapping, Optional, Tuple

import genpy
import rospy

from rosoclingo.common.labels import LabelTable, UnknownLabelError
from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.answers import Answer, Rule, answer, pattern_of
from rosoclingo.interfaces.base import DEFAULT_MEMORY, Interface, RefusalError
from rosoclingo.interfaces.config import ConfigError, Done, InterfaceSpec
from rosoclingo.interfaces.doubt import Check
from rosoclingo.interfaces.message_filling import FieldError, field_faults, field_types, fill
from rosoclingo.interfaces.templates import Ended, FillError, Scope, TemplateError, evaluate, references
from rosoclingo.interfaces.world import Watch, watch
from rosoclingo.interfaces.world_checks import check_faults, holds
from rosoclingo.reasoning.keywords import Action


class ConfiguredInterface(Interface):
    """An interface that an InterfaceSpec describes (see config.py for its fields, templates.py for the templates).

    Raises ConfigError, listing all faults, if the action type cannot be loaded or is not as the entry says.
    Topics and returns are those of Interface.
    """

    def __init__(
        self, spec: InterfaceSpec, labels: LabelTable, *, worker: Worker, memory: Optional[Path] = DEFAULT_MEMORY
    ) -> None:
        faults = type_faults(spec)
        if faults:
            raise ConfigError("\n".join(faults))
        action = _load(spec)
        self._spec = _with_values(spec, action.action_result.result)
        self._labels = labels
        self._watch = watch(spec.done.topic, _loaded(spec.done.type, f"{spec.name}.done.type")) if spec.done else None
        super().__init__(
            spec.name,
            type(action),
            spec.server,
            spec.limits,
            spec.retry_on,
            worker=worker,
            repeatable=spec.repeatable,
            memory=memory,
        )

    def make_goal(self, action: Action) -> Any:
        """The goal message, filled as the entry's `goal` says."""
        scope = Scope(action.parameter, action.cycle, self._labels)
        try:
            return fill(self._goal_class(), evaluate(self._spec.goal, scope), rospy.get_rostime())
        except UnknownLabelError as error:
            raise RefusalError("unknown_label", str(error)) from error
        except (FillError, FieldError) as error:
            raise RefusalError("bad_parameter", str(error)) from error

    def make_answer(self, action: Action, ended: Ended) -> Answer:
        """The answer that the entry's `returns` says."""
        return answer(self._spec.rules, Scope(action.parameter, action.cycle, self._labels, ended))

    def make_check(self, action: Action) -> Optional[Check]:
        """What looks at the topic that the entry's `done` names."""
        if self._spec.done is None or self._watch is None:
            return None
        return functools.partial(self._is_done, self._spec.done, self._watch, action)

    def _is_done(self, done: Done, seen: Watch, action: Action) -> Optional[bool]:
        message = seen.latest
        return (
            None if message is None else holds(message, done.when, Scope(action.parameter, action.cycle, self._labels))
        )


def _load(spec: InterfaceSpec) -> Any:
    return _loaded(spec.type, f"{spec.name}.type", "action")()


def _loaded(name: str, place: str, kind: str = "message") -> Any:
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
        message = _loaded(spec.done.type, f"{spec.name}.done.type")()
    except ConfigError as error:
        return [str(error)]
    return check_faults(message, spec.done.when, f"{spec.name}.done.when")


def _action_faults(spec: InterfaceSpec) -> List[str]:
    if not spec.type:
        return []
    try:
        action = _load(spec)
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


def _with_values(spec: InterfaceSpec, result: Any) -> InterfaceSpec:
    """The spec with the names of result constants replaced by their values."""
    return spec._replace(rules=tuple(rule._replace(when=_with_constants(rule.when, result)) for rule in spec.rules))


def _result_fields(rule: Rule) -> Tuple[str, ...]:
    texts = [text for text in (rule.returns, *rule.facts) if isinstance(text, str)]
    used = [reference.split(".") for text in texts for reference in _references(text)]
    named = [steps[1] for steps in used if steps[0] == "result" and len(steps) > 1]
    return (*(name.split(".")[0] for name in rule.when), *named)


def _references(text: str) -> List[str]:
    """The references of a text; none of one that is malformed, which is told already."""
    try:
        return references(text)
    except TemplateError:
        return []


def _with_constants(when: Mapping[str, Any], result: Any) -> Mapping[str, Any]:
    """A condition `{outcome: NOT_HERE}` may name a constant of the result type."""
    return {
        field: getattr(type(result), value)
        if isinstance(value, str) and value.isupper() and hasattr(type(result), value)
        else value
        for field, value in when.items()
    }
