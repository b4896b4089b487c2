"""The actions of one cycle on their way, and what came back of them."""

from typing import Dict, List, Optional, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.reasoning.keywords import Action, Return


class ReturnError(ValueError):
    """A return that answers no action that is under way; the text says why."""


class _Group:
    """The actions of one interface in one cycle. Failures that name no action are counted."""

    def __init__(self) -> None:
        self.actions: Dict[Symbol, Action] = {}
        self._answers: Dict[Symbol, Symbol] = {}  # an action's parameter -> the value that named it
        self._failures: List[Symbol] = []

    @property
    def missing(self) -> List[Action]:
        """As many unanswered actions as returns are still to come."""
        return self._unanswered[: len(self.actions) - len(self._answers) - len(self._failures)]

    @property
    def failed(self) -> List[Tuple[Symbol, Tuple[Action, ...]]]:
        """Each value that was no success, with the action that it is about, or those that it may be about."""
        named = [(value, (self.actions[key],)) for key, value in self._answers.items() if value != key]
        return [*named, *((value, tuple(self._unanswered)) for value in self._failures)]

    def take(self, value: Symbol) -> None:
        """Count a returned value; raises ReturnError when it answers no action that has not returned."""
        if not self.missing:
            raise ReturnError("every action of this interface has returned already")
        parameter = self._about(value)
        if parameter is None:
            self._failures.append(value)
        elif parameter in self._answers:
            raise ReturnError("this action has returned already")
        else:
            self._answers[parameter] = value

    def expire(self, value: Symbol) -> None:
        """Count ``value`` as the failure of each action that has not returned."""
        self._failures += [value] * len(self.missing)

    @property
    def _unanswered(self) -> List[Action]:
        return [action for parameter, action in self.actions.items() if parameter not in self._answers]

    def _about(self, value: Symbol) -> Optional[Symbol]:
        """The parameter of the action that a value names: itself, or the last argument of ``failed(P)``."""
        if value in self.actions:
            return value
        named = value.type is SymbolType.Function and value.arguments and value.arguments[-1] in self.actions
        return value.arguments[-1] if named else None


class Dispatch:
    """The actions of ``cycle``, sent out at ``started`` (seconds). The cycle ends when each has returned.

    On success the value returned is the action's parameter; any other value is a failure. Where several actions of one
    interface are under way a failure is about the one whose parameter it has as its last argument, ``failed(P)``;
    otherwise about any of those that no other return names.
    """

    def __init__(self, cycle: int, actions: Tuple[Action, ...], started: float) -> None:
        self.cycle = cycle
        self.actions = actions
        self.started = started
        self._groups: Dict[Symbol, _Group] = {}
        for action in actions:
            self._groups.setdefault(action.interface, _Group()).actions[action.parameter] = action

    @property
    def missing(self) -> Tuple[Action, ...]:
        """The actions that have not returned."""
        return tuple(action for group in self._groups.values() for action in group.missing)

    @property
    def failures(self) -> List[Tuple[Return, Tuple[Action, ...]]]:
        """The returns that were no success, each with the actions that it may be about."""
        return [
            (Return(interface, value, self.cycle), actions)
            for interface, group in self._groups.items()
            for value, actions in group.failed
        ]

    def take(self, answer: Return) -> None:
        """Count a return; raises ReturnError when it answers none of the actions under way."""
        if answer.cycle != self.cycle:
            raise ReturnError(f"it is cycle {self.cycle} now")
        if answer.interface not in self._groups:
            raise ReturnError(f"no action of '{answer.interface}' is under way in cycle {self.cycle}")
        self._groups[answer.interface].take(answer.value)

    def expire(self, value: Symbol) -> Tuple[Action, ...]:
        """Count the actions that have not returned as failed with ``value``, whatever it names; return them."""
        expired = self.missing
        for group in self._groups.values():
            group.expire(value)
        return expired
