"""Candidates for shorter plans: the same tasks in another order. The solver checks whether a candidate is a plan.

The plan is read as a tour. If an action repeats, all actions of its kind are *moves*, each to the place in its
parameter. Other actions are *tasks* at the place of the last move. Tasks with the same parameter, such as a pickup and
a delivery, form a *chain*: they keep their order. A chain is open from its first to its last task; a candidate never
has more open chains than the plan. Moves use the connections of the plan; half of the searches use them in both
directions.

The search is ruin and recreate (Schrimpf et al. 2000): it removes some chains with nearby tasks (Shaw 1998) and inserts
each where it adds the fewest moves. Like simulated annealing, it also accepts slightly longer tours.
"""

import math
from collections import Counter, deque
from itertools import accumulate
from operator import itemgetter
from random import Random
from typing import Dict, List, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.question import Stop

EFFORT = 10_000
"""Number of rounds of a search multiplied by the number of tasks."""

REMOVED = 8
"""Greatest number of chains that one round removes."""

FAR = 1_000_000
"""Number of moves to an unreachable place."""

Act = Tuple[clingo.Symbol, clingo.Symbol]
"""An action without its cycle: kind and parameter."""

Place = Optional[Act]
"""The move that leads to a place; None for an unknown start."""

ANYWHERE: Act = (clingo.Infimum, clingo.Infimum)
"""The end of a plan whose last action is a task."""

Order = List[int]
"""The numbers of tasks, from 1."""


