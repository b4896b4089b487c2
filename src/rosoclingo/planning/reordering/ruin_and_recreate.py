"""Shorter orders of tasks: some are taken out, and put back where that costs least.

The search is Schrimpf et al.'s (2000), with the removal of tasks that follow each other or are near each other as of
Shaw (1998) and Christiaens and Vanden Berghe (2020), whose blinks make it try another place now and then; a worse order
is gone on from as in simulated annealing at a constant temperature, so that the search may be left and gone on with at
any time. Places of a chain of tasks are found all at once, by dynamic programming.
"""

import math
from random import Random
from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence, Tuple

TEMPERATURE = 1.0
"""An order that is so many steps longer is gone on from in one of 2.7 cases."""

BLINK = 0.02
"""So often a place is passed over."""

TAKEN_OUT = 10
"""So many chains are taken out at most."""

Order = List[int]


class Tasks(NamedTuple):
    """What is to be done in some order.

    Attributes:
        distances: steps from each task to each, which are numbered from 1; the first row is of the begin, and the last
            column of the end.
        chains: tasks that keep their order. Each task belongs to one chain.
        begun: those of the chains that are under way from the begin on. A chain is so from its first task on, to its
            last.
        most: so many chains may be under way at once.

    """

    distances: Sequence[Sequence[int]]
    chains: Sequence[Tuple[int, ...]]
    begun: Sequence[bool]
    most: int

    def steps(self, order: Order) -> int:
        """Return the steps between the tasks of an order."""
        ways = zip([0, *order], [*order, len(self.distances)])
        return sum(self.distances[one][other] for one, other in ways)


class RuinAndRecreate:
    """A search for shorter orders.

    Attributes:
        tasks: what is put in an order.
        best: the shortest order that was found.

    """

    def __init__(self, tasks: Tasks, order: Order, random: Random) -> None:
        """Begin with ``order``, which has all tasks."""
        self.tasks, self.best = tasks, order
        self._order, self._steps, self._random = order, tasks.steps(order), random
        self._chain = {task: chain for chain, members in enumerate(tasks.chains) for task in members}
        self._near: Dict[int, Order] = {}
        self._changes = {task: self._change(task, chain) for task, chain in self._chain.items()}
        self._held = [len(members) > 1 or begun for members, begun in zip(tasks.chains, tasks.begun)]
        self._pieces = [self._pieces_of(members) for members in tasks.chains]

    def search(self, rounds: int) -> Iterator[Optional[Order]]:
        """Yield, so many times, an order that is shorter than the best one, or None."""
        least = self.tasks.steps(self.best)
        for _ in range(rounds):
            order = self._recreated(*self._ruined())
            steps = math.inf if order is None else self.tasks.steps(order)
            if order is not None and steps < self._steps - TEMPERATURE * math.log(1.0 - self._random.random()):
                self._order, self._steps = order, int(steps)
            if order is not None and steps < least:
                self.best, least = order, int(steps)
                yield order
            else:
                yield None

    # ---- What is taken out -------------------------------------------------------------------------------------------

    def _ruined(self) -> Tuple[Order, List[int]]:
        """Return the order without some chains, and these."""
        most = min(TAKEN_OUT, max(2, len(self.tasks.chains) // 4))
        taken = self._some(self._random.randint(1, most), self._random.randrange(len(self._order)))
        out = list(taken)
        self._random.shuffle(out)
        if self._random.random() < 0.5:
            ends = {chain: self.tasks.chains[chain] for chain in out}
            out.sort(key=lambda chain: -self.tasks.distances[ends[chain][0]][ends[chain][-1]])
        return [task for task in self._order if self._chain[task] not in taken], out

    def _some(self, count: int, place: int) -> Dict[int, None]:
        """Return so many chains that follow each other from a place of the order on, or are near what stands there."""
        follow = self._random.random() < 0.5
        task = self._order[place]
        candidates = [*self._order[place:], *self._order[:place]] if follow else self._near_to(task)
        taken = {self._chain[task]: None}
        for other in candidates:
            if len(taken) >= count:
                break
            if follow or self._random.random() < 0.8:
                taken[self._chain[other]] = None
        return taken

    def _near_to(self, task: int) -> Order:
        if task not in self._near:
            self._near[task] = sorted(self._chain, key=self.tasks.distances[task].__getitem__)
        return self._near[task]

    # ---- Where it is put back ----------------------------------------------------------------------------------------

    def _recreated(self, order: Order, chains: Sequence[int]) -> Optional[Order]:
        """Return the order with the chains put back one after the other; None where one has no room."""
        for chain in chains:
            gaps = self._best_gaps(order, chain)
            if gaps is None:
                return None
            for gap, task in reversed([*zip(gaps, self.tasks.chains[chain])]):
                order = [*order[:gap], task, *order[gap:]]
        return order

    def _pieces_of(self, members: Tuple[int, ...]) -> List[Tuple[int, int, int, int, int]]:
        """Return, of pieces of a chain: begin and end, first and last task, and the steps within. The longest first."""
        distances = self.tasks.distances
        return [
            (begin, end, members[begin], members[end - 1], sum(distances[a][b] for a, b in zip(part, part[1:])))
            for end in range(len(members), 0, -1)
            for begin in range(end)
            for part in [members[begin:end]]
        ]

    def _best_gaps(self, order: Order, chain: int) -> Optional[Tuple[int, ...]]:
        """Return before which places of the order the tasks of a chain cost least; None where there is no room."""
        distances, pieces, random = self.tasks.distances, self._pieces[chain], self._random.random
        begun, held, most, changes = self.tasks.begun[chain], self._held[chain], self.tasks.most, self._changes
        length = len(self.tasks.chains[chain])
        costs: List[float] = [0.0, *[math.inf] * length]  # of so many tasks of the chain
        gaps: List[Tuple[int, ...]] = [()] * (length + 1)
        load, last = self._load_at_begin(order), len(order)
        for gap in range(last + 1):
            before = order[gap - 1] if gap else 0
            if gap:
                load += changes[before]
            if held and load >= most:
                costs[1:length] = [math.inf] * (length - 1)
                if begun:
                    costs[0] = math.inf
                continue
            if random() < BLINK:
                continue
            after = order[gap] if gap < last else len(distances)
            row = distances[before]
            saved = row[after]
            for begin, end, first, final, within in pieces:
                cost = costs[begin] + row[first] + within + distances[final][after] - saved
                if cost < costs[end]:
                    costs[end] = cost
                    gaps[end] = (*gaps[begin], *(gap,) * (end - begin))
        return None if costs[length] == math.inf else gaps[length]

    def _load_at_begin(self, order: Order) -> int:
        """Return how many chains of an order are under way at its begin."""
        there = {self._chain[task] for task in order}
        return sum(begun and chain in there for chain, begun in enumerate(self.tasks.begun))

    def _change(self, task: int, chain: int) -> int:
        """Return how many more chains are under way after a task than before it."""
        members = self.tasks.chains[chain]
        begins = task == members[0] and not self.tasks.begun[chain]
        return int(begins) - int(task == members[-1])
