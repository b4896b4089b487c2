"""The reactive solver: a reactive logic program that takes stream updates and answers each.

Behaves as oClingo did (2012), observed on the real program, without its failures: an update is taken or refused as a
whole, and no text from outside can end it.
"""

import time
from dataclasses import dataclass, field
from enum import Enum
from typing import Callable, Dict, FrozenSet, Iterable, Iterator, Optional, Tuple, TypeVar

import clingo

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.return_failures import FAILED, with_failures
from rosoclingo.oclingo.progression.strings import strings_apart
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.grounding import Engine, Search, explain
from rosoclingo.oclingo.solving.horizon_search import Query, may_idle
from rosoclingo.oclingo.solving.stream_state import StreamState
from rosoclingo.oclingo.solving.transaction import Setting, Transaction

BLOCK = 8
"""Steps to grow by at once where the program allows it."""

T = TypeVar("T")
Answer = FrozenSet[clingo.Symbol]
Stopped = Callable[[], bool]


class SolveOutcome(Enum):
    """How solving an update ended."""

    SATISFIABLE = "satisfiable"
    UNSATISFIABLE = "unsatisfiable"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True)
class SolveResult:
    """Outcome of an update.

    Attributes:
        outcome: satisfiable; unsatisfiable up to the bound or for good; or interrupted.
        answers: the shown atoms of each answer, in the order in which they were found.
        horizon: that of the answers, else the last one that was searched; where nothing can make the program
            satisfiable any more, the greatest one that was asked for, as though all up to it had been searched.
        step: k, the step of the update.
        warnings: what was ignored and why.
        permanent: True where no further step and no external can make the program satisfiable.
        statistics: seconds of wall time spent in ``ground`` and ``solve``.

    """

    outcome: SolveOutcome
    answers: Tuple[Answer, ...]
    horizon: int
    step: int
    warnings: Tuple[str, ...] = ()
    permanent: bool = False
    statistics: Dict[str, float] = field(default_factory=dict, compare=False)


