"""The input feeder of Fig. 4: it turns what happened into the next stream update."""

from typing import Dict, FrozenSet, Iterable, List, NamedTuple, Tuple, Union

from clingo import Symbol

from rosoclingo.oclingo import Statement, StreamUpdate, commitment
from rosoclingo.oclingo.progression import Item
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.keywords import Action, cancellation, request


class Batch(NamedTuple):
    """A stream update and the goals whose requests it carries for the first time."""

    update: StreamUpdate
    goals: Tuple[Goal, ...]

    @property
    def requests(self) -> FrozenSet[Symbol]:
        """The requests of the goals."""
        return frozenset(
            request(goal.term, goal.request_cycle) for goal in self.goals if goal.request_cycle is not None
        )

    @property
    def without_goals(self) -> StreamUpdate:
        """The same update without the goals' requests."""
        return self.update.less(self.requests)

    @property
    def commitments(self) -> StreamUpdate:
        """The same update with nothing but the commitments."""
        kept = tuple(item for item in self.update.items if isinstance(item, Statement) and item.head is None)
        return StreamUpdate(step=self.update.step, items=kept)


class InputFeeder:
    """Collects requests, cancellations, returns and other facts in order of arrival, until the next update takes them.

    Within an update commitments come first, then requests and cancellations, then returns and other facts; a new goal
    in update n carries cycle n+1, a cancellation n (as in the paper's printed updates).

    Attributes:
        arrivals: how many things have arrived so far.

    """

    def __init__(self) -> None:
        self._requests: List[Union[Goal, Symbol]] = []
        self._facts: Dict[Symbol, None] = {}
        self._owed: Tuple[Item, ...] = ()
        self.arrivals = 0

    @property
    def pending(self) -> bool:
        """Whether anything waits to be fed."""
        return bool(self._requests or self._facts or self._owed)

    def add_goal(self, goal: Goal) -> None:
        """A new goal arrived."""
        self.arrivals += 1
        self._requests.append(goal)

    def withdraw(self, goal: Goal) -> None:
        """Forget a goal that was cancelled before it was fed."""
        self._requests = [item for item in self._requests if item is not goal]

    def add_cancellation(self, identifier: Symbol) -> None:
        """A goal that was fed is to be cancelled."""
        self.arrivals += 1
        self._requests.append(identifier)

    def add_fact(self, atom: Symbol) -> None:
        """A return or another fact arrived; the same fact twice in an update is one."""
        self.arrivals += 1
        self._facts[atom] = None

    def put_back(self, batch: Batch) -> None:
        """An update was not taken, so the next one brings what it held, but for the goals that have ended."""
        self._owed = batch.without_goals.items
        self._requests[:0] = [goal for goal in batch.goals if goal.live]
        for goal in batch.goals:
            goal.request_cycle = None

    def next_update(self, step: int, executed: Iterable[Action]) -> Batch:
        """The update that starts cycle ``step``, after ``executed`` in the one before; it empties the feeder."""
        batch = Batch(self.preview(step, executed), tuple(item for item in self._requests if isinstance(item, Goal)))
        self._requests, self._facts, self._owed = [], {}, ()
        return batch

    def preview(self, step: int, executed: Iterable[Action], further: Iterable[Symbol] = ()) -> StreamUpdate:
        """What the next update would be, with ``further`` facts."""
        statements = [*self._owed, *(commitment(action.atom) for action in executed)]
        statements += [Statement(self._request(item, step)) for item in self._requests]
        statements += [Statement(atom) for atom in dict.fromkeys((*self._facts, *further))]
        return StreamUpdate(step=step, items=tuple(statements))

    @staticmethod
    def _request(item: Union[Goal, Symbol], step: int) -> Symbol:
        return request(item.term, step + 1) if isinstance(item, Goal) else cancellation(item, step)
