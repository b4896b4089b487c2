"""The actions of one cycle on their way, and what came back of them."""

from typing import Dict, List, Set, Tuple

from clingo import Symbol

from rosoclingo.reasoning.keywords import Action, Return


class ReturnError(ValueError):
    """A return that answers no action that is under way; the text says why."""


class _Group:
    """The actions of one interface in one cycle: a return names its action only on success, so failures are counted."""

    def __init__(self) -> None:
        self.actions: Dict[Symbol, Action] = {}
        self.answered: Set[Symbol] = set()
        self.failures = 0

    @property
    def missing(self) -> List[Action]:
        """As many unanswered actions as returns are still to come."""
        unanswered = [action for parameter, action in self.actions.items() if parameter not in self.answered]
        return unanswered[: len(self.actions) - len(self.answered) - self.failures]

    def take(self, value: Symbol) -> None:
        if not self.missing:
            raise ReturnError("every action of this interface has returned already")
        if value in self.answered:
            raise ReturnError("this action has returned already")
        if value in self.actions:
            self.answered.add(value)
        else:
            self.failures += 1


class Dispatch:
    """The actions of ``cycle``, sent out at ``started`` (seconds). The cycle ends when each has returned.

    On success the value returned is the action's parameter; any other value is a failure of one of the interface's
    actions.
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
    def complete(self) -> bool:
        """Whether each action has returned."""
        return not self.missing

    def take(self, answer: Return) -> None:
        """Count a return; raises ReturnError when it answers none of the actions under way."""
        if answer.cycle != self.cycle:
            raise ReturnError(f"it is cycle {self.cycle} now")
        if answer.interface not in self._groups:
            raise ReturnError(f"no action of '{answer.interface}' is under way in cycle {self.cycle}")
        self._groups[answer.interface].take(answer.value)
