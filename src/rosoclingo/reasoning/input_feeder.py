"""The input feeder of Fig. 4: it builds stream updates from requests, returns and facts."""

from typing import (
    Any,
    Callable,
    Container,
    Dict,
    FrozenSet,
    Iterable,
    Iterator,
    List,
    Mapping,
    NamedTuple,
    Optional,
    Sequence,
    Set,
    Tuple,
    Union,
)

from clingo import Function, Number, Symbol, SymbolType

from rosoclingo.oclingo import Statement, StreamUpdate, commitment
from rosoclingo.oclingo.progression.updates import Expire, Item, Withdraw
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.keywords import NOW, Action, cancellation, request, success_of
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.records import Codec, PersistentPart, fields, symbol_of, tables, text_of

#: Maximum number of cycles for the messages of one origin in an update; older messages take effect in the first cycle.
MOST_TURNS = 16

#: Seconds until an update that was not accepted is sent again, if nothing else has arrived.
PAUSE = 10.0

#: Maximum number of updates that omit a fact although it is their only one; then the fact is dropped.
MOST_TRIES = 5

#: A goal, or the identifier of a cancelled one.
Request = Union[Goal, Symbol]

#: Waiting requests in a record: goals as objects with their keys, and identifiers as texts.
_REQUESTS = Codec(
    lambda requests: [{"goal": one.key} if isinstance(one, Goal) else text_of(one) for one in requests],
    lambda rows: [one if isinstance(one, dict) else symbol_of(one) for one in rows],
    mutable=True,
)


class Batch(NamedTuple):
    """A stream update with its ``requests`` and ``facts``, in order; an identifier stands for a cancellation.

    If the facts take effect in several cycles, ``first`` is an update with only the facts of the first cycle.
    """

    update: StreamUpdate
    requests: Tuple[Request, ...] = ()
    facts: Tuple[Observation, ...] = ()
    first: Optional["Batch"] = None

    @property
    def goals(self) -> List[Goal]:
        """The new goals of the update."""
        return goals_of(self.requests)

    @property
    def known_goals(self) -> List[Goal]:
        """The new goals that the program has."""
        return [goal for goal in self.goals if goal.live and goal.fed]

    @property
    def step(self) -> int:
        """The cycle that the update starts."""
        return self.update.step or 0

    @property
    def request_cycle(self) -> int:
        """The cycle in the requests of the new goals."""
        return self.step + 1

    @property
    def without_goals(self) -> StreamUpdate:
        """The update without the requests of the new goals."""
        return self.update.without_facts(frozenset(request(goal.term, self.request_cycle) for goal in self.goals))

    @property
    def failures(self) -> Tuple[Observation, ...]:
        """The returns of failed actions, each with its actions."""
        return tuple(one for one in self.facts if one.actions)

    @property
    def without_present_facts(self) -> StreamUpdate:
        """The update without the facts that were sent with ``now``."""
        return self.update.without_facts(frozenset(one.atom for one in self.facts if _is_of_now(one.sent)))

    @property
    def indispensable(self) -> StreamUpdate:
        """The update without the requests of new goals, and without facts that are not returns.

        Executed actions and their returns must be fed together; new goals and other facts can be fed later.
        """
        later = {one.atom for one in self.facts if not one.is_return}
        return self.without_goals.without_facts(frozenset(later))


class Clock:
    """Replaces ``now`` in facts by the cycle in which they take effect.

    ``delay(name, arity)`` returns the number of cycles after which a fact can influence actions. The action of cycle n
    depends on facts up to cycle n - delay. The delay is None for predicates whose last argument is not a cycle.
    ``first`` is the first cycle of the program.
    """

    def __init__(self, delay: Callable[[str, int], Optional[int]] = lambda name, arity: 0, first: int = 1) -> None:
        self._delay = delay
        self._first = first

    def dated(self, fact: Symbol, step: int) -> Symbol:
        """Return ``fact`` for the update of ``step``: with its cycle in place of ``now``, otherwise unchanged."""
        return self.at_present(fact, step) if _is_of_now(fact) else fact

    def is_too_early(self, fact: Symbol, step: int) -> bool:
        """Return whether a fact with ``now`` would need a cycle before the first one to take effect at ``step``."""
        return _is_of_now(fact) and step - self._delay_of(fact) < self._first

    def at_present(self, fact: Symbol, step: int) -> Symbol:
        """Return ``fact`` with the cycle of the present as its last argument."""
        cycle = max(step - self._delay_of(fact), self._first)
        return Function(fact.name, [*fact.arguments[:-1], Number(cycle)], fact.positive)

    def cycle_of(self, fact: Symbol) -> Optional[int]:
        """Return the cycle of a fact; None if its predicate has none or its last argument is not a number."""
        if not fact.arguments or self._delay(fact.name, len(fact.arguments)) is None:
            return None
        last = fact.arguments[-1]
        return last.number if last.type is SymbolType.Number else None

    def _delay_of(self, fact: Symbol) -> int:
        return self._delay(fact.name, len(fact.arguments)) or 0


