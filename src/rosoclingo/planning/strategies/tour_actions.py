"""The actions of a plan as tours of robots, read from their names.

The arguments of an interface are its robots, as in ``move_base(r1)``. If an action repeats, all actions of its kind are
*moves*, each to the place in its parameter. Other actions are *tasks*.
"""

from collections import Counter
from itertools import groupby
from operator import itemgetter
from statistics import mean
from typing import Dict, Iterable, List, Mapping, NamedTuple, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import ANY
from rosoclingo.planning.history import cycle_of

Robot = Tuple[clingo.Symbol, ...]
"""The arguments of the interfaces of a robot; several ones act together. Empty in a plan with one tour."""

Act = Tuple[clingo.Symbol, clingo.Symbol]
"""An action without robot and cycle: kind and parameter. A move stands for its place."""

Durations = Mapping[clingo.Symbol, float]
"""Kind of actions -> mean duration in seconds; those of other kinds are unknown."""


class TourAction(NamedTuple):
    """An action of a tour."""

    cycle: int
    robot: Robot
    act: Act


def tour_actions(actions: Iterable[clingo.Symbol], by_robot: bool) -> List[TourAction]:
    """Return ``actions`` sorted by cycle, as those of one tour or ``by_robot``."""
    found = []
    for one in sorted(actions, key=cycle_of):
        name, what = one.arguments[:2]
        named = by_robot and name.type is clingo.SymbolType.Function
        robot, kind = (tuple(name.arguments), clingo.Function(name.name)) if named else ((), name)
        found.append(TourAction(cycle_of(one), robot, (kind, what)))
    return found


def moving_kinds(past: Sequence[TourAction], rest: Sequence[TourAction]) -> Set[clingo.Symbol]:
    """Return the kinds of moves in the ``rest`` of a plan; if no action repeats there, those of the whole plan."""
    return _repeated(rest) or _repeated([*past, *rest])


def _repeated(actions: Sequence[TourAction]) -> Set[clingo.Symbol]:
    by_robot = groupby(sorted(actions, key=itemgetter(1, 0)), key=itemgetter(1, 2))
    counts = Counter(act for (_, act), _ in by_robot)  # an action that goes on is chosen again in each cycle
    return {kind for (kind, _), count in counts.items() if count > 1}


def durations_of(facts: Iterable[clingo.Symbol]) -> Durations:
    """Return the durations in the facts ``_takes(A,any,S)``: the mean of all robots. Other facts are ignored."""
    seconds: Dict[clingo.Symbol, List[int]] = {}
    for name, what, number in (one.arguments for one in facts):
        types = name.type, number.type
        if what == ANY and types == (clingo.SymbolType.Function, clingo.SymbolType.Number) and number.number >= 0:
            seconds.setdefault(clingo.Function(name.name), []).append(number.number)
    return {kind: mean(some) for kind, some in seconds.items()}
