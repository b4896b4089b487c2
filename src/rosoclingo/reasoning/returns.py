"""Returns and other facts from interfaces: they are checked, matched with running actions, and fed."""

import math
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import (
    Container,
    Dict,
    FrozenSet,
    Iterable,
    Iterator,
    List,
    Optional,
    Sequence,
    Tuple,
    TypeVar,
)

from clingo import Symbol, SymbolType

from rosoclingo.oclingo import ProgressionError, ReactiveProgram, parse_atom
from rosoclingo.oclingo.solving.results import is_ignored
from rosoclingo.planning.return_rules import may_heed
from rosoclingo.reasoning.durations import Durations
from rosoclingo.reasoning.events import Announcer, ReturnAccepted
from rosoclingo.reasoning.input_feeder import Clock, InputFeeder
from rosoclingo.reasoning.keywords import (
    FAILURE,
    LONGEST,
    PREEMPTED,
    RESERVED,
    RETURN,
    TAKES,
    TIMEOUT,
    Action,
    KeywordError,
    Return,
    failure_value,
    is_keyword,
    return_of,
    shortened,
    success_of,
)
from rosoclingo.reasoning.observations import MEMORY, Observation, UnhandledFailure
from rosoclingo.reasoning.records import PersistentPart, fields, tables
from rosoclingo.reasoning.repair import Change

#: Maximum number of facts in a message.
MOST_FACTS = 1000

#: Maximum number of executed actions that are reported with a plan.
DONE = 10

#: Maximum number of executed actions that the core remembers.
EXECUTED = 64

#: Maximum number of facts that wait for the next update, and of their characters; returns are not counted.
MOST_WAITING, MOST_TEXT = 10000, 1 << 24


Dated = TypeVar("Dated", Action, Return)


class ReturnError(ValueError):
    """A return or another fact is rejected; the text is the reason."""


@dataclass
class Dispatch:
    """The actions that were sent in ``cycle``, at ``started`` (seconds), and their returns.

    The return value is the parameter of the action on success, and any other value on failure. If several actions of an
    interface are running, a failure ``failed(P)`` refers to the action with parameter P. Other failures refer to any of
    the actions that no return names.

    Attributes:
        returns: the returns of the present cycle in order of arrival.
        earlier: the returns of earlier cycles.

    """

    cycle: int
    actions: Tuple[Action, ...]
    started: float
    returns: List[Return] = field(default_factory=list)
    earlier: List[Return] = field(default_factory=list)

    @property
    def missing(self) -> Tuple[Action, ...]:
        """The actions that have not returned; each interface has one for each outstanding return."""
        outstanding, missing = [action.interface for action in self.actions], []
        for answer in self._all:
            outstanding.remove(answer.interface)
        for action in self._unanswered:
            if action.interface in outstanding:
                outstanding.remove(action.interface)
                missing.append(action)
        return tuple(missing)

    @property
    def running(self) -> Tuple[Action, ...]:
        """The actions that can still be running: all to which the next return of their interface can refer."""
        interfaces = {one.interface for one in self.missing}
        return tuple(one for one in self._unanswered if one.interface in interfaces)

    def failures(self, answers: Iterable[Return]) -> List[Tuple[Return, Tuple[Action, ...]]]:
        """Return the failures among ``answers``, each with the actions that it can refer to, named actions first."""
        found = [(one, self.subjects(one)) for one in answers if Action(*one) not in self.actions]
        return sorted(found, key=lambda one: self._about(one[0]) is None)

    def subjects(self, answer: Return) -> Tuple[Action, ...]:
        """Return the action that a return names, or else all actions of its interface that no return names."""
        action = self._about(answer)
        if action is not None:
            return (action,)
        return tuple(one for one in self._unanswered if one.interface == answer.interface)

    def take(self, answer: Return) -> None:
        """Record a return; raises ReturnError if it matches no running action."""
        if answer.interface not in [one.interface for one in self.actions]:
            raise ReturnError(f"no action of '{answer.interface}' is under way in cycle {self.cycle}")
        action, missing = self._about(answer), [one.interface for one in self.missing]
        if answer.interface not in missing or (action is not None and action not in self._unanswered):
            raise ReturnError("the action has returned already")
        self.returns.append(answer)

    def fail(self, actions: Sequence[Action], reason: Symbol) -> List[Return]:
        """Fail running actions for ``reason``; return their returns."""
        failures = [self.failure(one, reason) for one in actions]
        self.returns += failures
        return failures

    def failure(self, action: Action, reason: Symbol) -> Return:
        """Make the return of an action that failed for ``reason``."""
        parameters = [one.parameter for one in self.actions if one.interface == action.interface]
        value = failure_value(reason, action.parameter, parameters.__contains__)
        return Return(action.interface, value, action.cycle)

    @property
    def certain(self) -> List[Return]:
        """The returns of this cycle whose actions are certain: a failure that names none waits for the others."""
        open_interfaces = {one.interface for one in self.missing}
        return [one for one in self.returns if one.interface not in open_interfaces or self._about(one) is not None]

    def end_cycle(self) -> List[Tuple[Return, Tuple[Action, ...]]]:
        """End the cycle; return the failures whose actions are certain, see :meth:`failures`."""
        ended = self.certain
        failures = self.failures(ended)
        self.earlier += ended
        self.returns = [one for one in self.returns if one not in ended]
        return failures

    @property
    def _all(self) -> List[Return]:
        return [*self.earlier, *self.returns]

    @property
    def _unanswered(self) -> List[Action]:
        """The actions that no return names."""
        answered = [self._about(answer) for answer in self._all]
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


