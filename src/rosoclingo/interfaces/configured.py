"""Interfaces without code: an entry of config/interfaces.yaml drives any actionlib action."""

import functools
from pathlib import Path
from typing import Any, Mapping, Optional

import rospy

from rosoclingo.common.labels import LabelTable, UnknownLabelError
from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.answers import Answer, answer
from rosoclingo.interfaces.base import DEFAULT_MEMORY, Interface, RefusalError
from rosoclingo.interfaces.config import ConfigError, Done, InterfaceSpec
from rosoclingo.interfaces.doubt import Check
from rosoclingo.interfaces.message_filling import FieldError, fill
from rosoclingo.interfaces.templates import Ended, FillError, Scope, evaluate
from rosoclingo.interfaces.type_faults import load_action, loaded, type_faults
from rosoclingo.interfaces.world import Watch, watch
from rosoclingo.interfaces.world_checks import holds
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
        action = load_action(spec)
        self._spec = _with_values(spec, action.action_result.result)
        self._labels = labels
        self._watch = watch(spec.done.topic, loaded(spec.done.type, f"{spec.name}.done.type")) if spec.done else None
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


def _with_values(spec: InterfaceSpec, result: Any) -> InterfaceSpec:
    """The spec with the names of result constants replaced by their values."""
    return spec._replace(rules=tuple(rule._replace(when=_with_constants(rule.when, result)) for rule in spec.rules))


def _with_constants(when: Mapping[str, Any], result: Any) -> Mapping[str, Any]:
    """A condition `{outcome: NOT_HERE}` may name a constant of the result type."""
    return {
        field: getattr(type(result), value)
        if isinstance(value, str) and value.isupper() and hasattr(type(result), value)
        else value
        for field, value in when.items()
    }