class ReactiveSolver:
    """Solves a reactive logic program under a stream of updates.

    Not thread-safe, but for :meth:`interrupt`. Time is that of the ``stopped`` callable: it is asked every few
    hundredths of a second of wall time while clingo searches, and before each step is grounded.
    """

    def __init__(
        self,
        program: ReactiveProgram,
        models: int = 1,
        horizon_limit: Optional[int] = None,
        shortest: bool = False,
        oclingo_strings: bool = True,
    ) -> None:
        """Make a solver.

        Args:
            program: the reactive logic program.
            models: how many answers to compute for an update, 0 for all.
            horizon_limit: no step beyond it is grounded.
            shortest: search each update's answers from horizon k on, though more steps may be grounded, so that plans
                are shortest at any time; and let no answer hold an action of a cycle beyond its horizon. oClingo
                searched at the last grounded step only.
            oclingo_strings: take strings in updates as oClingo did, see :mod:`~rosoclingo.oclingo.progression.strings`.

        """
        self.program = program
        self.models = models
        self.shortest = shortest
        self._oclingo_strings = oclingo_strings
        self._hint = 0
        self._setting = Setting(program, horizon_limit, shortest)
        self._state = StreamState(step=1, horizon=1, forgets_done=program.first_step - 1)
        self._engine: Optional[Engine] = None
        self._stop = False

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""
        return self._state.horizon

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self._state.step

    def interrupt(self) -> None:
        """End the running search, if there is one, with outcome INTERRUPTED; may be called from any thread."""
        self._stop = True

    def snapshot(self) -> StreamState:
        """Return the present state, for :meth:`restore`."""
        return self._state.copy()

    def restore(self, state: StreamState) -> None:
        """Go back to a state that :meth:`snapshot` gave; the program is ground anew at the next search."""
        self._state = state.copy()
        self._engine = None

    def solve(self, stopped: Optional[Stopped] = None, dropped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update (before the first one: at horizon 1)."""
        return self._run(None, stopped, dropped)

    def update(
        self, update: StreamUpdate, stopped: Optional[Stopped] = None, dropped: Optional[Stopped] = None
    ) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError where the update as a whole can't be taken; the state is then as it was before. An
        interrupted search leaves the update in force. ``dropped`` is asked between the pieces in which the program is
        ground anew, which ``stopped`` does not end: where it says so, DroppedError is raised.
        """
        return self._run(self._read(update), stopped, dropped)

    def replay(self, update: Optional[StreamUpdate], horizon: int) -> None:
        """Take again what led to ``horizon`` when it was taken first, without a search.

        ``update`` is None for :meth:`solve`. Raises SolverError as :meth:`update` does.
        """
        transaction = Transaction(self._setting, self._state.copy(), self._engine)
        update = None if update is None else self._read(update)

        def take() -> None:
            """Go through the steps up to the horizon, as the search did."""
            transaction.begin(update, lambda: transaction.state.horizon >= horizon)
            while transaction.state.horizon < horizon and not transaction.hopeless:
                transaction.grow_to(min(transaction.state.horizon + (BLOCK if self.shortest else 1), horizon))

        self._guarded(transaction, take)

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle``: no answer will hold an ``_action_lib(A,P,cycle)`` that is not in ``executed``.

        Its returns may still come with the next update; those of the cycle closed before it are closed.
        """
        transaction = Transaction(self._setting, self._state.copy(), self._engine)
        self._guarded(transaction, lambda: transaction.close_cycle(cycle, frozenset(executed)))

    def forget_before(self, step: int) -> None:
        """Let the steps before ``step`` be over: no update will concern them any more.

        What is decided at them is kept as facts and no longer ground, which keeps a long stream as fast as a short one;
        their externals are closed, so that a fact for one of them is ignored with a warning. For ``shortest`` solvers
        alone.
        """
        if self.shortest:
            self._state.keep_from = max(self._state.keep_from, step)

    def _read(self, update: StreamUpdate) -> StreamUpdate:
        """Return the update as the program is to see it."""
        update = strings_apart(update) if self._oclingo_strings else update
        return with_failures(update, self._state.permanent) if FAILED in self.program.open_signatures else update

    def _run(
        self, update: Optional[StreamUpdate], stopped: Optional[Stopped], dropped: Optional[Stopped]
    ) -> SolveResult:
        self._stop = False
        transaction = Transaction(self._setting, self._state.copy(), self._engine, dropped)

        def halt() -> bool:
            return self._stop or (stopped is not None and stopped())

        return self._guarded(transaction, lambda: self._search(transaction, update, halt))

    def _guarded(self, transaction: Transaction, action: Callable[[], T]) -> T:
        """Do ``action``; keep the transaction's state, or on failure the old one with a fresh grounding."""
        engine, self._engine = self._engine, None
        try:
            result = action()
        except RuntimeError as error:
            raise SolverError(explain(error, transaction.engine, self.program)) from None
        except SolverError:
            self._engine = engine if not transaction.touched else None
            raise
        self._state, self._engine = transaction.state, transaction.engine
        return result

    def _remarks(self, engine: Optional[Engine]) -> Iterator[str]:
        """Yield what clingo has found odd while it ground, each of which is told once."""
        told = self.program.told
        for one in engine.messages.new_remarks(self.program.parameter_at) if engine is not None else ():
            if str(one) not in told and str(one) not in self.program.warnings:
                told.add(str(one))
                yield str(one)

    def _search(
        self, transaction: Transaction, update: Optional[StreamUpdate], halt: Callable[[], bool]
    ) -> SolveResult:
        start = time.perf_counter()
        block = BLOCK if self.shortest and may_idle(self.program, halt) else 1
        query = Query(self.models, self.shortest, self._hint, block, halt)
        search = Search(None)
        if transaction.begin(update, halt):
            search = query.run(transaction)
        if search.satisfiable:
            self._hint = search.horizon
        outcome = SolveOutcome.INTERRUPTED
        if search.satisfiable is not None:
            outcome = SolveOutcome.SATISFIABLE if search.satisfiable else SolveOutcome.UNSATISFIABLE
        spent = {"solve": query.seconds, "ground": time.perf_counter() - start - query.seconds}
        state, warnings = transaction.state, (*transaction.warnings, *self._remarks(transaction.engine))
        horizon = search.horizon if search.satisfiable else state.horizon
        if query.permanent:
            horizon = max(horizon, transaction.last_horizon())
        return SolveResult(outcome, search.answers, horizon, state.step, warnings, query.permanent, spent)