#: Maximum number of facts with a cycle that are remembered to detect repetitions, and maximum length of such a fact.
KNOWN, SHORT = 1000, 1000


class ExecutionMonitor(PersistentPart):
    """Monitors the execution of actions, and passes returns and other facts to the feeder.

    Interfaces know an action by the cycle in which it was sent. The program knows it by the present cycle: an action
    that goes on is an action of each cycle until it returns.

    Attributes:
        cycle: the present cycle, which began with the last accepted update.
        goes_on: whether a cycle can end while its actions run: the program receives ``_running(A,P,C)``.
        observations: the latest failures and facts, oldest first.
        unhandled: the failures that the program cannot handle, until the goals that depend on them are aborted.
        durations: the durations of actions.

    """

    GROUP = "execution"
    FIELDS = fields(
        cycle=int,
        _under_way=Tuple[Action, ...],
        _left_out=FrozenSet[Action],
        _timed=List[Action],
        _dispatches=List[Dispatch],
        observations=Tuple[Observation, ...],
        unhandled=List[UnhandledFailure],
    )
    TABLES = tables(_known=("known", Symbol, type(None)), _executed=("done", Action, type(None)))

    def __init__(
        self,
        program: ReactiveProgram,
        feeder: InputFeeder,
        clock: Clock,
        announce: Announcer,
        learns: bool = True,
    ) -> None:
        """Pass facts to ``feeder``; if ``learns``, state durations to a program that declares ``_takes(A,P,S)``."""
        self._program = program
        self._feeder = feeder
        self._announce = announce
        self._clock = clock
        self._known: Dict[Symbol, None] = {}
        self._text = 0  # number of characters of the waiting facts
        self.goes_on = program.actions_go_on
        self._dispatches: List[Dispatch] = []
        self.cycle, self._under_way = 0, ()  # type: int, Tuple[Action, ...]
        self._left_out: FrozenSet[Action] = frozenset()  # running actions that the plan of this cycle leaves out
        self.durations = Durations(feeder)
        self._states_durations = learns and program.declares_external(TAKES, 3)
        self._timed: List[Action] = []  # successful actions whose durations have not been learned
        self._executed: Dict[Action, None] = {}
        self.observations: Tuple[Observation, ...] = ()
        self.unhandled: List[UnhandledFailure] = []

    @property
    def awaited(self) -> Tuple[Action, ...]:
        """The running actions as they were sent, that is, the actions without a return."""
        return tuple(action for one in self._dispatches for action in one.missing)

    @property
    def under_way(self) -> Tuple[Action, ...]:
        """All actions of the cycle, including those that have returned; none once the cycle has ended."""
        return self._under_way

    @property
    def running(self) -> Dict[Action, bool]:
        """The actions that go on after this cycle, as sent, each with whether the plan of this cycle contains it."""
        found = [action for one in self._dispatches for action in one.running] if self.goes_on else []
        return {action: action not in self._left_out for action in found}

    @property
    def has_dispatched(self) -> bool:
        """Whether an action of this cycle was sent."""
        return any(one.cycle == self.cycle for one in self._dispatches)

    @property
    def executed(self) -> Tuple[Action, ...]:
        """The latest executed actions, oldest first, even if the program has forgotten them."""
        return tuple(self._executed)

    def likely_end(self, succeeds: bool) -> Optional[Tuple[Action, Symbol]]:
        """Return the running action that probably returns next, as it was sent, and its return.

        None if nothing runs, or if the cycle ends only when several actions have returned. A failure, which only the
        last running action is expected to have, has the latest reason of the interface.
        """
        awaited = self.awaited
        if not awaited or (len(awaited) > 1 and not self.goes_on):
            return None
        expected = ((one, self.durations.expected(one)) for one in awaited)
        ends = {one: self._dispatch_of(one).started + seconds for one, seconds in expected if seconds is not None}
        action = min(awaited, key=lambda one: ends.get(one, math.inf))
        if succeeds or len(awaited) > 1:
            return action, success_of(self.present(action))
        returns = (return_of(one.atom) for one in reversed(self.observations) if one.actions)
        reason = next((one.value for one in returns if one.interface == action.interface), FAILURE)
        return action, self._failure(action, reason)

    def _dispatch_of(self, action: Action) -> Dispatch:
        return next(one for one in self._dispatches if one.cycle == action.cycle)

    def preempted(self, action: Action) -> Symbol:
        """Make the return of a running action that is preempted."""
        return self._failure(action, PREEMPTED)

    def _failure(self, action: Action, reason: Symbol) -> Symbol:
        return self.present(self._dispatch_of(action).failure(action, reason)).atom

    def present(self, one: Dated) -> Dated:
        """Return an action or a return as the program knows it: with the present cycle."""
        return one._replace(cycle=self.cycle)

    def _as_fed(self, answer: Return, subjects: Sequence[Action]) -> Return:
        """Return a return with the present cycle, about one of the ``subjects``.

        A failure does not look like the success of an action that was sent in another cycle.
        """
        value, parameter = answer.value, subjects[0].parameter
        if self.goes_on and value != parameter:
            parameters = [one.parameter for one in self._under_way if one.interface == answer.interface]
            value = failure_value(value, parameter, parameters.__contains__)
        return Return(answer.interface, value, self.cycle)

    def begin_cycle(self, cycle: int) -> None:
        """Begin a cycle: the running actions go on, as long as no plan leaves them out."""
        self.cycle, self._left_out = cycle, frozenset()
        self._under_way = tuple(map(self.present, self.running))

    def begin(
        self, cycle: int, actions: Tuple[Action, ...], now: float, sends: bool = True
    ) -> Tuple[Tuple[Action, ...], Tuple[Action, ...]]:
        """Begin the actions of ``cycle``; return those to send, and the running ones that they leave out.

        An action that is running is not sent again. Unless ``sends``, the others do not begin.
        """
        self.cycle = cycle
        running = {one.name: one for one in self.running}
        left_out = tuple(one for name, one in running.items() if name not in [action.name for action in actions])
        actions = actions if sends else tuple(one for one in actions if one.name in running)
        sent = tuple(one for one in actions if one.name not in running)
        if sent:
            self._dispatches.append(Dispatch(cycle, sent, now))
        self._under_way = actions
        self._left_out = frozenset(left_out)
        return sent, left_out

    def receive(self, origin: str, facts: Sequence[str]) -> None:
        """Accept facts from the interface ``origin``; invalid facts are reported as problems and ignored."""
        message = self._feeder.arrivals + 1
        for text in facts[:MOST_FACTS]:
            with self._guarded(origin, text):
                self._take(origin, _read(text), len(text), message)
        if len(facts) > MOST_FACTS:
            text = f"a message from '{origin}' has {len(facts)} facts, only the first {MOST_FACTS} are accepted"
            self._announce.problem(f"{text}: send several messages", origin)

    def expire(self, now: float, limit: float) -> None:
        """Fail actions that have not returned within ``limit`` seconds, 0 waits for ever; learn durations."""
        for action in self._timed:
            self.durations.learn(action, max(0.0, now - self._dispatch_of(action).started))
        self._timed.clear()
        for dispatch in self._dispatches if limit > 0 else ():
            dispatch.started = min(dispatch.started, now)  # restart the wait if time has jumped back
            if now - dispatch.started >= limit:
                self.fail(dispatch.missing, TIMEOUT, f"has not returned within {limit:g} s")

    def fail(self, actions: Sequence[Action], reason: Symbol, why: str) -> None:
        """Fail running actions, as they were sent, for ``reason``; ``why`` is the verb of the reported problem."""
        for dispatch in self._dispatches:
            failing = [one for one in actions if one.cycle == dispatch.cycle]
            before, answers = dispatch.certain, dispatch.fail(failing, reason)
            for one in failing:
                self._announce.problem(f"{one.atom} {why}: it counts as failed", one.interface_name)
            for answer in self._fresh(dispatch, before, answers):
                with self._guarded(answer.interface_name, str(answer.atom)):
                    self._feed_return(answer.interface_name, answer, dispatch)

    def end_cycle(self) -> Tuple[Action, ...]:
        """End the cycle; return its executed actions."""
        if self._states_durations:
            self.durations.state()
        self._timed.clear()
        executed, self._under_way = self._under_way, ()
        for answer, actions in (one for dispatch in self._dispatches for one in dispatch.end_cycle()):
            atom = self._as_fed(answer, actions).atom
            failure = Observation(atom, self.cycle, tuple(map(self.present, actions)))
            self._observe(failure)
            self._feeder.add_failure(failure.atom, failure.actions)
            if not self._can_handle(failure):
                self.unhandled.append(UnhandledFailure(failure))
        self._dispatches = [one for one in self._dispatches if one.missing]
        self._executed.update(dict.fromkeys(executed))
        while len(self._executed) > EXECUTED:
            del self._executed[next(iter(self._executed))]
        return executed

    def _observe(self, *seen: Observation) -> None:
        self.observations = (*self.observations, *seen)[-MEMORY:]

    @contextmanager
    def _guarded(self, origin: str, text: str) -> Iterator[None]:
        """Report errors about the fact ``text`` as problems."""
        try:
            yield
        except (ProgressionError, KeywordError, ReturnError) as error:
            message = f"'{shortened(text)}' from '{origin}' is ignored: {error}"
            self._announce.problem(message, origin)

    def _take(self, origin: str, atom: Symbol, size: int, message: int) -> None:
        """Accept a fact; raises KeywordError for a malformed return, and ReturnError for a rejected fact."""
        if is_keyword(atom, RETURN):
            self._take_return(origin, return_of(atom))
        else:
            self._check(atom)
            self._text = self._text if self._feeder.waiting else 0
            if self._feeder.waiting >= MOST_WAITING or 0 < self._text > MOST_TEXT - size:
                raise ReturnError(f"{self._feeder.waiting} facts already wait for the next update")
            if size > SHORT or not self._is_known(atom):
                self._text += size
                self._feeder.add_fact(atom, origin, self._announce.cycle, message)

    def _take_return(self, origin: str, answer: Return) -> None:
        """Accept a return; raises ReturnError if it matches no running action."""
        dispatch = next((one for one in self._dispatches if one.cycle == answer.cycle), None)
        if dispatch is None:
            raise ReturnError(f"no action of cycle {answer.cycle} is under way")
        before = dispatch.certain
        dispatch.take(answer)
        for one in self._fresh(dispatch, before, [answer]):
            self._feed_return(origin, one, dispatch)
        action = Action(*answer)
        if action in dispatch.actions and (self.goes_on or self._states_durations):
            self._timed.append(action)

    def _fresh(self, dispatch: Dispatch, before: Sequence[Return], answers: Sequence[Return]) -> Sequence[Return]:
        """Return the returns to feed after ``answers``: these or, if actions go on, those that have become certain."""
        return [one for one in dispatch.certain if one not in before] if self.goes_on else answers

    def update_accepted(self, facts: Iterable[Observation], present: Container[Optional[Symbol]]) -> None:
        """Record the ``facts`` of an accepted update that are ``present`` in it; omitted facts can be sent again."""
        for fact in facts:
            if fact.atom not in present:
                self._known.pop(fact.sent, None)
            elif not fact.is_return:
                self._observe(fact)
            if fact.outdated:
                text = f"{fact.sent} from interface {fact.origin} is too late: it is redated to {fact.atom}"
                self._announce.problem(text)

    def change(self, changes: Sequence[Change], failures: Iterable[Observation]) -> None:
        """Redate or withhold observations; ``failures`` are the failures of the last update."""
        seen = {one.atom: one for one in (*failures, *self.observations) if one.actions}
        withheld = [one.observation for one in changes if one.redated is None and one.observation.atom in seen]
        self.unhandled += [UnhandledFailure(seen[one.atom], undone=bool(one.actions)) for one in withheld]
        changed = {one.observation.atom for one in changes}
        self.observations = tuple(one for one in self.observations if one.atom not in changed)
        self._observe(*(one.observation._replace(atom=one.redated) for one in changes if one.redated is not None))
        for one in changes:
            self._announce.problem(str(one), one.observation.origin)

    def has_unhandled(self, failures: Sequence[Observation], warnings: Sequence[str]) -> bool:
        """Return whether there are unhandled failures, including failures that ``warnings`` report as ignored."""
        known = [one.failure.atom for one in self.unhandled]
        ignored = [one for one in failures if one.atom not in known and is_ignored(one.atom, warnings)]
        self.unhandled += map(UnhandledFailure, ignored)
        return bool(self.unhandled)

    def forget_all(self) -> None:
        """Forget all facts and observations."""
        self._known.clear()
        self.observations = ()
        self.unhandled.clear()

    def _can_handle(self, failure: Observation) -> bool:
        """Return whether the program declares an external for the failure, and a rule depends on it.

        A rule that depends on the success return also detects failures, by the absence of that return.
        """
        atoms = [failure.atom, return_of(failure.atom).failure, *map(success_of, failure.actions)]
        declared = self._program.can_define(failure.atom, self._program.first_step)
        return declared and may_heed(self._program.parts, atoms)

    def _is_known(self, atom: Symbol) -> bool:
        """Return whether a fact with a cycle was sent before."""
        if self._clock.cycle_of(atom) is None:
            return False
        known = atom in self._known
        self._known[atom] = None
        if len(self._known) > KNOWN:
            del self._known[next(iter(self._known))]
        return known

    def _feed_return(self, origin: str, answer: Return, dispatch: Dispatch) -> None:
        """Feed a return that has been recorded."""
        atom = self._as_fed(answer, dispatch.subjects(answer)).atom
        self._announce.emit(ReturnAccepted(self._announce.cycle, atom))
        self._check(atom)
        self._feeder.add_fact(atom, origin, self._announce.cycle)

    def _check(self, atom: Symbol) -> None:
        """Raise ReturnError if ``atom`` is a reserved keyword or not an external of the program."""
        signature = (atom.name, len(atom.arguments))
        if signature in RESERVED:
            raise ReturnError("{}/{} is reserved for the core and the program".format(*signature))
        if not self._program.declares_external(*signature):
            raise ReturnError("the program declares no external {}/{}".format(*signature))


def _read(text: str) -> Symbol:
    """Parse a fact; raises ProgressionError, and ReturnError if the text is too long."""
    if len(text) > LONGEST:
        raise ReturnError(f"it is too long: write at most {LONGEST} characters")
    return parse_atom(text)
