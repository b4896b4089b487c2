"""The input feeder of Fig. 4: it turns what happened into the next stream update."""

from typing import Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Tuple, Union

from clingo import Symbol

from rosoclingo.oclingo import Statement, StreamUpdate, commitment
from rosoclingo.oclingo.progression.updates import Item
from rosoclingo.reasoning.clock import Clock
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.keywords import Action, cancellation, request
from rosoclingo.reasoning.observations import Observation


class Batch(NamedTuple):
    """A stream update and what it carries: ``requests`` (an identifier is to be cancelled), and ``facts``, in order."""

    update: StreamUpdate
    requests: Tuple[Union[Goal, Symbol], ...] = ()
    facts: Tuple[Observation, ...] = ()
    executed: Tuple[Action, ...] = ()

    @property
    def goals(self) -> Tuple[Goal, ...]:
        """The goals whose requests the update carries for the first time."""
        return tuple(item for item in self.requests if isinstance(item, Goal))

    @property
    def without_goals(self) -> StreamUpdate:
        """The same update without the goals' requests."""
        cycles = [(goal.term, goal.request_cycle) for goal in self.goals]
        return self.update.less(frozenset(request(term, cycle) for term, cycle in cycles if cycle is not None))

    @property
    def commitments(self) -> StreamUpdate:
        """The same update with nothing but the commitments."""
        kept = tuple(item for item in self.update.items if not isinstance(item, Statement) or item.is_commitment)
        return StreamUpdate(step=self.update.step, items=kept)


class InputFeeder:
    """Collects requests, cancellations, returns and other facts in order of arrival, until the next update takes them.

    Within an update commitments come first, then requests and cancellations, then returns and other facts; a new goal
    in update n carries cycle n+1, a cancellation n (as in the paper's printed updates). ``clock`` knows the cycle of
    facts that are stated for ``now``.

    Attributes:
        arrivals: how many things have arrived so far.

    """

    def __init__(self, clock: Optional[Clock] = None) -> None:
        self._clock = clock or Clock()
        self._requests: List[Union[Goal, Symbol]] = []
        self._rejected: List[Symbol] = []
        self._facts: Dict[Symbol, Observation] = {}
        self._owed: Tuple[Action, ...] = ()
        self._waits: Optional[int] = None  # for more to arrive than has by now
        self.arrivals = 0

    @property
    def pending(self) -> bool:
        """Whether anything waits to be fed."""
        return bool(self._requests or self._facts) and self.arrivals != self._waits

    @property
    def waiting(self) -> int:
        """How many returns and other facts wait to be fed."""
        return len(self._facts)

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

    def add_rejection(self, identifier: Symbol) -> None:
        """The program has rejected a goal: the next update, if there is one, cancels it, lest a late fact revive it."""
        self._rejected.append(identifier)

    def add_fact(self, atom: Symbol, origin: str = "", cycle: int = 0) -> None:
        """A return or another fact arrived in ``cycle``; the same fact twice in an update is one."""
        self.arrivals += 1
        self._facts.setdefault(atom, Observation(atom, cycle, origin=origin, told=atom))

    def put_back(self, batch: Batch, waits: bool = False) -> None:
        """An update was not taken, so the next one brings what it held, but for the goals that have ended.

        With ``waits`` that is not made before something else arrives.
        """
        self._waits = self.arrivals if waits else None
        self._owed = batch.executed
        self._requests[:0] = [item for item in batch.requests if not isinstance(item, Goal) or item.live]
        self._facts = {**{one.told or one.atom: one for one in batch.facts}, **self._facts}
        for goal in batch.goals:
            goal.request_cycle = None

    def next_update(self, step: int, executed: Iterable[Action], over: int = 0) -> Batch:
        """The update that starts cycle ``step``, after ``executed`` in the one before; it empties the feeder.

        Facts of cycles before ``over`` come too late, and are taken for the present. New goals wait for the next update
        where a fact of now takes effect only then.
        """
        waiting = [one for one in self._requests if isinstance(one, Goal)] if self._too_early(step) else []
        requests = tuple(one for one in self._requests if one not in waiting)
        renewed = [one.identifier for one in requests if isinstance(one, Goal)]
        requests = (*(one for one in self._rejected if one not in renewed), *requests)
        batch = self._batch(step, executed, requests, self._facts.values(), over)
        self._requests, self._rejected, self._facts, self._owed = list(waiting), [], {}, ()
        self._waits = None
        return batch

    def preview(self, step: int, executed: Iterable[Action], further: Iterable[Symbol] = ()) -> StreamUpdate:
        """What the next update would be, with ``further`` facts."""
        facts = {**self._facts, **{atom: Observation(atom, step) for atom in further}}
        return self._batch(step, executed, self._requests, facts.values()).update

    def _batch(
        self,
        step: int,
        executed: Iterable[Action],
        requests: Iterable[Union[Goal, Symbol]],
        facts: Iterable[Observation],
        over: int = 0,
    ) -> Batch:
        done = (*self._owed, *executed)
        seen = tuple(self._dated(fact, step, over) for fact in facts)
        items: List[Item] = [commitment(action.atom) for action in done]
        items += [Statement(self._request(item, step)) for item in requests]
        items += [Statement(atom) for atom in dict.fromkeys(one.atom for one in seen)]
        return Batch(StreamUpdate(step=step, items=tuple(items)), tuple(requests), seen, done)

    def _dated(self, fact: Observation, step: int, over: int) -> Observation:
        told = fact.told or fact.atom
        cycle = None if fact.is_return else self._clock.cycle_of(told)
        if cycle is not None and cycle < over:
            return fact._replace(atom=self._clock.at_present(told, step), outdated=True)
        return fact._replace(atom=self._clock.dated(told, step), outdated=False)

    def _too_early(self, step: int) -> bool:
        return any(self._clock.is_too_early(fact, step) for fact in self._facts)

    @staticmethod
    def _request(item: Union[Goal, Symbol], step: int) -> Symbol:
        return request(item.term, step + 1) if isinstance(item, Goal) else cancellation(item, step)


def requests_of(goals: Iterable[Goal]) -> FrozenSet[Symbol]:
    """The requests of the goals that were fed."""
    return frozenset(request(goal.term, goal.request_cycle) for goal in goals if goal.request_cycle is not None)
