"""The reactive solver: a reactive logic program that takes stream updates and answers each.

Behaves as oClingo did (2012), observed on the real program, without its failures: an update is taken or refused as a whole, and
no text from outside can end it.
"""

import time
from dataclasses import dataclass, field
from enum import Enum
from typing import Callable, Dict, FrozenSet, Iterable, List, Optional, Tuple

import clingo

from rosoclingo.oclingo.closing import closing_facts
from rosoclingo.oclingo.engine import Engine
from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program import ReactiveProgram
from rosoclingo.oclingo.progression import Statement, StreamUpdate
from rosoclingo.oclingo.state import StreamState
from rosoclingo.oclingo.transaction import Setting, Transaction

Answer = FrozenSet[clingo.Symbol]


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
        horizon: N, the last grounded step.
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

    Not thread-safe, but for :meth:`interrupt`. Time is that of the ``stopped`` callable: it is asked every few hundredths of a
    second of wall time while clingo searches, and before each step is grounded.
    """

    def __init__(self, program: ReactiveProgram, models: int = 1, horizon_limit: Optional[int] = None) -> None:
        """Make a solver that computes ``models`` answers an update (0: all) and grounds no step beyond ``horizon_limit``."""
        self.program = program
        self.models = models
        self._setting = Setting(program, horizon_limit, program.dependencies.copy())
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

    def solve(self, stopped: Optional[Callable[[], bool]] = None) -> SolveResult:
        """Search without an update (before the first one: at horizon 1)."""
        return self._run(None, stopped)

    def update(self, update: StreamUpdate, stopped: Optional[Callable[[], bool]] = None) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError where the update as a whole can't be taken; the state is then as it was before. An interrupted search
        leaves the update in force.
        """
        return self._run(update, stopped)

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle``: no answer will hold an ``_action_lib(A,P,cycle)`` that is not in ``executed``.

        Takes effect with the next search; raises SolverError where the state can't take it.
        """
        self._add_quietly(closing_facts(cycle, executed))

    def _add_quietly(self, statements: List[Statement]) -> None:
        state = self._state.copy()
        transaction = Transaction(self._setting, state, self._engine)
        self._guarded(transaction, lambda: transaction.add_permanent(statements))

    def _run(self, update: Optional[StreamUpdate], stopped: Optional[Callable[[], bool]]) -> SolveResult:
        self._stop = False
        transaction = Transaction(self._setting, self._state.copy(), self._engine)

        def halt() -> bool:
            return self._stop or (stopped is not None and stopped())

        return self._guarded(transaction, lambda: self._search(transaction, update, halt))

    def _guarded(self, transaction: Transaction, action: Callable[[], "SolveResult"]) -> "SolveResult":
        """Do ``action``; keep the transaction's state, or on failure the old one with a fresh grounding."""
        engine, self._engine = self._engine, None
        try:
            result = action()
        except RuntimeError as error:
            raise SolverError(transaction.explain(error)) from None
        except SolverError:
            self._engine = engine if not transaction.touched else None
            raise
        self._state, self._engine = transaction.state, transaction.engine
        return result

    def _search(self, transaction: Transaction, update: Optional[StreamUpdate], halt: Callable[[], bool]) -> SolveResult:
        start = time.perf_counter()
        satisfiable: Optional[bool] = None
        solving = 0.0
        answers: Tuple[Answer, ...] = ()
        permanent = False
        if transaction.begin(update, halt):
            while not halt():
                engine = transaction.ready()
                before = time.perf_counter()
                satisfiable, answers = engine.search(self.models, halt)
                solving += time.perf_counter() - before
                permanent = satisfiable is False and engine.conflicting
                if satisfiable is not False or permanent or not transaction.may_grow():
                    break
                satisfiable = None
                transaction.grow()
        outcome = SolveOutcome.INTERRUPTED
        if satisfiable is not None:
            outcome = SolveOutcome.SATISFIABLE if satisfiable else SolveOutcome.UNSATISFIABLE
        spent = {"solve": solving, "ground": time.perf_counter() - start - solving}
        state = transaction.state
        warnings = tuple(transaction.warnings)
        return SolveResult(outcome, answers, state.horizon, state.step, warnings, permanent, spent)
