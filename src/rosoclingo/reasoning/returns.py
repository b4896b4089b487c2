"""Returns and other facts from interfaces: they are checked, matched with running actions, and fed."""

from collections import Counter, deque
from contextlib import contextmanager
from typing import Callable, Container, Deque, Dict, Iterable, Iterator, List, Optional, Sequence, Tuple

from clingo import Symbol, SymbolType

from rosoclingo.oclingo import ProgressionError, ReactiveProgram, parse_atom
from rosoclingo.oclingo.solving.results import is_ignored
from rosoclingo.planning.return_rules import may_heed
from rosoclingo.reasoning.events import Event, FactAccepted, Problem, ReturnAccepted
from rosoclingo.reasoning.input_feeder import Clock, InputFeeder
from rosoclingo.reasoning.keywords import (
    FAILURE,
    LONGEST,
    PREEMPTED,
    RESERVED,
    RETURN,
    TIMEOUT,
    Action,
    KeywordError,
    Return,
    action_of,
    failure_value,
    is_keyword,
    return_of,
    shortened,
    success_of,
)
from rosoclingo.reasoning.observations import MEMORY, Observation, UnhandledFailure
from rosoclingo.reasoning.records import (
    Record,
    action_to_text,
    actions_of,
    actions_to_text,
    keys_of,
    symbol_of,
    text_of,
)
from rosoclingo.reasoning.repair import Change

#: Maximum number of facts in a message.
MOST_FACTS = 1000

#: Maximum number of executed actions that are reported with a plan.
DONE = 10

#: Maximum number of executed actions that the core remembers.
EXECUTED = 64

#: Maximum number of facts that wait for the next update, and of their characters; returns are not counted.
MOST_WAITING, MOST_TEXT = 10000, 1 << 24


class ReturnError(ValueError):
    """A return or another fact is rejected; the text is the reason."""


class Dispatch:
    """The actions of ``cycle``, dispatched at ``started`` (seconds). The cycle ends when each action has returned.

    The return value is the parameter of the action on success, and any other value on failure. If several actions of an
    interface are running, a failure ``failed(P)`` refers to the action with parameter P. Other failures refer to any of
    the actions that no return names.

    Attributes:
        returns: the returns in order of arrival.

    """

    def __init__(self, cycle: int, actions: Tuple[Action, ...], started: float) -> None:
        self.cycle, self.actions, self.started = cycle, actions, started
        self.returns: List[Return] = []

    @property
    def missing(self) -> Tuple[Action, ...]:
        """The actions that have not returned; each interface has one for each outstanding return."""
        left, missing = Counter(action.interface for action in self.actions), []
        left.subtract(answer.interface for answer in self.returns)
        for action in self._unanswered:
            if left[action.interface] > 0:
                left[action.interface] -= 1
                missing.append(action)
        return tuple(missing)

    @property
    def failures(self) -> List[Tuple[Return, Tuple[Action, ...]]]:
        """The failure returns, each with the actions that it can refer to; those that name an action come first."""
        about = [(one, self._about(one)) for one in self.returns]
        named = [(one, (action,)) for one, action in about if action is not None and one.value != action.parameter]
        unnamed = [one for one, action in about if action is None]
        left = [tuple(one for one in self._unanswered if one.interface == answer.interface) for answer in unnamed]
        return [*named, *zip(unnamed, left)]

    def take(self, answer: Return) -> None:
        """Record a return; raises ReturnError if it matches no running action."""
        if answer.cycle != self.cycle:
            raise ReturnError(f"it is cycle {self.cycle} now")
        if answer.interface not in [one.interface for one in self.actions]:
            raise ReturnError(f"no action of '{answer.interface}' is under way in cycle {self.cycle}")
        action, missing = self._about(answer), [one.interface for one in self.missing]
        if answer.interface not in missing or (action is not None and action not in self._unanswered):
            raise ReturnError("the action has returned already")
        self.returns.append(answer)

    def expire(self, reason: Symbol) -> List[Tuple[Action, Return]]:
        """Fail each action without a return for ``reason``; return the actions with their returns."""
        expired = [(one, self.failure(one, reason)) for one in self.missing]
        self.returns += [answer for _, answer in expired]
        return expired

    def failure(self, action: Action, reason: Symbol) -> Return:
        """Make the return of an action that failed for ``reason``."""
        parameters = [one.parameter for one in self.actions if one.interface == action.interface]
        value = failure_value(reason, action.parameter, parameters.__contains__)
        return Return(action.interface, value, action.cycle)

    def record(self) -> Record:
        """Return the dispatch as a plain value."""
        returns = [text_of(answer.atom) for answer in self.returns]
        actions = actions_to_text(self.actions)
        return {"cycle": self.cycle, "actions": actions, "started": self.started, "returns": returns}

    @classmethod
    def of_record(cls, record: Record) -> "Dispatch":
        """Return the dispatch of :meth:`record`."""
        found = cls(record["cycle"], actions_of(record["actions"]), record["started"])
        found.returns = [return_of(symbol_of(text)) for text in record["returns"]]
        return found

    @property
    def _unanswered(self) -> List[Action]:
        """The actions that no return names."""
        answered = [self._about(answer) for answer in self.returns]
        return [action for action in self.actions if action not in answered]

    def _about(self, answer: Return) -> Optional[Action]:
        """Return the action that a return names by its parameter P or by ``failed(P)``; None if it names none."""
        value, interface = answer.value, answer.interface
        last = value.arguments[-1:] if value.type is SymbolType.Function else []
        for named in (value, *last):
            action = Action(interface, named, self.cycle)
            if action in self.actions:
                return action
        return None


