"""Interfaces without code: an entry of config/interfaces.yaml drives any actionlib action."""

from typing import Any, Mapping, Tuple

import genpy
import rospy

from rosoclingo.interfaces.answers import Answer, Rule, answer
from rosoclingo.interfaces.base import Interface, RefusalError
from rosoclingo.interfaces.config import ConfigError, InterfaceSpec
from rosoclingo.interfaces.messages import FieldError, check_fields, field_types, fill
from rosoclingo.interfaces.templates import Ended, FillError, Scope, evaluate, references
from rosoclingo.interfaces.worker import Worker
from rosoclingo.reasoning.keywords import Action
from rosoclingo.reasoning.labels import LabelTable, UnknownLabelError


class ConfiguredInterface(Interface):
    """An interface that an InterfaceSpec describes (see config.py for its fields, templates.py for the templates).

    Raises ConfigError if the action type cannot be loaded, or if goal, rules or results name fields that it lacks.
    Topics and returns are those of Interface.
    """

    def __init__(self, spec: InterfaceSpec, labels: LabelTable, *, worker: Worker) -> None:
        action = _load(spec)
        self._spec = _checked(spec, action)
        self._goal_class = type(action.action_goal.goal)
        self._labels = labels
        super().__init__(spec.name, type(action), spec.server, spec.limits, spec.retry_on, worker=worker)

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


def _load(spec: InterfaceSpec) -> Any:
    try:
        action_class = genpy.message.get_message_class(spec.type)
    except (ImportError, ValueError) as error:
        raise ConfigError(f"{spec.name}.type: {spec.type} cannot be loaded: {error}") from error
    if action_class is None:
        message = "{}.type: no action {} on the Python path; is its package installed, built and sourced?"
        raise ConfigError(message.format(spec.name, spec.type))
    return action_class()


def _checked(spec: InterfaceSpec, action: Any) -> InterfaceSpec:
    """The spec with the names of result constants replaced by their values.  Raises ConfigError."""
    result = action.action_result.result
    try:
        check_fields(action.action_goal.goal, spec.goal, f"{spec.name}.goal")
        for index, rule in enumerate(spec.rules):
            _check_rule(rule, result, f"{spec.name}.returns[{index}]")
    except FieldError as error:
        raise ConfigError(str(error)) from error
    return spec._replace(rules=tuple(rule._replace(when=_with_constants(rule.when, result)) for rule in spec.rules))


def _check_rule(rule: Rule, result: Any, place: str) -> None:
    for name in _result_fields(rule):
        if name not in field_types(result):
            known = ", ".join(field_types(result)) or "no fields"
            raise FieldError(f"{place}: {result._type} has no field {name}; it has {known}")


def _result_fields(rule: Rule) -> Tuple[str, ...]:
    texts = [text for text in (rule.returns, *rule.facts) if isinstance(text, str)]
    used = [reference.split(".") for text in texts for reference in references(text)]
    named = [steps[1] for steps in used if steps[0] == "result" and len(steps) > 1]
    return (*(name.split(".")[0] for name in rule.when), *named)


def _with_constants(when: Mapping[str, Any], result: Any) -> Mapping[str, Any]:
    """A condition `{outcome: NOT_HERE}` may name a constant of the result type."""
    return {
        field: getattr(type(result), value)
        if isinstance(value, str) and value.isupper() and hasattr(type(result), value)
        else value
        for field, value in when.items()
    }
