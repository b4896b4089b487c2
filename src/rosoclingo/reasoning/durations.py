"""Durations of actions: the medians of what was observed, as facts ``_takes(A,P,S)`` of the program."""

import math
from statistics import median
from typing import Dict, NamedTuple, Optional, Tuple

from clingo import Function, Number, Symbol

from rosoclingo.oclingo.program.action_rules import ANY
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.keywords import TAKES, Action
from rosoclingo.reasoning.records import PersistentPart, tables

#: Number of the latest durations of an action that count.
LATEST = 9

#: Least number of observations of an action with one parameter, so that identifiers of goals are not learned.
LEAST = 2

#: Greatest number of actions whose durations are remembered.
MOST = 300


class _Statistics(NamedTuple):
    """The latest durations of an action in seconds, and the stated one, None for none."""

    seconds: Tuple[float, ...] = ()
    stated: Optional[int] = None


class Durations(PersistentPart):
    """Learns the durations of successful actions, by interface and parameter, and by interface alone.

    A median is stated in whole seconds, rounded up. It is stated again once it has changed by more than a quarter.
    """

    GROUP = "durations"
    TABLES = tables(_known=("lasts", Symbol, _Statistics))

    def __init__(self, feeder: InputFeeder) -> None:
        self._feeder = feeder
        self._known: Dict[Symbol, _Statistics] = {}  # by the term (A,P), the latest ones last

    def learn(self, action: Action, seconds: float) -> None:
        """Add the duration of a successful action."""
        for name in _names(action):
            before = self._known.pop(name, _Statistics())
            self._known[name] = before._replace(seconds=(*before.seconds, seconds)[-LATEST:])
        while len(self._known) > MOST:
            oldest = next(iter(self._known))
            self._withdraw(oldest, self._known.pop(oldest))

    def expected(self, action: Action) -> Optional[float]:
        """Return the expected seconds of an action, None if nothing is known about its interface."""
        known = (self._known[name] for name in _names(action) if name in self._known)
        return next((median(one.seconds) for one in known), None)

    def state(self) -> None:
        """Feed new and changed durations to the program, with the next update."""
        for name, one in self._known.items():
            found, known = max(1, math.ceil(median(one.seconds))), len(one.seconds) >= LEAST or name.arguments[1] == ANY
            if known and (one.stated is None or 4 * abs(found - one.stated) > one.stated):
                self._withdraw(name, one)
                self._known[name] = one._replace(stated=found)
                self._feeder.add_fact(_fact(name, found))

    def _withdraw(self, name: Symbol, one: _Statistics) -> None:
        if one.stated is not None:
            self._feeder.withdraw_fact(_fact(name, one.stated))


def _names(action: Action) -> Tuple[Symbol, Symbol]:
    """Return the terms of an action with its parameter, and with any parameter."""
    return Function("", [action.interface, action.parameter]), Function("", [action.interface, ANY])


def _fact(name: Symbol, seconds: int) -> Symbol:
    return Function(TAKES, [*name.arguments, Number(seconds)])
