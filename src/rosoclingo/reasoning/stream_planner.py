"""The solver as the core uses it: it closes the past, bounds the look ahead, and goes back by going on from a log.

All that a solver takes is in its log; planners beside one another read the same log up to where their ways part.
"""

from contextlib import suppress
from dataclasses import replace
from typing import Callable, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Tuple, TypeVar

from clingo import Symbol

from rosoclingo.oclingo import (
    DroppedError,
    NotReadyError,
    SolveOutcome,
    SolverError,
    SolveResult,
    Statement,
    StreamUpdate,
    Volatile,
    commitment,
)
from rosoclingo.oclingo.progression.updates import Anew, Closed, Over, Withdraw
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.history import AcceptedUpdate, History
from rosoclingo.planning.planning_solver import PlanningSolver
from rosoclingo.planning.question import Reply
from rosoclingo.reasoning.input_feeder import Batch
from rosoclingo.reasoning.keywords import Action

T = TypeVar("T")

#: Makes a solver that nothing was fed to yet.
SolverFactory = Callable[[], PlanningSolver]


#: Cycles that stay as they were fed, so that an observation can still be named as the reason of a failure.
RECENT = 10

#: Cycles after which even what an open request saw is over.
LONG_AGO = 150

#: Cycles that a solver that begins anew takes at once.
MANY_STEPS = 100


class Halt(NamedTuple):
    """Why a search must end.

    ``disturbed`` tells that its result is of no use any more, since something has come that changes the question;
    otherwise it has taken too long.
    """

    why: str
    disturbed: bool = False


#: Called at the start of each search; what it returns is asked again and again during the search.
SearchWatch = Callable[[], Callable[[], Optional[Halt]]]


def unwatched() -> Callable[[], Optional[Halt]]:
    """Never end a search."""
    return lambda: None


