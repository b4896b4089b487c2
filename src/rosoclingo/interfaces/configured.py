"""Interfaces without code, each described by an entry of config/interfaces.yaml."""

import functools
from pathlib import Path
from typing import Any, Optional

import rospy

from rosoclingo.common.labels import LabelTable, UnknownLabelError
from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.answers import Answer, Rule, answer
from rosoclingo.interfaces.attempt import Check
from rosoclingo.interfaces.base import DEFAULT_MEMORY, Interface, RefusalError
from rosoclingo.interfaces.config import InterfaceSpec
from rosoclingo.interfaces.message_filling import FieldError, fill
from rosoclingo.interfaces.templates import ActionScope, FillError, GoalEnd, evaluate
from rosoclingo.interfaces.type_faults import load_type
from rosoclingo.interfaces.world import watch
from rosoclingo.reasoning.keywords import Action


class ConfiguredInterface(Interface):
    """An interface described by an InterfaceSpec (see doc/interfaces.md).

    Check the types of the entry with :func:`type_faults` first; a type that cannot be loaded raises ConfigError.
    Topics and returns are those of Interface.
    """

    def __init__(
        self, spec: InterfaceSpec, labels: LabelTable, *, worker: Worker, memory: Optional[Path] = DEFAULT_MEMORY
    ) -> None:
        action = load_type(spec.type, spec.name)()
        rules = tuple(_with_constants(rule, action.action_result.result) for rule in spec.rules)
        self._spec = spec._replace(rules=rules)
        self._labels = labels
        self._watch = watch(spec.done.topic, load_type(spec.done.type, f"{spec.name}.done.type")) if spec.done else None
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
        """Return the goal message, filled from the entry's `goal`."""
        scope = ActionScope(action.parameter, action.cycle, self._labels)
        try:
            return fill(self._goal_class(), evaluate(self._spec.goal, scope), rospy.get_rostime())
        except UnknownLabelError as error:
            raise RefusalError("unknown_label", str(error)) from error
        except (FillError, FieldError) as error:
            raise RefusalError("bad_parameter", str(error)) from error

    def make_answer(self, action: Action, ended: GoalEnd) -> Answer:
        """Return the answer by the entry's `returns`."""
        return answer(self._spec.rules, ActionScope(action.parameter, action.cycle, self._labels, ended))

    def make_check(self, action: Action) -> Optional[Check]:
        """Return a check of the topic of the entry's `done`."""
        if self._spec.done is None or self._watch is None:
            return None
        scope = ActionScope(action.parameter, action.cycle, self._labels)
        return functools.partial(self._watch.shows, self._spec.done.when, scope)


def _with_constants(rule: Rule, result: Any) -> Rule:
    """Replace names of the result type's constants in a rule by their values, as in `{outcome: NOT_HERE}`."""
    kind = type(result)
    constants = {name: getattr(kind, name) for name in dir(kind) if name.isupper()}
    when = {
        field: constants.get(value, value) if isinstance(value, str) else value for field, value in rule.when.items()
    }
    return rule._replace(when=when)