#: Maximum number of remembered facts with a cycle, by which repetitions are detected, and of the characters of each.
KNOWN, SHORT = 1000, 1000


class ExecutionMonitor:
    """Monitors the execution of actions, and passes returns and other facts to the feeder.

    Attributes:
        observations: the latest failures and facts, oldest first.
        unhandled: the failures that the program cannot handle, until the goals that depend on them are aborted.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        feeder: InputFeeder,
        clock: Clock,
        emit: Callable[[Event], None],
        cycle: Callable[[], int],
    ) -> None:
        self._program = program
        self._feeder = feeder
        self._emit = emit
        self._cycle = cycle
        self._clock = clock
        self._known: Dict[Symbol, None] = {}
        self._text = 0  # number of characters of the waiting facts
        self._dispatch: Optional[Dispatch] = None
        self._executed: Deque[Action] = deque(maxlen=EXECUTED)
        self.observations: Deque[Observation] = deque(maxlen=MEMORY)
        self.unhandled: List[UnhandledFailure] = []

    @property
    def awaited(self) -> Tuple[Action, ...]:
        """The running actions, that is, the actions without a return."""
        return self._dispatch.missing if self._dispatch else ()

    @property
    def under_way(self) -> Tuple[Action, ...]:
        """All actions of the cycle, including those that have returned; none once the cycle has ended."""
        return self._dispatch.actions if self._dispatch else ()

    @property
    def executed(self) -> Tuple[Action, ...]:
        """The latest executed actions, oldest first, even if the program has forgotten them."""
        return tuple(self._executed)

    def likely_return(self, succeeds: bool) -> Optional[Symbol]:
        """Return the expected return of the last running action, None if several are running.

        A failure has the latest reason of the interface.
        """
        if self._dispatch is None or len(self.awaited) != 1:
            return None
        (action,) = self.awaited
        returns = (return_of(one.atom) for one in reversed(self.observations) if one.actions)
        reason = next((one.value for one in returns if one.interface == action.interface), FAILURE)
        return success_of(action) if succeeds else self._dispatch.failure(action, reason).atom

    def preempted(self, action: Action) -> Symbol:
        """Make the return of a running action that is preempted."""
        assert self._dispatch is not None
        return self._dispatch.failure(action, PREEMPTED).atom

    def begin(self, cycle: int, actions: Tuple[Action, ...], now: float) -> None:
        """Record that the actions of ``cycle`` are dispatched."""
        self._dispatch = Dispatch(cycle, actions, now)

    def receive(self, origin: str, facts: Sequence[str]) -> None:
        """Accept facts from the interface ``origin``; invalid facts are reported as problems and ignored."""
        message = self._feeder.arrivals + 1
        for text in facts[:MOST_FACTS]:
            with self._guarded(origin, text):
                self._take(origin, _read(text), len(text), message)
        if len(facts) > MOST_FACTS:
            self._emit(Problem(self._cycle(), too_many_facts(len(facts), origin), origin))

    def expire(self, now: float, limit: float) -> None:
        """Fail actions that have not returned within ``limit`` seconds; 0 waits for ever."""
        if self._dispatch is None or limit <= 0:
            return
        self._dispatch.started = min(self._dispatch.started, now)  # restart the wait if time has jumped back
        if now - self._dispatch.started < limit:
            return
        for action, answer in self._dispatch.expire(TIMEOUT):
            text = f"{action.atom} has not returned within {limit:g} s: it counts as failed"
            self._emit(Problem(self._cycle(), text, action.interface_name))
            with self._guarded(action.interface_name, str(answer.atom)):
                self._feed_return(action.interface_name, answer.atom)

    def end_cycle(self) -> Tuple[Action, ...]:
        """End the cycle; return its executed actions."""
        dispatch, self._dispatch = self._dispatch, None
        if dispatch is None:
            return ()
        for answer, actions in dispatch.failures:
            failure = Observation(answer.atom, answer.cycle, actions)
            self.observations.append(failure)
            self._feeder.add_failure(answer.atom, actions)
            if not self._can_handle(failure):
                self.unhandled.append(UnhandledFailure(failure))
        self._executed.extend(dispatch.actions)
        return dispatch.actions

    def record(self) -> Record:
        """Return the state as plain values."""
        return {
            "dispatch": None if self._dispatch is None else self._dispatch.record(),
            "observations": [one.record() for one in self.observations],
            "unhandled": [{"failure": one.failure.record(), "undone": one.undone} for one in self.unhandled],
            **{f"done:{action_to_text(action)}": 1 for action in self._executed},
            **{f"known:{text_of(fact)}": 1 for fact in self._known},
        }

    def restore(self, record: Record) -> None:
        """Restore from a record."""
        dispatch = record["dispatch"]
        self._dispatch = None if dispatch is None else Dispatch.of_record(dispatch)
        self.observations.extend(map(Observation.of_record, record["observations"]))
        for one in record["unhandled"]:
            self.unhandled.append(UnhandledFailure(Observation.of_record(one["failure"]), one["undone"]))
        self._executed.extend(action_of(symbol_of(text)) for text in keys_of(record, "done"))
        self._known = {symbol_of(text): None for text in keys_of(record, "known")}

    @contextmanager
    def _guarded(self, origin: str, text: str) -> Iterator[None]:
        """Report errors about the fact ``text`` as problems."""
        try:
            yield
        except (ProgressionError, KeywordError, ReturnError) as error:
            message = f"'{shortened(text)}' from '{origin}' is ignored: {error}"
            self._emit(Problem(self._cycle(), message, origin))

    def _take(self, origin: str, atom: Symbol, size: int, message: int) -> None:
        """Accept a fact; raises KeywordError for a malformed return, and ReturnError for a rejected fact."""
        if is_keyword(atom, RETURN):
            answer = return_of(atom)
            if self._dispatch is None:
                raise ReturnError("no action is under way")
            self._dispatch.take(answer)
            self._feed_return(origin, atom)
        else:
            self._check(atom)
            self._text = self._text if self._feeder.waiting else 0
            if self._feeder.waiting >= MOST_WAITING or 0 < self._text > MOST_TEXT - size:
                raise ReturnError(f"{self._feeder.waiting} facts already wait for the next update")
            if size > SHORT or not self._is_known(atom):
                self._text += size
                self._emit(FactAccepted(self._cycle(), atom))
                self._feeder.add_fact(atom, origin, self._cycle(), message)

    def update_accepted(self, facts: Iterable[Observation], present: Container[Optional[Symbol]]) -> None:
        """Record the ``facts`` of an accepted update that are ``present`` in it; omitted facts can be sent again."""
        for fact in facts:
            if fact.atom not in present:
                self._known.pop(fact.sent, None)
            elif not fact.is_return:
                self.observations.append(fact)
            if fact.outdated:
                text = f"{fact.sent} from interface {fact.origin} is too late: it is redated to {fact.atom}"
                self._emit(Problem(self._cycle(), text))

    def change(self, changes: Sequence[Change], failures: Iterable[Observation]) -> None:
        """Redate or withhold observations; ``failures`` are the failures of the last update."""
        seen = {one.atom: one for one in (*failures, *self.observations) if one.actions}
        withheld = [one.observation for one in changes if one.redated is None and one.observation.atom in seen]
        self.unhandled += [UnhandledFailure(seen[one.atom], undone=bool(one.actions)) for one in withheld]
        changed = {one.observation.atom for one in changes}
        kept = [one for one in self.observations if one.atom not in changed]
        moved = [one.observation._replace(atom=one.redated) for one in changes if one.redated is not None]
        self.observations = deque([*kept, *moved], maxlen=MEMORY)
        for one in changes:
            self._emit(Problem(self._cycle(), str(one), one.observation.origin))

    def has_unhandled(self, failures: Sequence[Observation], warnings: Sequence[str]) -> bool:
        """Return whether there are unhandled failures, including failures that ``warnings`` report as ignored."""
        known = [one.failure.atom for one in self.unhandled]
        ignored = [one for one in failures if one.atom not in known and is_ignored(one.atom, warnings)]
        self.unhandled += map(UnhandledFailure, ignored)
        return bool(self.unhandled)

    def forget_all(self) -> None:
        """Forget all facts and observations."""
        self._known.clear()
        self.observations.clear()
        self.unhandled.clear()

    def _can_handle(self, failure: Observation) -> bool:
        """Return whether the program declares an external for the failure, and a rule depends on it.

        A rule that depends on the success return also detects failures, by the absence of that return.
        """
        atoms = [failure.atom, return_of(failure.atom).failure, *map(success_of, failure.actions)]
        declared = self._program.can_define(failure.atom, self._program.first_step)
        return declared and may_heed(self._program.parts, self._program.values, atoms)

    def _is_known(self, atom: Symbol) -> bool:
        """Return whether a fact with a cycle was sent before."""
        if self._clock.cycle_of(atom) is None:
            return False
        known = atom in self._known
        self._known[atom] = None
        if len(self._known) > KNOWN:
            del self._known[next(iter(self._known))]
        return known

    def _feed_return(self, origin: str, atom: Symbol) -> None:
        """Feed a return that has been recorded."""
        self._emit(ReturnAccepted(self._cycle(), atom))
        self._check(atom)
        self._feeder.add_fact(atom, origin, self._cycle())

    def _check(self, atom: Symbol) -> None:
        """Raise ReturnError if ``atom`` is a reserved keyword or not an external of the program."""
        signature = (atom.name, len(atom.arguments))
        if signature in RESERVED:
            raise ReturnError("{}/{} is reserved for the core and the program".format(*signature))
        if not self._program.declares_external(*signature):
            raise ReturnError("the program declares no external {}/{}".format(*signature))


def too_many_facts(number: int, origin: str) -> str:
    """Return the text of the problem that a message has too many facts."""
    limit = f"only the first {MOST_FACTS} are accepted"
    return f"a message from '{origin}' has {number} facts, {limit}: send several messages"


def _read(text: str) -> Symbol:
    """Parse a fact; raises ProgressionError, and ReturnError if the text is too long."""
    if len(text) > LONGEST:
        raise ReturnError(f"it is too long: write at most {LONGEST} characters")
    return parse_atom(text)
