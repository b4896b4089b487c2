"""Candidates for better plans: the same tasks in another order. The solver checks whether a candidate is a plan.

The plan is read as a tour of moves and tasks, see tour_actions.py; if it has several actions at a step, as one tour for
each robot. Tasks are done at the place of the last move. Tasks with the same parameter, such as a pickup and a
delivery, form a *chain*: one robot does them, in the order of the plan. A chain is open from its first to its last
task; in a candidate, no robot has more open chains than one has in the plan. Moves use the connections of the plan, and
the first moves that the program allows. Most searches are optimistic: connections lead in both directions and those of
earlier moves are open, robots without actions in the plan are in service, and moves at the end of the plan, which can
make way for others, are superfluous. The last task of a chain is done when its robot first comes to its place.

The search is ruin and recreate (Schrimpf et al. 2000): it removes some chains with nearby tasks (Shaw 1998) and inserts
each where it costs least. Like simulated annealing, it also accepts tours that cost slightly more.
"""

import math
from collections import deque
from functools import lru_cache
from itertools import accumulate
from operator import itemgetter
from random import Random
from statistics import mean
from typing import Callable, Dict, Iterator, List, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import Stop
from rosoclingo.planning.strategies.keep_order import waits
from rosoclingo.planning.strategies.tour_actions import Act, Durations, TourAction, moving_kinds, tour_actions

EFFORT = 10_000
"""Number of rounds of a search multiplied by the number of tasks."""

REMOVED = 8
"""Greatest number of chains that one round removes."""

OPTIMISM = 0.75
"""Probability of each optimistic assumption of a search, see :class:`Tours`."""

EARLY = 0.5
"""Weight of the mean time until a chain is done, compared with the time of the longest tour."""

FAR = 1_000_000
"""Number of moves to an unreachable place."""

ANYWHERE: Act = (clingo.Infimum, clingo.Infimum)
"""The end of a tour whose last action is a task."""

Order = Tuple[int, ...]
"""The numbers of tasks."""


