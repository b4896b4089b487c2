"""The incremental solver: a reactive logic program that takes stream updates and answers each, as oClingo did.

Behaves as oClingo did (2012), observed on the real program, without its failures: an update is taken or refused as a
whole, and no text from outside can end it.
"""

import time
from contextlib import contextmanager
from dataclasses import replace
from typing import Callable, Iterator, Optional, Tuple

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.reactive_grounding import Answers, ReactiveGrounding
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult, refusal
from rosoclingo.oclingo.solving.stream_solver import check_horizon_limit
from rosoclingo.oclingo.solving.stream_state import StreamState
from rosoclingo.oclingo.solving.transaction import Transaction

Stopped = Callable[[], bool]


def _never() -> bool:
    """The stop of a search that is not stopped."""
    return False


class ReactiveSolver:
    """Solves a reactive logic program under a stream of updates, at the last step that is ground.

    Not thread-safe. Time is that of the ``stopped`` callable: it is asked every few
    milliseconds of wall time while clingo searches, and before each step is grounded.

    Attributes:
        state: what follows from the updates.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        models: int = 1,
        horizon_limit: Optional[int] = None,
    ) -> None:
        """Make a solver.

        Args:
            program: the reactive logic program.
            models: how many answers to compute for an update, 0 for all.
            horizon_limit: no step beyond it is grounded.

        """
        self.program = program
        self.models = models
        self._limit = horizon_limit
        self.state = StreamState(forgets_done=program.first_step - 1)
        self._grounding: Optional[ReactiveGrounding] = None  # fits the state
        self._under_way: Callable[[], int] = lambda: 0  # what a search has ground up to now

    @property
    def horizon(self) -> int:
        """N, the last grounded step."""
        return self.state.horizon

    @property
    def reached(self) -> int:
        """The last step that is ground in the midst of a search; the horizon between two of them."""
        return max(self.horizon, self._under_way())

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self.state.step

    def solve(self, stopped: Optional[Stopped] = None, dropped: Optional[Stopped] = None) -> SolveResult:
        """Search without an update (before the first one: at horizon 1)."""
        return self._run(None, stopped, dropped)

    def update(
        self, update: StreamUpdate, stopped: Optional[Stopped] = None, dropped: Optional[Stopped] = None
    ) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError where the update as a whole can't be taken; the state is then as it was before. An
        interrupted search leaves the update in force. ``stopped`` does not end regrounding; ``dropped`` does,
        which is called between its pieces and has DroppedError raised.
        """
        result = self._run(update, stopped, dropped)
        return replace(result, warnings=update.warnings + result.warnings)

    def take_again(self, update: Optional[StreamUpdate], horizon: int) -> None:
        """Take what was taken before and led to ``horizon``, without a search."""
        with self._transaction() as transaction:
            transaction.begin(update, lambda: transaction.state.horizon >= horizon)
            while transaction.state.horizon < horizon:
                transaction.grow()
            list(transaction.remarks())

    def _run(
        self, update: Optional[StreamUpdate], stopped: Optional[Stopped], dropped: Optional[Stopped]
    ) -> SolveResult:
        check_horizon_limit(update, self.horizon, self._limit)
        with self._transaction(dropped or _never) as transaction:
            return self._search(transaction, update, stopped or _never)

    @contextmanager
    def _transaction(self, dropped: Stopped = _never) -> Iterator[Transaction]:
        """A transaction that is committed unless the block fails: then the grounding fits no state and is dropped."""
        transaction = Transaction(self.program, self.state.copy(), self._grounding, self._limit, dropped)
        self._grounding, self._under_way = None, lambda: transaction.state.horizon
        try:
            yield transaction
        except RuntimeError as error:
            messages = None if transaction.grounding is None else transaction.grounding.messages
            raise SolverError(refusal(error, messages, self.program)) from None
        self.state, self._grounding = transaction.state, transaction.grounding

    def _search(self, transaction: Transaction, update: Optional[StreamUpdate], halt: Stopped) -> SolveResult:
        start, began, seconds = time.perf_counter(), time.process_time(), 0.0
        satisfiable: Optional[bool] = None
        answers: Answers = ()
        permanent = False
        going, last = transaction.begin(update, halt), transaction.last_horizon
        while going and not halt():
            grounding, asked = transaction.ready(), time.perf_counter()
            satisfiable, answers = grounding.search(self.models, halt)
            seconds += time.perf_counter() - asked
            permanent = satisfiable is False and grounding.conflicting
            going = satisfiable is False and not permanent and (last is None or transaction.state.horizon < last)
            if going:
                satisfiable = None  # not known until the next horizon is searched
                if not halt():
                    transaction.grow()
        outcome = SolveOutcome.INTERRUPTED
        if satisfiable is not None:
            outcome = SolveOutcome.SATISFIABLE if satisfiable else SolveOutcome.UNSATISFIABLE
        state = transaction.state
        horizon = max(state.horizon, last or state.horizon) if permanent else state.horizon
        spent = {"solve": seconds, "ground": time.perf_counter() - start - seconds}
        spent["needed"] = time.process_time() - began
        warnings: Tuple[str, ...] = (*transaction.warnings, *transaction.remarks())
        return SolveResult(outcome, answers, horizon, state.step, warnings, permanent, spent)
