"""The rest of a plan when some of its actions take longer: each robot acts as early as the order of the plan allows.

Each robot keeps the order of its actions, and tasks with the same parameter keep theirs. A move waits for all moves
that leave its place at earlier steps of the plan. So robots meet only where they meet in the plan: when the last of
several robots, in the order of the plan, comes to a place, the plan has all of them there.

Moves and tasks are read from names, see tour_actions.py, which can be wrong, so the solver checks the result.
"""

from collections import defaultdict
from itertools import groupby
from typing import Dict, Iterable, Iterator, List, Sequence

import clingo

from rosoclingo.planning.history import Plan, cycle_of, delay, going_on
from rosoclingo.planning.strategies.tour_actions import Act, TourAction, moving_kinds, tour_actions

UNNAMED = (clingo.Infimum,)
"""The robot of interfaces without arguments."""


def rescheduled(plan: Plan, running: Iterable[clingo.Symbol], step: int) -> Plan:
    """Return ``plan`` from ``step`` on, in which ``running`` actions go on and the others are as early as possible.

    ``running`` are ``_running`` atoms of the cycle before. No action is more than one step later than in ``plan``.
    """
    going = going_on(running, step)
    begun = {tuple(one.arguments[:2]) for one in going}
    past = [one for one in plan.actions if cycle_of(one) < step and tuple(one.arguments[:2]) not in begun]
    rest = sorted(going.union(plan.rest(step).delayed().actions), key=cycle_of)
    cycles: List[int] = []
    for before in waits(tour_actions(past, by_robot=True), tour_actions(rest, by_robot=True)):
        cycles.append(max((cycles[number] + 1 for number in before), default=step))
    actions = frozenset(delay(one, cycle - cycle_of(one)) for one, cycle in zip(rest, cycles))
    return Plan(actions, plan.horizon + max(cycles, default=step) - max(plan.last_cycle, step - 1))


def beginnings(plan: Plan, running: Iterable[clingo.Symbol], step: int) -> List[clingo.Symbol]:
    """Return the next actions of the robots that wait, moved to ``step``; none if an action of ``plan`` begins there.

    ``running`` are ``_running`` atoms of the cycle before.
    """
    nexts: Dict[clingo.Symbol, clingo.Symbol] = {}
    actions = sorted(plan.rest(step).actions, key=cycle_of)
    for action, one in reversed([*zip(actions, tour_actions(actions, by_robot=True))]):
        nexts.update(dict.fromkeys(one.robot or UNNAMED, action))
    waiting = {*nexts.values()} - going_on(running, step)
    if any(cycle_of(one) == step for one in waiting):
        return []
    return sorted(delay(one, step - cycle_of(one)) for one in waiting)


def waits(past: Sequence[TourAction], rest: Sequence[TourAction]) -> Iterator[List[int]]:
    """Yield for each action of ``rest``, which follows the ``past``, the numbers of those that it waits for."""
    moving = moving_kinds(past, rest)
    places = {robot: one.act for one in past if one.act[0] in moving for robot in one.robot or UNNAMED}
    last: Dict[object, List[int]] = {}  # robot or parameter of a task -> the numbers of its last actions
    left: Dict[Act, List[int]] = defaultdict(list)  # place -> the numbers of the moves that left it
    for _, group in groupby(enumerate(rest), key=lambda one: one[1].cycle):
        acting: Dict[object, List[int]] = defaultdict(list)
        leaving = []
        for number, (_, robot, act) in group:
            robots, moves = robot or UNNAMED, act[0] in moving
            keys = [*robots, *(() if moves else act[1:])]
            yield [*left.get(act, ()), *(before for key in keys for before in last.get(key, ()))]
            for key in keys:
                acting[key].append(number)
            leaving += [(one, act, number) for one in robots if moves and places.get(one) != act]
        last.update(acting)
        for one, act, number in leaving:
            if one in places:
                left[places[one]].append(number)
            places[one] = act
