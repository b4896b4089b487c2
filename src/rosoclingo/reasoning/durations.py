"""Durations of actions: the medians of what was observed, as facts ``_takes(A,P,S)`` of the program."""

import math
from collections import OrderedDict
from statistics import median
from typing import Dict, List, Optional, Tuple

from clingo import Function, Number, Symbol

from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.keywords import TAKES, Action
from rosoclingo.reasoning.records import Record, group, symbol_of, text_of

#: Number of the latest durations of an action that count.
LATEST = 9

#: Least number of observations of an action with one parameter, so that identifiers of goals are not learned.
LEAST = 2

#: Greatest number of actions whose durations are remembered.
MOST = 300

#: Stands for all parameters of an interface in ``_takes(A,any,S)``.
ANY = Function("any")


class Durations:
    """Learns the durations of successful actions, by interface and parameter, and by interface alone.

    A median is stated in whole seconds, rounded up. It is stated again once it has changed by more than a quarter.
    """

    def __init__(self, feeder: InputFeeder) -> None:
        self._feeder = feeder
        self._seconds: OrderedDict[Tuple[Symbol, Symbol], List[float]] = OrderedDict()
        self._stated: Dict[Tuple[Symbol, Symbol], int] = {}

    def learn(self, action: Action, seconds: float) -> None:
        """Add the duration of a successful action."""
        for name in (action.name, (action.interface, ANY)):
            known = self._seconds.pop(name, [])
            self._seconds[name] = [*known, seconds][-LATEST:]
        while len(self._seconds) > MOST:
            name, _ = self._seconds.popitem(last=False)
            self._withdraw(name)

    def expected(self, action: Action) -> Optional[float]:
        """Return the expected seconds of an action, None if nothing is known about its interface."""
        known = self._seconds.get(action.name, []), self._seconds.get((action.interface, ANY), [])
        return next((median(one) for one in known if one), None)

    def state(self) -> None:
        """Feed new and changed durations to the program, with the next update."""
        for name, seconds in self._seconds.items():
            found, old = max(1, math.ceil(median(seconds))), self._stated.get(name)
            known = len(seconds) >= LEAST or name[1] == ANY
            if known and (old is None or 4 * abs(found - old) > old):
                self._withdraw(name)
                self._stated[name] = found
                self._feeder.add_fact(_fact(name, found))

    def _withdraw(self, name: Tuple[Symbol, Symbol]) -> None:
        if name in self._stated:
            self._feeder.withdraw_fact(_fact(name, self._stated.pop(name)))

    def record(self) -> Record:
        """Return the state as sections of plain values, one for each action."""
        return {
            f"lasts:{text_of(Function('', list(name)))}": {"seconds": seconds, "stated": self._stated.get(name)}
            for name, seconds in self._seconds.items()
        }

    def restore(self, record: Record) -> None:
        """Restore from a record."""
        for text, value in group(record, "lasts").items():
            interface, parameter = symbol_of(text).arguments
            self._seconds[interface, parameter] = value["seconds"]
            if value["stated"] is not None:
                self._stated[interface, parameter] = value["stated"]


def _fact(name: Tuple[Symbol, Symbol], seconds: int) -> Symbol:
    return Function(TAKES, [*name, Number(seconds)])