def reordered(plan: Plan, step: int, random: Random, stopped: Stop) -> Optional[Plan]:
    """Return a shorter candidate that differs from ``plan`` after ``step``; None if none is found.

    The search ends when ``stopped`` returns true. A plan with several actions at a step has no candidates.
    """
    actions = sorted(plan.actions, key=cycle_of)
    acts = [(action.arguments[0], action.arguments[1]) for action in actions]
    cycles = [cycle_of(action) for action in actions if cycle_of(action) > step]
    past = len(acts) - len(cycles)
    tour = Tour(acts[:past], acts[past:], both_ways=random.random() < 0.5)
    if len(set(cycles)) < len(cycles) or len(tour.chains) < 2:
        return None
    best = order = tour.order
    for _ in range(EFFORT // len(order)):
        if stopped():
            break
        other = _recreated(tour, order, random)
        if other and tour.moves(other) < tour.moves(order) - math.log(1.0 - random.random()):
            order = other
            best = min(best, order, key=tour.moves)
    acts = tour.acts(best)
    if len(acts) >= len(cycles):
        return None
    shorter = (clingo.Function(ACTION.name, [*act, clingo.Number(cycle)]) for cycle, act in enumerate(acts, step + 1))
    return Plan(frozenset(shorter), step + len(acts))


def _recreated(tour: "Tour", order: Order, random: Random) -> Optional[Order]:
    """Return ``order`` with some chains inserted elsewhere; None if a chain does not fit."""
    near = dict.fromkeys(tour.chain_of[task] for task in tour.nearest(random.choice(order)))
    chains = [*near][: random.randint(1, REMOVED)]
    random.shuffle(chains)
    recreated: Optional[Order] = [task for task in order if tour.chain_of[task] not in chains]
    for chain in chains:
        recreated = None if recreated is None else tour.inserted(recreated, chain)
    return recreated


class Tour:
    """A plan as a sequence of tasks at places.

    Attributes:
        order: the numbers of the tasks, in the order of the plan.
        chains: the tasks of each chain.
        chain_of: task -> the number of its chain.

    """

    def __init__(self, past: Sequence[Act], plan: Sequence[Act], both_ways: bool) -> None:
        """Read ``plan``, which follows the ``past``; if ``both_ways``, connections are symmetric."""
        moving = {kind for (kind, _), count in Counter(plan).items() if count > 1}
        here: Place = next((act for act in reversed(past) if act[0] in moving), None)
        self._tasks: List[Act] = []
        self._places = [here]
        self._exits: Dict[Place, List[Act]] = {}
        for act in plan:
            if act[0] in moving:
                self._exits.setdefault(here, []).append(act)
                if both_ways and here is not None:
                    self._exits.setdefault(act, []).append(here)
                here = act
            else:
                self._tasks.append(act)
                self._places.append(here)
        self._end = here if plan and plan[-1][0] in moving else ANYWHERE
        self.order: Order = [*range(1, len(self._tasks) + 1)]
        self._find_chains()
        self._ways = {place: self._ways_from(place) for place in self._places}
        ways, ends = [self._ways[place] for place in self._places], [*self._places, self._end]
        self._moves = [[len(way[place]) if place in way else FAR for place in ends] for way in ways]

    def _find_chains(self) -> None:
        chains: Dict[clingo.Symbol, Order] = {}
        for task in self.order:
            chains.setdefault(self._tasks[task - 1][1], []).append(task)
        self.chains = [*chains.values()]
        self.chain_of = {task: number for number, chain in enumerate(self.chains) for task in chain}
        # A chain is open at the start if its tasks are the last kinds of a longer chain.
        kinds = [[self._tasks[task - 1][0] for task in chain] for chain in self.chains]
        self._begun = [any(len(a) > len(b) and a[-len(b) :] == b for a in kinds) for b in kinds]
        self._opens = {
            task: (task == chain[0] and not begun) - (task == chain[-1])
            for chain, begun in zip(self.chains, self._begun)
            for task in chain
        }
        self._most_open = max(accumulate([sum(self._begun), *(self._opens[task] for task in self.order)]))

    # ---- Moves -------------------------------------------------------------------------------------------------------

    def _ways_from(self, start: Place) -> Dict[Place, List[Act]]:
        """Return a shortest path to each place."""
        ways: Dict[Place, List[Act]] = {start: [], ANYWHERE: []}
        queue = deque([start])
        while queue:
            here = queue.popleft()
            for place in self._exits.get(here, ()):
                if place not in ways:
                    ways[place] = [*ways[here], place]
                    queue.append(place)
        return ways

    def moves(self, order: Order) -> int:
        """Return the number of moves that ``order`` needs."""
        return sum(self._moves[a][b] for a, b in zip([0, *order], [*order, -1]))

    def nearest(self, task: int) -> Order:
        """Return all tasks, nearest to ``task`` first."""
        return sorted(self.order, key=self._moves[task].__getitem__)

    # ---- Orders ------------------------------------------------------------------------------------------------------

    def inserted(self, order: Order, chain: int) -> Optional[Order]:
        """Return ``order`` with a chain inserted where it adds the fewest moves; None if it does not fit.

        Uses dynamic programming over the gaps: ``added[n]`` contains the additional moves and the gaps for the first
        ``n`` tasks of the chain.
        """
        tasks, moves = self.chains[chain], self._moves
        along = [0, *accumulate(moves[a][b] for a, b in zip(tasks, tasks[1:]))]
        nowhere: Tuple[float, Order] = (math.inf, [])
        added: List[Tuple[float, Order]] = [(0.0, []), *[nowhere] * len(tasks)]
        open_states = range(0 if self._begun[chain] else 1, len(tasks))
        now_open = sum(self._begun[other] for other in {self.chain_of[task] for task in order})
        for gap, (before, after) in enumerate(zip([0, *order], [*order, -1])):
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
                        added[end] = count, added[begin][1] + [gap] * (end - begin)
        if added[-1] == nowhere:
            return None
        gaps = [*enumerate(order, 1), *zip(added[-1][1], tasks)]
        return [task for _, task in sorted(gaps, key=itemgetter(0))]

    def acts(self, order: Order) -> List[Act]:
        """Return the moves and tasks of ``order``."""
        acts: List[Act] = []
        here = self._places[0]
        for task in order:
            acts += [*self._ways[here][self._places[task]], self._tasks[task - 1]]
            here = self._places[task]
        return acts + self._ways[here][self._end]
