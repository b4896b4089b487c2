"""What a plan does, in terms of what might be done in another order.

Actions of a kind that does something twice are *moves*, all others *tasks*; where a task is done is told by the last
move before it, and moves that follow each other join two places. Tasks keep their order where their parameters have
something in common that no move names, as what is picked up and put down: they are a *chain*. A chain is under way from
its first task to its last; as many may be so at once as in the plan.
"""

from collections import Counter
from typing import List, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.planning.reordering.known_ways import Deed, Place, Ways
from rosoclingo.planning.reordering.ruin_and_recreate import Order, Tasks


class Deeds:
    """What a plan does.

    Attributes:
        plan: all that it does, one thing after the other.
        order: its tasks, by number.
        chains: tasks by number, from 1 on, which keep their order; each task is in one of them.
        begun: those of the chains that were under way before.
        places: where it begins, and where each task is done.
        most: how many chains are under way at once, at most.
        ways: those that are known.

    """

    def __init__(self, past: Sequence[Deed], plan: Sequence[Deed], back: bool, known: Optional["Deeds"] = None) -> None:
        """Read what ``plan`` does after the ``past``; ``known`` is what was read of a longer rest of it.

        Where moves lead ``back`` one can go to where a move has begun.
        """
        self.plan = list(plan)
        self._kinds = {kind for (kind, _), count in Counter(plan).items() if count > 1}
        self._kinds |= known._kinds if known is not None else set()
        self._tasks: List[Deed] = []
        self.ways = Ways(next((deed for deed in reversed(past) if self._is_move(deed)), None), back)
        self.places: List[Place] = [self.ways.here]
        for deed in plan:
            if self._is_move(deed):
                self.ways.go(deed)
            else:
                self._tasks.append(deed)
                self.places.append(self.ways.here)
        self.order: Order = [*range(1, len(self._tasks) + 1)]
        self.chains = self._joined()
        kinds = [tuple(self.task(number)[0] for number in chain) for chain in self.chains]
        self.begun = [any(_ends(longer, chain) for longer in set(kinds)) for chain in kinds]
        self.most: int = max(self.under_way(self.order), 0 if known is None else known.most)

    def task(self, number: int) -> Deed:
        """Return what the task of a number is."""
        return self._tasks[number - 1]

    @property
    def end(self) -> Place:
        """Where the plan ends, if it goes there behind its last task; else None."""
        return self.ways.here if self.plan and self._is_move(self.plan[-1]) else None

    def under_way(self, order: Order) -> int:
        """Return how many chains are under way at once at most, if the tasks are done in an order."""
        load = most = sum(self.begun)
        firsts = {chain[0] for chain, begun in zip(self.chains, self.begun) if not begun}
        lasts = {chain[-1] for chain in self.chains}
        for task in order:
            load += task in firsts
            most = max(most, load)
            load -= task in lasts
        return most

    def tasks(self) -> Tasks:
        """Return what is to be put in an order."""
        end, steps = self.end, self.ways.steps
        distances = [
            [*(steps(one, other) for other in self.places), 0 if end is None else steps(one, end)]
            for one in self.places
        ]
        return Tasks(distances, self.chains, self.begun, self.most)

    def left_of(self, deeds: Sequence[Deed]) -> Optional[Order]:
        """Return the order of ``deeds``, without what is no task here; None where it lacks one or has no room."""
        numbers = {task: number for number, task in enumerate(self._tasks, 1)}
        order = [numbers[deed] for deed in deeds if deed in numbers]
        return order if len(order) == len(self._tasks) and self.under_way(order) <= self.most else None

    def _is_move(self, deed: Deed) -> bool:
        return deed[0] in self._kinds

    def _joined(self) -> List[Tuple[int, ...]]:
        """Return the chains."""
        named = {part for deed in self.plan if self._is_move(deed) for part in _parts(deed[1])}
        chains: List[Tuple[Set[clingo.Symbol], List[int]]] = []
        for number in self.order:
            parts, tasks, apart = _parts(self.task(number)[1]) - named, [number], []
            for chain in chains:
                if chain[0].isdisjoint(parts):
                    apart.append(chain)
                else:
                    parts, tasks = parts | chain[0], [*chain[1], *tasks]
            chains = [*apart, (parts, sorted(tasks))]
        return [tuple(tasks) for _, tasks in chains]


def _parts(parameter: clingo.Symbol) -> Set[clingo.Symbol]:
    """Return what a parameter is made of, however deep; what is there many times is looked at once."""
    seen, left, parts = {parameter}, [parameter], set()
    while left:
        part = left.pop()
        if part.type is clingo.SymbolType.Function and part.arguments:
            new = set(part.arguments) - seen
            seen |= new
            left += new
        else:
            parts.add(part)
    return parts


def _ends(longer: Sequence[clingo.Symbol], chain: Sequence[clingo.Symbol]) -> bool:
    """Whether a longer chain ends as this one does, so that this one may have begun as that one does."""
    return len(longer) > len(chain) and longer[-len(chain) :] == chain