def reordered(
    plan: Plan,
    step: int,
    random: Random,
    stopped: Stop,
    possible: Sequence[clingo.Symbol],
    durations: Durations,
    cost: Callable[[Plan], Tuple[float, int]],
) -> Optional[Plan]:
    """Return a candidate that costs less than ``plan`` and differs from it after ``step``; None if none is found.

    Robots do not wait in it, even if they are in each other's way. ``possible`` are the actions of an earlier step that
    were possible: the moves among them can be the first ones of robots that have not moved since then. The search ends
    when ``stopped`` returns true.
    """
    by_robot = _act_at_once(plan)
    all_actions = tour_actions(plan.actions, by_robot)
    rest = [one for one in all_actions if one.cycle > step]
    past = [one for one in all_actions if one.cycle <= step]
    both_ways, idle_robots, free_ends = (random.random() < OPTIMISM for _ in range(3))
    tours = Tours(past, rest, tour_actions(possible, by_robot), durations, both_ways, idle_robots, free_ends)
    if len({(one.cycle, one.robot) for one in rest}) < len(rest) or len(tours.chains) < 2:
        return None
    best = orders = tours.orders
    for _ in range(EFFORT // len(tours.chain_of)):
        if stopped():
            break
        others = _recreated(tours, orders, random)
        if others and tours.cost(others) < tours.cost(orders) - math.log(1.0 - random.random()):
            orders = others
            best = min(best, orders, key=tours.cost)
    actions = tours.actions(best, step + 1)
    found = Plan(frozenset(actions), max(map(cycle_of, actions)))
    return found if cost(found) < cost(plan) else None


def time_cost(plan: Plan, past: Plan, step: int, durations: Durations) -> Tuple[float, int]:
    """Return the time from ``step`` to the end of ``plan``, with a part of the mean time of chains; and the horizon.

    The actions up to ``step`` are those of the plan ``past``. Each action begins as early as the order of the plan
    allows, see keep_order.py. All actions of unknown duration take as long as the slowest kind. For a plan with one
    tour, only its horizon counts.
    """
    if not _act_at_once(past):
        return 0.0, plan.horizon
    actions = [one for one in past.actions if cycle_of(one) <= step]
    acts = tour_actions([*actions, *plan.rest(step + 1).actions], by_robot=True)
    present = {one[1:] for one in acts if one.cycle == step}
    before = [one for one in acts if one.cycle < step and one[1:] not in present]
    rest = [one for one in acts if one.cycle >= step]
    times, moving = _times(durations), moving_kinds(before, rest)
    ends: List[float] = []
    done: Dict[clingo.Symbol, float] = {}
    for (_, _, (kind, what)), others in zip(rest, waits(before, rest)):
        ends.append(max((ends[number] for number in others), default=0.0) + times.get(kind, 1.0))
        if kind not in moving:
            done[what] = ends[-1]
    return max(ends, default=0.0) + EARLY * mean(done.values() or [0.0]), plan.horizon


def _times(durations: Durations) -> Dict[clingo.Symbol, float]:
    """Return the ``durations``, compared with the longest."""
    longest = max(durations.values(), default=0.0) or 1.0
    return {kind: seconds / longest for kind, seconds in durations.items()}


def _act_at_once(plan: Plan) -> bool:
    """Return whether ``plan`` has several actions at a step, whose names tell the robots."""
    names = [one.arguments[0] for one in plan.actions]
    return len(set(map(cycle_of, plan.actions))) < len(names) and all(
        one.type is clingo.SymbolType.Function and one.arguments for one in names
    )


def _recreated(tours: "Tours", orders: List[Order], random: Random) -> Optional[List[Order]]:
    """Return ``orders`` with some chains inserted elsewhere; None if a chain does not fit."""
    near = dict.fromkeys(tours.chain_of[task] for task in tours.nearest(random.randrange(len(tours.chain_of))))
    chains = [*near][: random.randint(1, REMOVED)]
    random.shuffle(chains)
    orders = [tuple(task for task in order if tours.chain_of[task] not in chains) for order in orders]
    for chain in chains:
        candidates = [*tours.inserted(orders, chain)]
        if not candidates:
            return None
        orders = min(candidates, key=tours.cost)
    return orders


class Tours:
    """A plan as tasks at places, in an order for each robot.

    Attributes:
        orders: the numbers of each robot's tasks, in the order of the plan.
        chains: the tasks of each chain.
        chain_of: task -> the number of its chain.

    """

    def __init__(
        self,
        past: Sequence[TourAction],
        plan: Sequence[TourAction],
        possible: Sequence[TourAction],
        durations: Durations,
        both_ways: bool,
        idle_robots: bool,
        free_ends: bool,
    ) -> None:
        """Read ``plan``, which follows the ``past``; the moves among the ``possible`` actions can be first ones.

        If ``both_ways``, connections are symmetric, and those of the past are still open. Robots without actions in the
        plan are used if ``idle_robots``. If ``free_ends``, tours end with their last task, even if moves follow it in
        the plan.
        """
        self._moving, times = moving_kinds(past, plan), _times(durations)
        self._move_time = mean([times.get(kind, 1.0) for kind in self._moving] or [1.0])
        self._robots = sorted({one.robot for one in (*plan, *((*past, *possible) if idle_robots else ()))})
        self._exits: Dict[Act, Dict[Act, None]] = {}
        self._tasks: List[Act] = []
        self.orders: List[Order] = []
        places, starts, ends = [], [], []  # type: List[Act], List[Act], List[Act]
        for number, robot in enumerate(self._robots):
            moves = [one.act for one in past if one.robot == robot and self._moves(one.act)]
            first = [one.act for one in possible if one.robot == robot and self._moves(one.act)]
            here = self._start(number, moves, first, both_ways)
            starts.append(here)
            order: List[int] = []
            acts = [one.act for one in plan if one.robot == robot]
            for act in acts:
                if self._moves(act):
                    self._connect(here, act, both_ways and self._moves(here))
                    here = act
                else:
                    order.append(len(self._tasks))
                    self._tasks.append(act)
                    places.append(here)
            self.orders.append(tuple(order))
            ends.append(here if acts and self._moves(acts[-1]) and not free_ends else ANYWHERE)
        self._task_times = [times.get(kind, 1.0) for kind, _ in self._tasks]
        self._places = [*places, *starts, *ends]  # of the tasks, and of the starts and ends of the tours
        self._find_chains([one for one in past if not self._moves(one.act)])
        self._ways = {place: self._ways_from(place) for place in self._places}
        ways = [self._ways[place] for place in self._places]
        self._distances = [[len(way[place]) if place in way else FAR for place in self._places] for way in ways]
        # most tours stay the same in a round
        self._steps = lru_cache(maxsize=None)(self._count_steps)
        self._inserted = lru_cache(maxsize=None)(self._insert)

    def _moves(self, act: Act) -> bool:
        return act[0] in self._moving

    def _start(self, number: int, moves: Sequence[Act], first: Sequence[Act], both_ways: bool) -> Act:
        """Return where the robot with this number is after its ``moves``; its ``first`` move can be one of these."""
        if not moves:
            here = (clingo.Infimum, clingo.Number(number))
            self._exits[here] = dict.fromkeys(first)
            return here
        for before, after in zip(moves, moves[1:]) if both_ways else ():
            self._connect(before, after, both_ways=True)
        return moves[-1]

    def _connect(self, here: Act, there: Act, both_ways: bool) -> None:
        self._exits.setdefault(here, {})[there] = None
        if both_ways:
            self._exits.setdefault(there, {})[here] = None

    def _find_chains(self, past: Sequence[TourAction]) -> None:
        chains: Dict[clingo.Symbol, List[int]] = {}
        for task, (_, parameter) in enumerate(self._tasks):
            chains.setdefault(parameter, []).append(task)
        self.chains = [*chains.values()]
        self._last = {chain[-1] for chain in self.chains}
        self.chain_of = {task: number for number, chain in enumerate(self.chains) for task in chain}
        # A chain is open at the start if it begins with a later kind of task; it stays with its robot.
        done: Dict[clingo.Symbol, Set[clingo.Symbol]] = {}
        for _, _, (kind, parameter) in past:
            done.setdefault(parameter, set()).add(kind)
        kinds = [[self._tasks[task][0] for task in chain] for chain in self.chains]
        self._begun = [
            bool(done.get(parameter, set()).difference(b)) or any(len(a) > len(b) and a[-len(b) :] == b for a in kinds)
            for parameter, b in zip(chains, kinds)
        ]
        self._opens = {
            task: (task == chain[0] and not begun) - (task == chain[-1])
            for chain, begun in zip(self.chains, self._begun)
            for task in chain
        }
        opens = [[self._open_at_start(order), *(self._opens[task] for task in order)] for order in self.orders]
        self._most_open = max((max(accumulate(one)) for one in opens), default=0)

    def _open_at_start(self, order: Order) -> int:
        return sum(self._begun[chain] for chain in {self.chain_of[task] for task in order})

    # ---- Moves -------------------------------------------------------------------------------------------------------

    def _ways_from(self, start: Act) -> Dict[Act, List[Act]]:
        """Return a shortest path to each place."""
        ways: Dict[Act, List[Act]] = {start: [], ANYWHERE: []}
        queue = deque([start])
        while queue:
            here = queue.popleft()
            for place in self._exits.get(here, ()):
                if place not in ways:
                    ways[place] = [*ways[here], place]
                    queue.append(place)
        return ways

    def _stops(self, robot: int, order: Order) -> Order:
        """Return ``order`` between the numbers of the places where the tour starts and ends."""
        start = len(self._tasks) + robot
        return (start, *order, start + len(self._robots))

    def cost(self, orders: Sequence[Order]) -> float:
        """Return the time of the longest tour; for several ones, also a part of the mean time until a chain is done."""
        times = [self._steps(robot, order) for robot, order in enumerate(orders)]
        late = sum(late for _, late in times) / len(self.chains) if len(orders) > 1 else 0.0
        return max(end for end, _ in times) + EARLY * late

    def _count_steps(self, robot: int, order: Order) -> Tuple[float, float]:
        """Return the time of a tour, and the sum of the times until its chains are done."""
        stops = self._stops(robot, order)
        end = late = 0.0
        for before, after in zip(stops, stops[1:]):
            end += self._move_time * self._distances[before][after]
            if after < len(self._tasks):
                end += self._task_times[after]
                late += end if after in self._last else 0.0
        return end, late

    def nearest(self, task: int) -> Order:
        """Return all tasks, nearest to ``task`` first."""
        return tuple(sorted(self.chain_of, key=self._distances[task].__getitem__))

    # ---- Orders ------------------------------------------------------------------------------------------------------

    def inserted(self, orders: Sequence[Order], chain: int) -> Iterator[List[Order]]:
        """Yield ``orders`` with a chain inserted, by each robot that can have it."""
        for robot, order in enumerate(orders):
            if not self._begun[chain] or self.chains[chain][0] in self.orders[robot]:
                more = self._inserted(robot, order, chain)
                if more is not None:
                    yield [*orders[:robot], more, *orders[robot + 1 :]]

    def _insert(self, robot: int, order: Order, chain: int) -> Optional[Order]:
        """Return ``order`` with a chain inserted where it adds the fewest moves; None if it does not fit.

        Uses dynamic programming over the gaps: ``added[n]`` contains the additional moves and the gaps for the first
        ``n`` tasks of the chain.
        """
        tasks, moves, stops = self.chains[chain], self._distances, self._stops(robot, order)
        along = [0, *accumulate(moves[a][b] for a, b in zip(tasks, tasks[1:]))]
        nowhere: Tuple[float, Order] = (math.inf, ())
        added: List[Tuple[float, Order]] = [(0.0, ()), *[nowhere] * len(tasks)]
        open_states = range(0 if self._begun[chain] else 1, len(tasks))
        now_open = self._open_at_start(order)
        for gap, (before, after) in enumerate(zip(stops, stops[1:])):
            now_open += self._opens[before] if gap else 0
            if now_open >= self._most_open and open_states:
                for state in open_states:
                    added[state] = nowhere
                continue
            for end in range(len(tasks), 0, -1):
                rest = along[end - 1] + moves[tasks[end - 1]][after] - moves[before][after]
                for begin in range(end):
                    count = added[begin][0] + moves[before][tasks[begin]] - along[begin] + rest
                    if count < added[end][0]:
                        added[end] = count, (*added[begin][1], *[gap] * (end - begin))
        if added[-1] == nowhere:
            return None
        gaps = [*enumerate(order, 1), *zip(added[-1][1], tasks)]
        return tuple(task for _, task in sorted(gaps, key=itemgetter(0)))

    def actions(self, orders: Sequence[Order], cycle: int) -> List[clingo.Symbol]:
        """Return the actions of ``orders`` from ``cycle`` on."""
        actions = []
        for number, (robot, order) in enumerate(zip(self._robots, orders)):
            names = [
                (clingo.Function(kind.name, robot) if robot else kind, what) for kind, what in self._acts(number, order)
            ]
            actions += [
                clingo.Function(ACTION.name, [*act, clingo.Number(late)]) for late, act in enumerate(names, cycle)
            ]
        return actions

    def _acts(self, robot: int, order: Order) -> List[Act]:
        """Return the actions of a tour; it ends each chain when it first comes to the place of the last task."""
        acts: List[Act] = []
        left = list(order)

        def end_chains(place: Act) -> None:
            """Do the tasks at ``place`` whose chains have no other task left."""
            for task in [one for one in left if self._places[one] == place]:
                if set(left).intersection(self.chains[self.chain_of[task]]) == {task}:
                    left.remove(task)
                    acts.append(self._tasks[task])

        start, *_, end = self._stops(robot, order)
        here = self._places[start]
        end_chains(here)
        while left or self._ways[here][self._places[end]]:
            there = self._places[left[0] if left else end]
            for move in self._ways[here][there]:
                acts.append(move)
                end_chains(move)
            here = there
            if left and self._places[left[0]] == here:
                acts.append(self._tasks[left.pop(0)])
                end_chains(here)
        return acts