def steps_for(goals: int, alone: int, left: int = 0, fresh: int = 0) -> int:
    """How many steps a plan for so many goals may have where one may have ``alone``: a tenth more for each further one.

    A proof that there is no plan has to go through all of them, so it is far fewer than all goals would need one after
    the other. Goals for which that is too few are not given up: recovery makes sure of that. Where of a plan with more
    than one goal so many steps are ``left`` there may be a quarter of ``alone`` more for each of ``fresh`` goals, and
    for what fails: a plan that begins with the one that there is is found soon. Whole multiples of ``alone`` then, so
    that this does not change with each step.
    """
    if goals <= 1:
        return alone
    more = left + (fresh + 1) * -(-alone // 4)
    return max(alone + (goals - 1) * -(-alone // 10), -(-more // alone) * alone if left else 0)


class DisturbedError(Exception):
    """The search was left for something that has come; ``kept`` tells whether its update is in force."""

    def __init__(self, why: str, kept: bool) -> None:
        super().__init__(f"the search was left: {why}")
        self.kept = kept


class Planner:
    """A reactive solver as the core uses it; its log holds all that plans follow from.

    Every search may raise DisturbedError, and DroppedError where it could be ended only by dropping the update.

    Attributes:
        lookahead: the greatest number of steps that the horizon may lie beyond the current cycle; planners that are
            made of this one have the same.
        ended_by: why the last search was ended, empty where it ended by itself.

    """

    def __init__(
        self,
        make_solver: SolverFactory,
        lookahead: int,
        watch: SearchWatch = unwatched,
        log: Optional[History] = None,
    ) -> None:
        """Plan from the start or, with ``log``, go on from there."""
        self._make_solver = make_solver
        self.lookahead = lookahead
        self._watch = watch
        self._solver = make_solver()
        if log is not None:
            self._solver.restore(log)
        self.ended_by = ""

    @property
    def solver(self) -> PlanningSolver:
        """The solver that it asks."""
        return self._solver

    @property
    def log(self) -> History:
        """All that the solver has taken."""
        return self._solver.log

    @property
    def in_force(self) -> StreamUpdate:
        """The last update as the solver has it, with its bound and closed cycles; empty if there is none."""
        return self.log.update or StreamUpdate(self.log.step)

    @property
    def stream(self) -> Stream:
        """The last update and what it followed on: what it is about where there is no plan."""
        return Stream(self._before or History(), self.in_force, self.lookahead)

    def ends_later(self, step: int) -> bool:
        """Whether the last answer, and each that there is, ends later than at ``step``."""
        plan = self.log.plan
        return plan is not None and plan.shortest and plan.horizon > step

    def over(self, step: int, since: int = 0) -> int:
        """What concerns cycles before the one returned comes too late from the update of ``step`` on.

        ``since`` is the cycle of the oldest request that still matters. What lies well before it is over.
        """
        return max(self.log.keep_from, min(since, step - 1 - RECENT), step - 1 - LONG_AGO)

    def solve(self) -> SolveResult:
        """Solve before any update."""
        return self._search(StreamUpdate(1, self.lookahead))

    def update(self, update: StreamUpdate) -> SolveResult:
        """Feed an update, which names its step, and solve; raises SolverError, with nothing changed, when refused.

        The cycles since the last update are past: only the actions that this one commits to may ever be in a plan at
        them.
        """
        return self._search(_whole(self.log, update, self.lookahead))

    def take(self, update: StreamUpdate) -> SolveResult:
        """Feed an update without looking ahead; no answer means that none was found, there may be one."""
        result = self._search(_whole(self.log, update, 0))
        unknown = result.outcome is SolveOutcome.UNSATISFIABLE and not result.permanent
        return replace(result, outcome=SolveOutcome.INTERRUPTED) if unknown else result

    def still(self, actions: Sequence[Action]) -> Optional[SolveResult]:
        """The answer of a plan that ends with these actions, one at least, and has all; None where there is none."""
        steps = max(action.cycle for action in actions) - self.log.step
        update = StreamUpdate(self.log.step, steps, (Volatile(), *(commitment(action.atom) for action in actions)))
        try:
            result = self.restarted()._search(update)
        except SolverError:
            return None
        return result if result.outcome is SolveOutcome.SATISFIABLE else None

    def inquire(
        self, update: StreamUpdate, assumable: FrozenSet[Symbol], disabled: FrozenSet[Symbol], steps: int
    ) -> Reply:
        """Return whether there would be a plan of at most ``steps`` after ``update`` without the facts ``disabled``.

        The history stays as it is. The ``disabled`` are some of the ``assumable``. The program is ground once if only
        they and the steps change.
        """
        whole = _whole(self.log, update, steps)
        verdict, halt = self._watched(lambda stopped: self._solver.inquire(whole, assumable, disabled, stopped))
        self._note(halt if verdict.satisfiable is None else None)
        return verdict

    def may_begin_with(self, action: Symbol, steps: int) -> bool:
        """Whether a plan of the present cycle and ``steps`` more holds ``action``; True where that takes too long."""
        update = StreamUpdate(self._solver.step, steps, (Volatile(), commitment(action)))
        return self._search(update).outcome is not SolveOutcome.UNSATISFIABLE

    def improve(self, stopped: Callable[[], bool]) -> Optional[SolveResult]:
        """A shorter plan, with past and present as they are; None where ``stopped`` came first or none is to be had."""
        try:
            return self._solver.improve(stopped)
        except SolverError:  # its log is as it was, the next update goes on from there
            return None

    def compact(self, stopped: Callable[[], bool]) -> None:
        """Have a log that has grown long begin anew, so that a solver reads it soon, unless ``stopped`` says so."""
        with suppress(SolverError):  # the log is as it was
            self._solver.compact(stopped)

    def prepare(self, updates: Sequence[StreamUpdate], lookahead: int) -> bool:
        """Have the answer to the last of ``updates`` prepared, should they come next; nothing waits for it.

        The plan has to go on with all before it. They look so far ahead. Tell whether it is prepared now.
        """
        log, whole = self.log, []  # type: History, List[StreamUpdate]
        for update in updates:
            whole.append(_whole(log, update, lookahead))
            log = log.with_entries(AcceptedUpdate(whole[-1], log.horizon))
        return self._solver.prefetch(whole[-1], whole[:-1])

    def has_prepared(self, update: StreamUpdate, watch: Optional[SearchWatch] = None) -> bool:
        """Return whether the answer to ``update``, as the next update, was prefetched; wait until ``watch`` says so."""
        whole = _whole(self.log, update, self.lookahead)
        if watch is None:
            return self._solver.has_prefetched(whole)
        look = watch()
        return self._solver.has_prefetched(whole, lambda: look() is not None)

    def predicts(self, update: StreamUpdate) -> bool:
        """Return whether ``update``, as the next update, needs no search."""
        return self._solver.predicts(_whole(self.log, update, self.lookahead))

    def why_none(self, result: SolveResult) -> str:
        """Return why the last search, with that ``result``, gave no plan."""
        if result.outcome is SolveOutcome.INTERRUPTED:
            return "no plan was found before the search was ended" + (f": {self.ended_by}" if self.ended_by else "")
        return f"there is no plan of at most {self.lookahead} steps"

    def restarted(self, without: FrozenSet[Symbol] = frozenset()) -> "Planner":
        """Return a planner beside this one in the same state, less the facts ``without``, its horizon short again."""
        before, taken = self._before, self.in_force
        if before is None:
            return self.at(self.log.withdraw(without))
        horizon = max(before.horizon, taken.step or before.step)
        return self.at(before.withdraw(without).with_entries(AcceptedUpdate(taken.less(without), horizon)))

    def at(self, log: History) -> "Planner":
        """Return a planner beside this one that has accepted what is in ``log``."""
        return Planner(self._make_solver, self.lookahead, self._watch, log)

    def before_update(self) -> "Planner":
        """Return another planner, which has not accepted the last update."""
        return self.at(self._before or History())

    def instead(self, update: StreamUpdate) -> Tuple["Planner", SolveResult]:
        """Return another planner, which was fed ``update`` in place of the last one, and the result."""
        planner = self.before_update()
        return planner, planner.update(update)

    def corrected(self, gone: FrozenSet[Symbol], new: Iterable[Symbol] = ()) -> Tuple["Planner", SolveResult]:
        """Return another planner, whose last update has ``new`` facts in place of the ones ``gone``, and the result.

        The update withdraws those of them that earlier updates stated.
        """
        update = self.in_force
        present = update.heads | update.committed
        stated = (Statement(one) for one in dict.fromkeys(new) if one not in present - gone)
        items = (*map(Withdraw, sorted(gone - present)), *update.less(gone).items, *stated)
        return self.instead(replace(update, items=items))

    def anew(self, step: int) -> Tuple["Planner", List[StreamUpdate], SolveResult]:
        """Return a planner that knows only that it is ``step`` now and nothing was done before; and what it was fed."""
        planner = self.at(History())
        stops = [*range(MANY_STEPS, step, MANY_STEPS), step]
        fed: List[StreamUpdate] = []
        for last, now in zip([0, *stops], stops):
            past = (Closed(last, now - 1), Over(now - RECENT)) if now > 1 else ()
            result = planner.update(StreamUpdate(now, items=past if last else (Anew(), *past)))
            fed.append(planner.in_force)
        return planner, fed, result

    @property
    def _before(self) -> Optional[History]:
        """The log before the last update, None where there is none."""
        return self.log.before_update

    def _search(self, update: StreamUpdate) -> SolveResult:
        result, halt = self._watched(lambda stopped: self._solver.update(update, stopped))
        self._note(halt if result.outcome is SolveOutcome.INTERRUPTED else None)
        return result

    def _watched(self, ask: Callable[[Callable[[], bool]], T]) -> Tuple[T, Optional[Halt]]:
        """Ask the solver, and tell why it was stopped, if it was."""
        while True:
            look, halt = self._watch(), None

            def stopped(look: Callable[[], Optional[Halt]] = look) -> bool:
                """Tell whether the search is to end; the first reason is kept."""
                nonlocal halt
                halt = halt or look()
                return halt is not None

            try:
                return ask(stopped), halt
            except NotReadyError:  # the search's time has not begun
                continue
            except DroppedError:
                self.ended_by = halt.why if halt else ""
                if halt and halt.disturbed:
                    raise DisturbedError(halt.why, kept=False) from None
                raise

    def _note(self, halt: Optional[Halt]) -> None:
        """Note why the search has come to nothing, if it has."""
        self.ended_by = halt.why if halt else ""
        if halt and halt.disturbed:
            raise DisturbedError(halt.why, kept=True)


def _whole(log: History, update: StreamUpdate, lookahead: int) -> StreamUpdate:
    """Return ``update`` with its bound, and with what it says of the past as far as that is new after ``log``."""
    known = [item for item in update.items if isinstance(item, Over) and item.step <= log.keep_from]
    items = tuple(item for item in update.items if item not in known)
    if update.step is not None and update.step > log.step and not any(isinstance(one, Closed) for one in items):
        items = (Closed(log.step, update.step - 1), *items)
    return replace(update, bound=lookahead, items=items)


def in_turns(planner: Planner, batch: Batch, result: SolveResult) -> Tuple[Planner, Batch, SolveResult]:
    """Return the planner that goes on from the ``result`` of a batch, the batch that it was fed, and the result.

    The messages of one origin take effect in successive cycles of one update, which are idle except the last. A
    program that demands an action in each cycle has no answer then: it gets the first messages now, and the others in
    later updates.
    """
    if batch.first is None or result.outcome is not SolveOutcome.UNSATISFIABLE:
        return planner, batch, result
    try:
        _, idle = planner.instead(batch.without_present_facts)
        if idle.outcome is not SolveOutcome.UNSATISFIABLE:
            return planner, batch, result
        beside, found = planner.instead(batch.first.update)
    except DisturbedError as disturbance:
        disturbance.kept = True
        raise
    except SolverError:
        return planner, batch, result
    return beside, batch.first, found
