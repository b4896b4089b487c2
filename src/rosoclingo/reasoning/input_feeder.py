"""The input feeder of Fig. 4: it turns what happened into the next stream update."""

import math
from typing import (
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
from rosoclingo.oclingo.progression.updates import Item, Over, Withdraw
from rosoclingo.planning.text import symbols_from_text, symbols_to_text
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.keywords import NOW, Action, cancellation, request, success_of
from rosoclingo.reasoning.observations import Observation
from rosoclingo.reasoning.records import Record, actions_of, actions_to_text, group, symbol_of, text_of

#: Limit of cycles for several messages of one origin in one update; older messages take effect in the first cycle.
MOST_TURNS = 16

#: Seconds until an update of which nothing was taken comes again, if nothing else has arrived.
PAUSE = 10.0

#: Limit of updates that omit a fact though it was their only one, before the fact is dropped.
MOST_TRIES = 5

#: Seconds for which such a fact rests after the second time; the rest doubles each further time.
FACT_REST = 10.0


#: A goal, or the identifier of a cancelled one.
Request = Union[Goal, Symbol]


class Batch(NamedTuple):
    """A stream update with its ``requests`` (an identifier stands for its cancellation) and ``facts``, in order.

    Where facts take effect in several cycles, ``first`` is the update that carries those of the first one alone.
    """

    update: StreamUpdate
    requests: Tuple[Request, ...] = ()
    facts: Tuple[Observation, ...] = ()
    first: Optional["Batch"] = None

    @property
    def goals(self) -> Tuple[Goal, ...]:
        """The goals whose requests the update carries for the first time."""
        return tuple(item for item in self.requests if isinstance(item, Goal))

    @property
    def known_goals(self) -> List[Goal]:
        """Those of the goals that the program was told of."""
        return [goal for goal in self.goals if goal.live and goal.fed]

    @property
    def step(self) -> int:
        """The cycle that the update starts."""
        return self.update.step or 0

    @property
    def request_cycle(self) -> int:
        """The cycle that the goals' requests carry."""
        return self.step + 1

    @property
    def without_goals(self) -> StreamUpdate:
        """The same update without the goals' requests."""
        return self.update.less(frozenset(request(goal.term, self.request_cycle) for goal in self.goals))

    @property
    def failures(self) -> Tuple[Observation, ...]:
        """The returns of failed actions, each with its actions."""
        return tuple(one for one in self.facts if one.actions)

    @property
    def without_present_facts(self) -> StreamUpdate:
        """The same update without the facts stated for ``now``."""
        return self.update.less(frozenset(one.atom for one in self.facts if _is_of_now(one.sent)))

    @property
    def indispensable(self) -> StreamUpdate:
        """The same update without the goals' requests and the facts that are no returns.

        Executed actions and their returns are always fed together; new goals and other facts can come later.
        """
        later = {one.atom for one in self.facts if not one.is_return}
        return self.without_goals.less(frozenset(later))


class Clock:
    """Replaces ``now`` in facts by the cycle in which they take effect.

    ``delay(name, arity)`` tells after how many cycles what is seen of such a fact bears on actions: in update n, which
    starts cycle n, a fact of cycle n - delay is the first that the action of cycle n heeds. None stands for a
    predicate whose last argument is no cycle. ``first`` is the first cycle that there is.
    """

    def __init__(self, delay: Callable[[str, int], Optional[int]] = lambda name, arity: 0, first: int = 1) -> None:
        self._delay = delay
        self._first = first

    def dated(self, fact: Symbol, step: int) -> Symbol:
        """Return ``fact`` as the update of ``step`` is to state it: unchanged unless it is of ``now``."""
        return self.at_present(fact, step) if _is_of_now(fact) else fact

    def is_too_early(self, fact: Symbol, step: int) -> bool:
        """Whether a fact of now would need a cycle before the first one to take effect at ``step``."""
        return _is_of_now(fact) and step - self._delay_of(fact) < self._first

    def at_present(self, fact: Symbol, step: int) -> Symbol:
        """Return ``fact`` as if seen just now, its last argument replaced."""
        cycle = max(step - self._delay_of(fact), self._first)
        return Function(fact.name, [*fact.arguments[:-1], Number(cycle)], fact.positive)

    def cycle_of(self, fact: Symbol) -> Optional[int]:
        """Return the cycle of a fact; None where its predicate has none or its last argument is no number."""
        if not fact.arguments or self._delay(fact.name, len(fact.arguments)) is None:
            return None
        last = fact.arguments[-1]
        return last.number if last.type is SymbolType.Number else None

    def _delay_of(self, fact: Symbol) -> int:
        return self._delay(fact.name, len(fact.arguments)) or 0


class LeftFacts:
    """Facts that updates omitted, as the solver dropped or refused the update with them.

    They are fed again, half as many at a time, until the faulty one is alone.
    """

    def __init__(self) -> None:
        self._tries: Dict[Symbol, int] = {}  # how often a fact that was alone was omitted
        self._rests: Dict[Symbol, float] = {}  # until when
        self._room: Optional[int] = None  # the limit of them in an update
        self._now = -math.inf

    def due(self, facts: Dict[Symbol, Observation]) -> Dict[Symbol, Observation]:
        """Return those of the waiting ``facts``, by their atoms as sent, that the next update can carry."""
        if not self._tries:
            return facts
        ready = [one for one in facts if one in self._tries and self._rests.get(one, -math.inf) <= self._now]
        fit = frozenset(ready[: self._room])
        return {one: seen for one, seen in facts.items() if one not in self._tries or one in fit}

    def taken(self, facts: Iterable[Observation], left: Sequence[Observation], refused: bool) -> List[Observation]:
        """Note that an update omitted the facts ``left``; return those alone too often, once if refused."""
        others = [one for one in facts if not one.is_return]
        for one in frozenset(others).difference(left) if self._tries else ():
            self._drop(one)
        if left:
            self._room = max(1, len(left) // 2)
        elif self._room is not None:
            self._room = 2 * self._room if self._tries else None
        lost: List[Observation] = []
        for one in left:
            key = one.sent
            self._tries[key] = self._tries.get(key, 0) + (len(others) == 1)
            if self._tries[key] > 1:
                self._rests[key] = math.inf  # the search has taken time: the rest begins at the next tick
            if self._tries[key] >= (1 if refused else MOST_TRIES):
                self._drop(one)
                lost.append(one)
        return lost

    def tick(self, now: float) -> None:
        """Advance the time, in seconds of any clock; where it has jumped back, a rest begins now."""
        self._now = now
        for key, until in self._rests.items():
            self._rests[key] = min(until, now + FACT_REST * 2 ** (self._tries[key] - 2))

    def record(self) -> Record:
        """Return the facts as a section of plain values, none where there are no facts."""
        return {f"left:{text_of(key)}": tries for key, tries in self._tries.items()}

    def restore(self, record: Record) -> None:
        """Restore from a record; the facts come one at a time, and each rest starts again."""
        self._tries = {symbol_of(text): tries for text, tries in group(record, "left").items()}
        self._rests = {key: math.inf for key, tries in self._tries.items() if tries > 1}
        self._room = 1 if self._tries else None

    def _drop(self, one: Observation) -> None:
        for table in (self._tries, self._rests):
            table.pop(one.sent, None)


class InputFeeder:
    """Collects requests, cancellations, returns and other facts in order of arrival, until an update takes them.

    Within an update commitments come first, then requests and cancellations, then returns and other facts, those of
    several actions that were a success in the order of the actions; a new goal
    in update n carries cycle n+1, a cancellation n (as in the paper's printed updates). ``clock`` knows the cycle of
    facts that are stated for ``now``. Several messages of one origin take effect in successive cycles, so that the
    program knows which came last: the update starts the last of these cycles, the others are idle. Facts that an
    update omitted are fed again, in ever smaller parts.

    Attributes:
        arrivals: how many things have arrived so far.

    """

    def __init__(self, clock: Optional[Clock] = None) -> None:
        self._clock = clock or Clock()
        self._requests: List[Request] = []
        self._rejected: List[Request] = []
        self._facts: Dict[Symbol, Observation] = {}
        self._executed: Tuple[Action, ...] = ()
        self._withdrawn: FrozenSet[Symbol] = frozenset()
        self._left = LeftFacts()
        self._waits: Optional[int] = None  # for more to arrive than has by now
        self._paused: Optional[float] = None  # since when
        self.arrivals = 0

    @property
    def pending(self) -> bool:
        """Whether anything waits to be fed."""
        waits = self._requests or self._executed or self._left.due(self._facts)
        return bool(waits) and self.arrivals != self._waits

    def has_beside(self, expected: Container[Optional[Symbol]]) -> bool:
        """Whether the next update reports more than requests, executed actions and facts that are ``expected``."""
        unexpected = (fact for fact in self._left.due(self._facts) if fact not in expected)
        return bool(self._rejected or self._withdrawn) or any(True for _ in unexpected)

    @property
    def requests(self) -> Tuple[Request, ...]:
        """The new goals and cancellations that wait to be fed."""
        return tuple(self._requests)

    @property
    def waiting(self) -> int:
        """How many returns and other facts wait to be fed."""
        return len(self._facts)

    def add_goal(self, goal: Goal) -> None:
        """Take a new goal."""
        self.arrivals += 1
        self._requests.append(goal)

    def withdraw(self, goal: Goal) -> None:
        """Forget a goal that was cancelled before it was fed."""
        self._requests = [item for item in self._requests if item is not goal]

    def add_withdrawals(self, requests: FrozenSet[Symbol]) -> None:
        """Requests were taken out of the program: the next update, if there is one, says so."""
        self._withdrawn |= requests

    def add_cancellation(self, identifier: Symbol) -> None:
        """Take the cancellation of a goal that was fed."""
        self.arrivals += 1
        self._requests.append(identifier)

    def add_rejection(self, identifier: Symbol) -> None:
        """Take a goal rejected by the program: the next update, if any, cancels it, lest a late fact revive it."""
        self._rejected.append(identifier)

    def add_fact(self, atom: Symbol, origin: str = "", cycle: int = 0, message: int = 0) -> None:
        """Take a return or another fact that arrived in ``cycle``; of equal facts in an update the last one counts.

        ``message`` is greater for a later message.
        """
        self.arrivals += 1
        known = self._facts.pop(atom, None) if _is_of_now(atom) else self._facts.get(atom)
        fact = known or Observation(atom, cycle, origin=origin, original=atom)
        self._facts[atom] = fact._replace(message=message)

    def add_executed(self, actions: Iterable[Action]) -> None:
        """Take the actions of a cycle that has ended: the next update commits to them."""
        self._executed += tuple(actions)

    def forget_executed(self) -> None:
        """Forget executed actions and their returns, which the solver refuses."""
        self._facts = {atom: one for atom, one in self._facts.items() if not one.is_return}
        self._executed = ()

    def add_failure(self, answer: Symbol, actions: Tuple[Action, ...]) -> None:
        """Note the actions that a return of failure can be about, if that return waits."""
        if answer in self._facts:
            self._facts[answer] = self._facts[answer]._replace(actions=actions)

    def next_update(self, step: int, over: int = 0, chosen: Optional[Sequence[Request]] = None) -> Batch:
        """Return the update that starts cycle ``step``, or a later one; its content waits until it is ``taken``.

        It has the ``chosen`` requests, None for all.

        Facts of cycles before ``over`` come too late, and are taken for the present. New goals wait for the next update
        where a fact of now takes effect only then; so does one whose identifier is that of a goal that was given up and
        of whose cancellation the program hears only now.
        """
        too_early = any(self._clock.is_too_early(fact, step) for fact in self._facts)
        chosen = self._requests if chosen is None else chosen
        requests = [one for one in chosen if not (too_early and isinstance(one, Goal))]
        due = self._left.due(self._facts)
        batch = self._batch(step, self._executed, self._after_rejected(requests), due.values(), over)
        turns = _turns(due.values())
        most = max(turns.values(), default=0)
        facts = [fact for atom, fact in due.items() if turns.get(atom, most) == most]
        return batch._replace(first=self._batch(step, self._executed, batch.requests, facts, over) if most else None)

    def taken(
        self, batch: Batch, present: Optional[Container[Optional[Symbol]]] = None, refused: bool = False
    ) -> List[Observation]:
        """Record that the latest update is in force, with those of its heads that are ``present`` (None: all).

        These no longer wait, and the program knows its goals. Facts and cancellations that were omitted, as the whole
        update was dropped or ``refused``, are fed again. Returns the facts that are not.
        """
        present = batch.update.heads if present is None else present
        for one in batch.requests:
            waiting = self._rejected if one in self._rejected else self._requests
            if one in waiting and (isinstance(one, Goal) or self._request(one, batch.update.step or 0) in present):
                waiting.remove(one)
        kept = [one for one in batch.requests if one in self._rejected]
        self._rejected, self._executed, self._waits, self._withdrawn = kept, (), None, frozenset()
        left = [one for one in batch.facts if not one.is_return and one.atom not in present]
        lost = self._left.taken(batch.facts, left, refused)
        for fact in frozenset(batch.facts).difference(left).union(lost):
            self._facts.pop(fact.sent, None)
        for goal in batch.goals:
            goal.feed(batch.request_cycle)
        return lost

    def wait(self, now: Optional[float] = None) -> None:
        """The next update is not to be made before something else arrives or, from ``now`` on, some time has passed."""
        self._waits, self._paused = self.arrivals, now

    def tick(self, now: float) -> None:
        """Time passes, in seconds of whatever clock."""
        if self._paused is not None and not 0.0 <= now - self._paused < PAUSE:
            self._waits = self._paused = None
        self._left.tick(now)

    def record(self) -> Record:
        """Return what waits as plain values; goals by their keys."""
        feeder = {
            "requests": [
                {"goal": one.key} if isinstance(one, Goal) else {"symbol": text_of(one)} for one in self._requests
            ],
            "rejected": [text_of(one) for one in self._rejected if not isinstance(one, Goal)],
            "executed": actions_to_text(self._executed),
            "withdrawn": symbols_to_text(sorted(self._withdrawn)),
            "waits": self._waits,
            "paused": self._paused,
            "arrivals": self.arrivals,
        }
        facts = {f"fact:{text_of(fact)}": seen.record() for fact, seen in self._facts.items()}
        return {**facts, "feeder": feeder, **self._left.record()}

    def restore(self, record: Record, goal_of: Callable[[str], Optional[Goal]]) -> None:
        """Resume from a record; ``goal_of`` gives a live goal by its key."""
        feeder = record["feeder"]
        self._waits, self._paused, self.arrivals = feeder["waits"], feeder["paused"], feeder["arrivals"]
        self._left.restore(record)
        requests = feeder["requests"]
        found = [goal_of(one["goal"]) if "goal" in one else symbol_of(one["symbol"]) for one in requests]
        self._requests = [one for one in found if one is not None]
        self._rejected = list(map(symbol_of, feeder["rejected"]))
        self._executed = actions_of(feeder["executed"])
        self._withdrawn = symbols_from_text(feeder["withdrawn"])
        facts = group(record, "fact").items()
        self._facts = {symbol_of(text): Observation.of_record(value) for text, value in facts}

    def preview(
        self, step: int, executed: Iterable[Action], further: Iterable[Symbol] = (), over: int = 0
    ) -> StreamUpdate:
        """Return what the next update would be, with ``further`` facts."""
        facts = {**self._left.due(self._facts), **{atom: Observation(atom, step) for atom in further}}
        requests = self._after_rejected(self._requests)
        return self._batch(step, (*self._executed, *executed), requests, facts.values(), over).update

    def predicted(
        self, step: int, executed: Sequence[Action], requests: Iterable[Request] = (), over: int = 0
    ) -> StreamUpdate:
        """Return the update of ``step`` after the success of ``executed``, with only ``requests`` besides."""
        returns = (Observation(success_of(action), step - 1) for action in executed)
        return self._batch(step, executed, requests, returns, over).update

    def _after_rejected(self, requests: Sequence[Request]) -> Tuple[Request, ...]:
        """Return ``requests`` behind the cancellations of what was rejected, but for what is asked for anew.

        Goals are left out of whose identifiers others were given up, as is told only with these requests.
        """
        given_up = [one for one in requests if not isinstance(one, Goal)]
        requests = [one for one in requests if not (isinstance(one, Goal) and one.identifier in given_up)]
        renewed = [one.identifier for one in requests if isinstance(one, Goal)]
        return (*(one for one in self._rejected if one not in renewed), *requests)

    def _batch(
        self,
        step: int,
        executed: Iterable[Action],
        requests: Iterable[Request],
        facts: Iterable[Observation],
        over: int = 0,
    ) -> Batch:
        done, facts = tuple(executed), tuple(facts)
        turns = _turns(facts)
        step += self._further_cycles(turns, step)
        dated = (self._dated(fact, step - turns.get(fact.atom, 0), over) for fact in facts)
        seen = tuple(_in_order(sorted(dated, key=lambda fact: -turns.get(fact.sent, 0)), done))
        items: List[Item] = [Over(over)] if over > 0 else []
        items += [Withdraw(one) for one in sorted(self._withdrawn)]
        items += [commitment(action.atom) for action in done]
        items += [Statement(self._request(item, step)) for item in requests]
        items += [Statement(atom) for atom in dict.fromkeys(one.atom for one in seen)]
        return Batch(StreamUpdate(step=step, items=tuple(items)), tuple(requests), seen)

    def _further_cycles(self, turns: Mapping[Symbol, int], step: int) -> int:
        """Return the number of cycles from ``step`` to the last facts' effect; see :func:`_turns`."""
        most = max(turns.values(), default=0)
        first_ones = (fact for fact, turn in turns.items() if turn == most)
        return most + (most > 0 and any(self._clock.is_too_early(fact, step) for fact in first_ones))

    def _dated(self, fact: Observation, step: int, over: int) -> Observation:
        cycle = None if fact.is_return else self._clock.cycle_of(fact.atom)
        if cycle is not None and cycle < over:
            return fact._replace(atom=self._clock.at_present(fact.atom, step), outdated=True)
        return fact._replace(atom=self._clock.dated(fact.atom, step))

    @staticmethod
    def _request(item: Request, step: int) -> Symbol:
        return request(item.term, step + 1) if isinstance(item, Goal) else cancellation(item, step)


def requests_of(goals: Iterable[Goal]) -> FrozenSet[Symbol]:
    """Return the requests of the goals that were fed."""
    return frozenset(request(goal.term, goal.request_cycle) for goal in goals if goal.request_cycle is not None)


def _in_order(facts: Sequence[Observation], done: Iterable[Action]) -> Iterator[Observation]:
    """Yield ``facts`` with the returns of success in the order of the actions: so what is predicted is what comes."""
    places = {success_of(action): place for place, action in enumerate(done)}
    returns = iter(sorted((fact for fact in facts if fact.atom in places), key=lambda fact: places[fact.atom]))
    for fact in facts:
        yield next(returns) if fact.atom in places else fact


def _turns(facts: Iterable[Observation]) -> Dict[Symbol, int]:
    """Return, for each fact of now, the number of later messages of its origin with such facts."""
    messages: Dict[str, Set[int]] = {}
    timed = [fact for fact in facts if _is_of_now(fact.atom)]
    for fact in timed:
        messages.setdefault(fact.origin, set()).add(fact.message)
    later = {fact.atom: sum(one > fact.message for one in messages[fact.origin]) for fact in timed}
    return {atom: min(number, MOST_TURNS - 1) for atom, number in later.items()}


def _is_of_now(fact: Symbol) -> bool:
    return bool(fact.arguments) and fact.arguments[-1] == NOW
