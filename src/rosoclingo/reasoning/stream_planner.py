"""The solver as the core uses it: it closes the past, bounds the look ahead, and can go back by one update.

All that a solver takes is in its updates; so what they say, one after the other, is all that led to its state.
"""

from contextlib import suppress
from dataclasses import replace
from typing import Callable, FrozenSet, Iterable, List, NamedTuple, Optional, Tuple

from clingo import Symbol

from rosoclingo.oclingo import (
    DroppedError,
    NotReadyError,
    SolveOutcome,
    SolveResult,
    Statement,
    StreamSolver,
    StreamUpdate,
    Volatile,
    commitment,
)
from rosoclingo.oclingo.progression.updates import Anew, Closed, Item, Over
from rosoclingo.oclingo.solving.stream_solver import Snapshot

#: Makes a solver that nothing was fed to yet.
SolverFactory = Callable[[], StreamSolver]


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
    """The search takes the time it takes."""
    return lambda: None


class DisturbedError(Exception):
    """The search was left for something that has come; ``kept`` tells whether its update is in force."""

    def __init__(self, why: str, kept: bool) -> None:
        super().__init__(f"the search was left: {why}")
        self.kept = kept


class Planner:
    """A reactive solver that knows its state before the last update.

    ``lookahead`` is the greatest number of steps that the horizon may lie beyond the current cycle. Every search may
    raise DisturbedError, and DroppedError where it could be ended only by dropping the update.

    Attributes:
        ended_by: why the last search was ended, empty where it ended by itself.
        over: what concerns cycles before this one comes too late.

    """

    def __init__(self, make_solver: SolverFactory, lookahead: int, watch: SearchWatch = unwatched) -> None:
        self._make_solver = make_solver
        self._lookahead = lookahead
        self._watch = watch
        self._solver = make_solver()
        self._before = self._solver.snapshot()
        self._past: Tuple[Item, ...] = ()  # what the next update is to say of it
        self._taken: Optional[StreamUpdate] = None
        self.ended_by = ""
        self.over = 0

    @property
    def taken(self) -> Optional[StreamUpdate]:
        """The last update as the solver has it: with its bound, and with what it says of the past."""
        return self._taken

    def solve(self) -> SolveResult:
        """Solve before any update."""
        return self._search(StreamUpdate(1, self._lookahead))

    def end_cycle(self, cycle: int, since: int = 0) -> None:
        """``cycle`` is past: only the actions that the next update commits to may ever be in a plan at it.

        ``since`` is the cycle of the oldest request that still matters. What lies well before it is over.
        """
        over = max(min(since, cycle - RECENT), cycle - LONG_AGO)
        self._past += (Closed(cycle, cycle),)
        if over > self.over:
            self.over = over
            self._past += (Over(over),)

    def update(self, update: StreamUpdate) -> SolveResult:
        """Feed an update, which names its step, and solve; raises SolverError, with nothing changed, when refused."""
        return self._feed(update, self._lookahead)

    def take(self, update: StreamUpdate) -> SolveResult:
        """Feed an update without looking ahead; no answer means that none was found, there may be one."""
        result = self._feed(update, 0)
        unknown = result.outcome is SolveOutcome.UNSATISFIABLE and not result.permanent
        return replace(result, outcome=SolveOutcome.INTERRUPTED) if unknown else result

    def may_begin_with(self, action: Symbol, steps: int) -> bool:
        """Whether a plan of the present cycle and ``steps`` more holds ``action``; True where that takes too long."""
        update = StreamUpdate(self._solver.step, steps, (Volatile(), commitment(action)))
        return self._search(update).outcome is not SolveOutcome.UNSATISFIABLE

    def why_none(self, result: SolveResult) -> str:
        """Why the last search, with that ``result``, gave no plan."""
        if result.outcome is SolveOutcome.INTERRUPTED:
            return "no plan was found before the search was ended" + (f": {self.ended_by}" if self.ended_by else "")
        return f"there is no plan of at most {self._lookahead} steps"

    def restarted(self, without: FrozenSet[Symbol] = frozenset(), coming: Iterable[Symbol] = ()) -> "Planner":
        """A planner beside this one in the same state, less the facts ``without``, and with a short horizon again.

        One that is told which facts are ``coming`` with its next update need not ground the program anew for them.
        """
        planner = self._beside(self._before.less(without))
        if self._taken is not None:
            taken = self._taken.less(without)
            said: Tuple[Item, ...] = tuple(map(Statement, coming))
            for_the_moment = (Volatile(), *said) if said else ()
            planner._feed(replace(taken, items=(*taken.items, *for_the_moment)), 0)
        planner._past = self._past
        return planner

    def instead(self, update: StreamUpdate, without: FrozenSet[Symbol] = frozenset()) -> Tuple["Planner", SolveResult]:
        """A planner beside this one that was fed ``update`` in place of the last one, and never ``without``."""
        planner = self._beside(self._before.less(without))
        past = self._taken.items if self._taken is not None else ()
        planner._past = tuple(item for item in past if isinstance(item, (Closed, Over)))
        return planner, planner.update(update.less(without))

    def anew(self, step: int) -> Tuple["Planner", List[StreamUpdate], SolveResult]:
        """A planner that knows nothing but that it is ``step`` now and nothing was done before; what it was fed."""
        planner = Planner(self._make_solver, self._lookahead, self._watch)
        stops = [*range(MANY_STEPS, step, MANY_STEPS), step]
        fed: List[StreamUpdate] = []
        for last, now in zip([0, *stops], stops):
            past = (Closed(last, now - 1), Over(max(now - RECENT, 0))) if now > 1 else ()
            planner._past = past if last else (Anew(), *past)
            result = planner.update(StreamUpdate(now))
            fed += [planner.taken] if planner.taken is not None else []
        return planner, fed, result

    def _beside(self, state: Snapshot) -> "Planner":
        planner = Planner(self._make_solver, self._lookahead, self._watch)
        planner._solver.restore(state)
        planner._before, planner.over = state, self.over
        return planner

    def _feed(self, update: StreamUpdate, lookahead: int) -> SolveResult:
        before = self._solver.snapshot()
        update = replace(update, bound=lookahead, items=(*self._past, *update.items))
        try:
            result = self._search(update)
        except DisturbedError as disturbance:
            if disturbance.kept:
                self._before, self._taken, self._past = before, update, ()
            raise
        self._before, self._taken, self._past = before, update, ()
        return result

    def _search(self, update: StreamUpdate) -> SolveResult:
        while True:
            with suppress(NotReadyError):  # the search's time has not begun
                return self._search_once(update)

    def _search_once(self, update: StreamUpdate) -> SolveResult:
        look, halt = self._watch(), None

        def stopped() -> bool:
            """Tell whether the search is to end; the first reason is kept."""
            nonlocal halt
            halt = halt or look()
            return halt is not None

        try:
            result = self._solver.update(update, stopped)
        except DroppedError:
            self.ended_by = halt.why if halt else ""
            if halt and halt.disturbed:
                raise DisturbedError(halt.why, kept=False) from None
            raise
        interrupted = result.outcome is SolveOutcome.INTERRUPTED
        self.ended_by = halt.why if halt and interrupted else ""
        if halt and halt.disturbed and interrupted:
            raise DisturbedError(halt.why, kept=True)
        return result