class InputFeeder(PersistentPart):
    """Collects requests, cancellations, returns and other facts in order of arrival, until an update contains them.

    An update lists commitments first, then requests and cancellations, then returns and other facts. Success returns
    are in the order of their actions. As in the paper, a new goal in update n has cycle n+1, and a cancellation has
    cycle n. ``clock`` replaces ``now`` in facts.

    Several messages of one origin take effect in successive cycles, so that the program can tell their order. The
    update starts the last of these cycles; the others are idle.

    If the solver drops or refuses an update, facts are omitted from it. They are fed again, half of them at a time,
    until the faulty fact is alone.

    Attributes:
        arrivals: the number of arrivals so far.

    """

    GROUP = "feeder"
    FIELDS = fields(
        _requests=_REQUESTS,
        _rejected=List[Symbol],
        _executed=Tuple[Action, ...],
        _withdrawn=FrozenSet[Symbol],
        _waits=Optional[int],
        _paused=Optional[float],
        _room=Optional[int],
        arrivals=int,
    )
    TABLES = tables(_facts=("fact", Symbol, Observation))

    def __init__(self, clock: Optional[Clock] = None) -> None:
        self._clock = clock or Clock()
        self._requests: List[Request] = []
        self._rejected: List[Symbol] = []
        self._facts: Dict[Symbol, Observation] = {}
        self._executed: Tuple[Action, ...] = ()
        self._withdrawn: FrozenSet[Symbol] = frozenset()
        self._room: Optional[int] = None  # maximum number of omitted facts in an update, None if there are none
        self._waits: Optional[int] = None  # number of arrivals at which waiting for another one began
        self._paused: Optional[float] = None  # time at which a pause began
        self.arrivals = 0

    @property
    def pending(self) -> bool:
        """Whether anything waits to be fed."""
        return bool(self._requests or self._executed or self._facts) and not self.pauses

    @property
    def pauses(self) -> bool:
        """Whether the next update waits for an arrival or for the end of a pause."""
        return self.arrivals == self._waits

    @property
    def _due(self) -> Mapping[Symbol, Observation]:
        """The waiting facts for the next update, as sent; of omitted ones, those with the fewest attempts."""
        if self._room is None:
            return self._facts
        omitted = [one for one, fact in self._facts.items() if fact.attempts is not None]
        later = frozenset(sorted(omitted, key=lambda one: self._facts[one].attempts or 0)[self._room :])
        return {one: fact for one, fact in self._facts.items() if one not in later}

    def has_unexpected(self, expected: Container[Optional[Symbol]]) -> bool:
        """Return whether the next update contains more than requests, executed actions and ``expected`` facts."""
        unexpected = (fact for fact in self._due if fact not in expected)
        return bool(self._rejected or self._withdrawn) or any(True for _ in unexpected)

    @property
    def requests(self) -> Tuple[Request, ...]:
        """The new goals and cancellations that wait to be fed."""
        return tuple(self._requests)

    @property
    def waiting(self) -> int:
        """The number of returns and other facts that wait to be fed."""
        return len(self._facts)

    def add_goal(self, goal: Goal) -> None:
        """Add a new goal."""
        self.arrivals += 1
        self._requests.append(goal)

    def withdraw(self, goal: Goal) -> None:
        """Remove a goal that was cancelled before it was fed."""
        self._requests = [item for item in self._requests if item is not goal]

    def add_withdrawals(self, requests: FrozenSet[Symbol]) -> None:
        """Report withdrawn requests in the next update, if there is one."""
        self._withdrawn |= requests

    def withdraw_fact(self, atom: Symbol) -> None:
        """Withdraw a fact with the next update, or remove it if it still waits."""
        if self._facts.pop(atom, None) is None:
            self._withdrawn |= {atom}

    def add_cancellation(self, identifier: Symbol) -> None:
        """Add the cancellation of a goal that was fed."""
        self.arrivals += 1
        self._requests.append(identifier)

    def add_rejection(self, identifier: Symbol) -> None:
        """Cancel a rejected goal with the next update, if there is one, so that no late fact revives it."""
        self._rejected.append(identifier)

    def add_fact(self, atom: Symbol, origin: str = "", cycle: int = 0, message: int = 0) -> None:
        """Add a return or another fact that arrived in ``cycle``; it replaces an equal fact of the same update.

        ``message`` is the number of its message; later messages have greater numbers.
        """
        self.arrivals += 1
        known = self._facts.pop(atom, None) if _is_of_now(atom) else self._facts.get(atom)
        fact = known or Observation(atom, cycle, origin=origin, original=atom)
        self._facts[atom] = fact._replace(message=message)

    def add_executed(self, actions: Iterable[Action]) -> None:
        """Add the executed actions of a cycle; the next update commits to them."""
        self._executed += tuple(actions)

    def forget_executed(self) -> None:
        """Remove executed actions and their returns, which the solver refuses."""
        for atom in [atom for atom, one in self._facts.items() if one.is_return]:
            del self._facts[atom]
        self._executed = ()

    def add_failure(self, answer: Symbol, actions: Tuple[Action, ...]) -> None:
        """Record the actions that a failure return can refer to, if the return waits."""
        if answer in self._facts:
            self._facts[answer] = self._facts[answer]._replace(actions=actions)

    def next_update(self, step: int, first_open: int = 0, chosen: Optional[Sequence[Request]] = None) -> Batch:
        """Return the update that starts cycle ``step``, or a later one.

        Call :meth:`update_accepted` once the solver has accepted it. The update contains the ``chosen`` requests, None
        for all. Facts of cycles before ``first_open`` are too late, and are redated to the present.

        A new goal waits for another update if a fact of this one takes effect only there. It also waits if this update
        cancels an aborted goal with the same identifier.
        """
        too_early = any(self._clock.is_too_early(fact, step) for fact in self._facts)
        chosen = self._requests if chosen is None else chosen
        requests = [one for one in chosen if not (too_early and isinstance(one, Goal))]
        due = self._due
        batch = self._batch(step, self._executed, self._after_rejected(requests), due.values(), first_open)
        turns = _turns(due.values())
        most = max(turns.values(), default=0)
        facts = [fact for atom, fact in due.items() if turns.get(atom, most) == most]
        return batch._replace(
            first=self._batch(step, self._executed, batch.requests, facts, first_open) if most else None
        )

    def update_accepted(
        self, batch: Batch, present: Optional[Container[Optional[Symbol]]] = None, refused: bool = False
    ) -> List[Observation]:
        """Record that the solver has accepted the latest update with the heads ``present``, None for all.

        If the whole update was dropped or ``refused``, omitted facts and cancellations are fed again. Returns the facts
        that are dropped instead.
        """
        present = batch.update.heads if present is None else present
        for one in batch.requests:
            waiting: List[Any] = self._rejected if one in self._rejected else self._requests
            if one in waiting and (isinstance(one, Goal) or self._request(one, batch.update.step or 0) in present):
                waiting.remove(one)
        kept = [one for one in batch.requests if not isinstance(one, Goal) and one in self._rejected]
        self._rejected, self._executed, self._waits, self._withdrawn = kept, (), None, frozenset()
        for goal in batch.goals:
            goal.request_cycle = batch.request_cycle
        return self._omit([one for one in batch.facts if not one.is_return and one.atom not in present], batch, refused)

    def _omit(self, omitted: Sequence[Observation], batch: Batch, refused: bool) -> List[Observation]:
        """Record that a batch was accepted without the ``omitted`` facts; return the facts to drop.

        A fact is dropped if it was alone in too many updates, or in a single one if the solver refused it.
        """
        alone = sum(not one.is_return for one in batch.facts) == 1
        attempts = {one.sent: (one.attempts or 0) + alone for one in omitted}
        lost = [one for one in omitted if attempts[one.sent] >= (1 if refused else MOST_TRIES)]
        for one in batch.facts:
            if one.sent in self._facts and one.sent in attempts and one not in lost:
                self._facts[one.sent] = self._facts[one.sent]._replace(attempts=attempts[one.sent])
            else:
                self._facts.pop(one.sent, None)
        if omitted:
            self._room = max(1, len(omitted) // 2)
        elif self._room is not None:
            self._room = 2 * self._room if any(one.attempts is not None for one in self._facts.values()) else None
        return lost

    def wait(self, now: Optional[float] = None) -> None:
        """Wait for another arrival before the next update or, with ``now``, for at most ``PAUSE`` seconds."""
        self._waits, self._paused = self.arrivals, now

    def tick(self, now: float) -> None:
        """Advance the time, in seconds of any clock."""
        if self._paused is not None and not 0.0 <= now - self._paused < PAUSE:
            self._waits = self._paused = None

    def find_goals(self, goal_of: Callable[[str], Optional[Goal]]) -> None:
        """Replace the goals of a record by those that ``goal_of`` returns for their keys."""
        found = [goal_of(one["goal"]) if isinstance(one, dict) else one for one in self._requests]
        self._requests = [one for one in found if one is not None]

    def preview(
        self, step: int, executed: Iterable[Action], further: Iterable[Symbol] = (), first_open: int = 0
    ) -> StreamUpdate:
        """Return the next update as it would be with ``further`` facts."""
        facts = {**self._due, **{atom: Observation(atom, step) for atom in further}}
        requests = self._after_rejected(self._requests)
        return self._batch(step, (*self._executed, *executed), requests, facts.values(), first_open).update

    def predicted(
        self, step: int, executed: Sequence[Action], requests: Iterable[Request] = (), first_open: int = 0
    ) -> StreamUpdate:
        """Return the update of ``step`` with the commitments and success returns of ``executed``, and ``requests``."""
        returns = (Observation(success_of(action), step - 1) for action in executed)
        return self._batch(step, executed, requests, returns, first_open).update

    def _after_rejected(self, requests: Sequence[Request]) -> Tuple[Request, ...]:
        """Return the cancellations of rejected goals, followed by ``requests``.

        Rejected goals that were requested again are not cancelled. A new goal waits if one of the requests cancels an
        aborted goal with the same identifier.
        """
        cancelled = [one for one in requests if not isinstance(one, Goal)]
        requests = [one for one in requests if not (isinstance(one, Goal) and one.identifier in cancelled)]
        renewed = [one.identifier for one in requests if isinstance(one, Goal)]
        return (*(one for one in self._rejected if one not in renewed), *requests)

    def _batch(
        self,
        step: int,
        executed: Iterable[Action],
        requests: Iterable[Request],
        facts: Iterable[Observation],
        first_open: int = 0,
    ) -> Batch:
        done, facts = tuple(executed), tuple(facts)
        turns = _turns(facts)
        most = max(turns.values(), default=0)
        if most:
            first_ones = (fact for fact, turn in turns.items() if turn == most)
            step += most + any(self._clock.is_too_early(fact, step) for fact in first_ones)
        dated = (self._dated(fact, step - turns.get(fact.atom, 0), first_open) for fact in facts)
        seen = tuple(_in_order(sorted(dated, key=lambda fact: -turns.get(fact.sent, 0)), done))
        items: List[Item] = [Expire(first_open)] if first_open > 0 else []
        items += [Withdraw(one) for one in sorted(self._withdrawn)]
        items += [commitment(action.atom) for action in done]
        items += [Statement(self._request(item, step)) for item in requests]
        items += [Statement(atom) for atom in dict.fromkeys(one.atom for one in seen)]
        return Batch(StreamUpdate(step=step, items=tuple(items)), tuple(requests), seen)

    def _dated(self, fact: Observation, step: int, first_open: int) -> Observation:
        cycle = None if fact.is_return else self._clock.cycle_of(fact.atom)
        if cycle is not None and cycle < first_open:
            return fact._replace(atom=self._clock.at_present(fact.atom, step), outdated=True)
        return fact._replace(atom=self._clock.dated(fact.atom, step))

    @staticmethod
    def _request(item: Request, step: int) -> Symbol:
        return request(item.term, step + 1) if isinstance(item, Goal) else cancellation(item, step)


def goals_of(requests: Iterable[Request]) -> List[Goal]:
    """Return the goals among ``requests``."""
    return [one for one in requests if isinstance(one, Goal)]


def requests_of(goals: Iterable[Goal]) -> FrozenSet[Symbol]:
    """Return the requests of those goals that were fed."""
    return frozenset(request(goal.term, goal.request_cycle) for goal in goals if goal.request_cycle is not None)


def _in_order(facts: Sequence[Observation], done: Iterable[Action]) -> Iterator[Observation]:
    """Yield ``facts`` with success returns in the order of the actions, so that the update equals its prediction."""
    places = {success_of(action): place for place, action in enumerate(done)}
    returns = iter(sorted((fact for fact in facts if fact.atom in places), key=lambda fact: places[fact.atom]))
    for fact in facts:
        yield next(returns) if fact.atom in places else fact


def _turns(facts: Iterable[Observation]) -> Dict[Symbol, int]:
    """Return, for each fact with ``now``, the number of later messages of its origin with such facts."""
    messages: Dict[str, Set[int]] = {}
    timed = [fact for fact in facts if _is_of_now(fact.atom)]
    for fact in timed:
        messages.setdefault(fact.origin, set()).add(fact.message)
    latest = {origin: sorted(numbers)[-MOST_TURNS:] for origin, numbers in messages.items()}
    later = {fact.atom: sum(one > fact.message for one in latest[fact.origin]) for fact in timed}
    return {atom: min(number, MOST_TURNS - 1) for atom, number in later.items()}


def _is_of_now(fact: Symbol) -> bool:
    return bool(fact.arguments) and fact.arguments[-1] == NOW
