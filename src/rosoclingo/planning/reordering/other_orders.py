"""Plans that do the same in another order."""

from random import Random
from typing import Dict, Iterator, List, Optional, Sequence, Set

from rosoclingo.planning.reordering.deeds import Deeds
from rosoclingo.planning.reordering.known_ways import Deed, Place
from rosoclingo.planning.reordering.ruin_and_recreate import Order, RuinAndRecreate


class Orders:
    """Other orders of one plan, of which only the solver knows whether they are plans."""

    def __init__(
        self,
        past: Sequence[Deed],
        plan: Sequence[Deed],
        random: Random,
        back: bool = True,
        before: Optional["Orders"] = None,
    ) -> None:
        """Take what ``plan`` does after the ``past``; go on from what was found ``before`` for a longer rest of it.

        Where moves lead ``back`` it is taken for true that one can go back to where a move has begun.
        """
        self._deeds: Deeds = Deeds(past, plan, back, None if before is None else before._deeds)
        self._search: Optional[RuinAndRecreate] = None
        if len(self._deeds.chains) > 1:
            tasks = self._deeds.tasks()
            old = None if before is None else self._deeds.left_of(before._best())
            orders = [self._deeds.order] if old is None else [self._deeds.order, old]
            self._search = RuinAndRecreate(tasks, min(orders, key=tasks.steps), random)

    @property
    def tasks(self) -> int:
        """How many tasks are put in an order."""
        return len(self._deeds.order)

    def shorter(self, rounds: int) -> Iterator[Optional[List[Deed]]]:
        """Yield what shorter plans than all before would do, or None; nothing where there is no other order.

        That of before alone, where it is shorter than the plan; else as many as there are ``rounds``.
        """
        if self._search is None:
            return
        steps = self._search.tasks.steps
        if steps(self._search.best) < steps(self._deeds.order):
            yield Walk(self._deeds).through(self._search.best)
            return
        for order in self._search.search(rounds):
            yield None if order is None else Walk(self._deeds).through(order)

    def _best(self) -> List[Deed]:
        """Return the tasks in the shortest order that is known."""
        return [] if self._search is None else [*map(self._deeds.task, self._search.best)]


class Walk:
    """The robot on its way to one task after the other.

    What is under way and goes on at a place goes on as soon as a way leads there: so it is in many a domain, and
    no way gets longer by it.
    """

    def __init__(self, deeds: Deeds) -> None:
        """Begin where the plan begins."""
        self._deeds = deeds
        self._done: List[Deed] = []
        self._left = [list(chain) for chain in deeds.chains]
        self._chain_of = {task: number for number, chain in enumerate(deeds.chains) for task in chain}
        self._here = deeds.places[0]
        self._next: Dict[Place, Set[int]] = {}  # chains that are under way, by the place of their next task
        for chain, begun in enumerate(deeds.begun):
            if begun:
                self._wait_for(chain)
        self._go_on_here()

    def through(self, order: Order) -> List[Deed]:
        """Return what is done where the tasks are, all of them, in an order as far as the robot does not pass them."""
        for task in order:
            chain = self._chain_of[task]
            if task in self._left[chain]:
                self._go_to(self._deeds.places[task])
            if task in self._left[chain]:
                self._do_next_of(chain)
                self._go_on_here()
        if self._deeds.end is not None:
            self._go_to(self._deeds.end)
        return self._done

    def _go_to(self, place: Place) -> None:
        for move in self._deeds.ways.way(self._here, place):
            self._done.append(move)
            self._here = move
            self._go_on_here()

    def _go_on_here(self) -> None:
        while self._next.get(self._here):
            self._do_next_of(min(self._next[self._here]))

    def _do_next_of(self, chain: int) -> None:
        task = self._left[chain].pop(0)
        self._next.get(self._deeds.places[task], set()).discard(chain)
        self._done.append(self._deeds.task(task))
        self._wait_for(chain)

    def _wait_for(self, chain: int) -> None:
        """Note where the next task of a chain is done."""
        if self._left[chain]:
            self._next.setdefault(self._deeds.places[self._left[chain][0]], set()).add(chain)
