"""The reactive solver: a reactive logic program that takes stream updates and answers each.

Behaves as oClingo did (2012), observed on the real program, without its failures: an update is taken or refused as a
whole, and no text from outside can end it.
"""

import time
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Callable, Dict, FrozenSet, Iterator, List, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.errors import SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.assumptions import Search
from rosoclingo.oclingo.solving.compaction import checkpoint
from rosoclingo.oclingo.solving.foresight import log_after
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.horizon_search import HorizonSearch, first_horizon, may_idle
from rosoclingo.oclingo.solving.improvement import Improvement
from rosoclingo.oclingo.solving.inquiry import Inquiry, Verdict
from rosoclingo.oclingo.solving.plan_search import CLOCK, Clock, PlanSearch, TimeLimit
from rosoclingo.oclingo.solving.stream_log import LoggedSolver, Plan, StreamLog, Taken
from rosoclingo.oclingo.solving.stream_state import Setting, StreamState, is_foreseen
from rosoclingo.oclingo.solving.transaction import Transaction, explain

BLOCK = 8
"""Steps to grow by at once where the program allows it."""

LOG_LIMIT = 10
"""Entries of the log after which there is a checkpoint."""

FORESEEN_LOG = 20
"""Entries after which there is one though none of them took a search: who reads them has to take each."""

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
        shortest: True where it is proven that no answer has a lesser horizon.
        foreseen: returns of success with which the answer stays what it is: an update that tells nothing else than them
            and what was done is answered without a search.
        statistics: seconds of wall time spent in ``ground`` and ``solve``; and seconds of processor time that were
            ``needed`` for an answer, less what went on improving it.

    """

    outcome: SolveOutcome
    answers: Tuple[Answer, ...]
    horizon: int
    step: int
    warnings: Tuple[str, ...] = ()
    permanent: bool = False
    statistics: Dict[str, float] = field(default_factory=dict, compare=False)
    shortest: bool = False
    foreseen: FrozenSet[clingo.Symbol] = frozenset()

    @property
    def plan(self) -> Optional[Plan]:
        """The plan in the last answer, None where there is no answer."""
        return Plan.of(self.answers[-1], self.horizon, self.shortest) if self.answers else None


class ForeseeingSolver(LoggedSolver):
    """A solver that knows, wherever it works, when its last answer is that of the next update."""

    def __init__(self) -> None:
        super().__init__()
        self._answer: Optional[Tuple[StreamLog, SolveResult]] = None  # the last one, and the log up to it

    def _has_answered(self, result: SolveResult) -> None:
        """Note the answer to all that the log holds."""
        self._answer = (self._log, result)

    @property
    def _known_answer(self) -> Optional[SolveResult]:
        """The answer to all that the log holds, None where it is not known."""
        return self._answer[1] if self._answer is not None and self._answer[0] is self._log else None

    def _replace_log(self, log: StreamLog) -> None:
        """Go on with a ``log`` that is worth the same: its answer is known as before."""
        answer, self._log = self._known_answer, log
        if answer is not None:
            self._has_answered(answer)

    def _log_after(self, updates: Sequence[StreamUpdate]) -> Optional[StreamLog]:
        """Return the log after ``updates`` that are all foreseen; None where one takes a search."""
        answer = self._known_answer
        return log_after(self._log, answer.foreseen, updates) if answer is not None and answer.foreseen else None

    def _go_on(self, update: Optional[StreamUpdate]) -> Optional[SolveResult]:
        """Take ``update`` where it is foreseen, and return the answer; None where it takes a search."""
        log, result = None if update is None else self._log_after([update]), self._known_answer
        if log is None or result is None:
            return None
        self._log = log
        result = replace(result, step=self.step, warnings=(), statistics=dict.fromkeys(result.statistics, 0.0))
        self._has_answered(result)
        return result


class ReactiveSolver(ForeseeingSolver):
    """Solves a reactive logic program under a stream of updates.

    Not thread-safe, but for :meth:`interrupt`. Time is that of the ``stopped`` callable: it is asked every few
    milliseconds of wall time while clingo searches, and before each step is grounded.
    """

    def __init__(
        self,
        program: ReactiveProgram,
        models: int = 1,
        horizon_limit: Optional[int] = None,
        shortest: bool = False,
        oclingo_strings: bool = True,
        log_limit: int = LOG_LIMIT,
        plan_time: Optional[float] = None,
        clock: Clock = CLOCK,
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
            log_limit: after so many entries of the log, or more where the state is large, there is a checkpoint.
            plan_time: for ``shortest`` solvers: where the shortest plan is not found in so many seconds of processor
                time, the best that is known is the answer, and where none is known the search goes on until one is;
                None for no such limit.
            clock: tells the processor time.

        """
        if plan_time is not None and not shortest:
            raise ValueError("plan_time needs shortest")
        super().__init__()
        self.program = program
        self.models = models
        self.shortest = shortest
        self._log_limit = log_limit
        self._plan_time, self._clock = plan_time, clock
        self._hint = 0
        foresees = plan_time is not None and models == 1 and program.tells_plainly and not oclingo_strings
        self._setting = Setting(program, horizon_limit, shortest, oclingo_strings, foresees)
        self._read = self._log
        self._grounding: Optional[Grounding] = None  # fits the state after what was read of the log
        self._improvement: Optional[Improvement] = None
        self._inquiry: Optional[Inquiry] = None
        self._stop = False
        if not shortest:
            program.prepare_steps()

    @property
    def state(self) -> StreamState:
        """The state after the whole log, not to be changed."""
        self.read()
        assert self._log.state is not None
        return self._log.state

    def interrupt(self) -> None:
        """End the running search, if there is one, with outcome INTERRUPTED; may be called from any thread."""
        self._stop = True

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

        What was foreseen is answered at once, and read when there is need.
        """
        return self._go_on(update) or self._run(update, stopped, dropped)

    def improve(self, stopped: Optional[Stopped] = None, retires: bool = True) -> Optional[SolveResult]:
        """Look for a shorter plan than the last one, with what is done up to the present step left as it is.

        It is an answer of the last update, which the next update begins with. Returns it as soon as it is found: there
        may be a still shorter one. Returns None where ``stopped`` says so, or nothing is left to try: that is so until
        there is another update. Only for ``shortest`` solvers of one answer, and programs that do not optimize. Where
        it ``retires``, steps that are over are retired before, which does not heed ``stopped``.
        """
        self._stop = False
        plan = self._log.plan
        if plan is None or plan.shortest or not self.shortest or self.models != 1 or self.program.optimizes:
            return None
        self.read()
        if self._grounding is None or self.state.cyclic:
            return None
        transaction = Transaction(self._setting, self.state.copy(), self._grounding)
        with self._taking(transaction):
            self._log = self._read = transaction.retire(self._log) if retires else self._log
            start, found = time.perf_counter(), self._shorten(plan, transaction, self._halting(stopped))
            spent = {"solve": time.perf_counter() - start, "ground": 0.0, "needed": 0.0}
        if found is None:
            return None
        outcome, returns = SolveOutcome.SATISFIABLE, self._foreseen(found, self.state, proven=False)
        result = SolveResult(outcome, found.answers, found.horizon, self.state.step, (), False, spent, False, returns)
        self._log.plan = result.plan
        self._has_answered(result)
        return result

    def shorten_log(self, stopped: Optional[Stopped] = None) -> None:
        """Put a checkpoint at the end of the log, where it has grown long by what was foreseen."""
        if self._log.length > FORESEEN_LOG and not (stopped is not None and stopped()):
            self.begin_log_anew()

    def _shorten(self, plan: Plan, transaction: Transaction, halt: Callable[[], bool]) -> Optional[Search]:
        """Go on with what is tried to shorten ``plan``."""
        place = transaction.state.step, first_horizon(transaction)
        if self._improvement is None or not self._improvement.goes_on(plan, *place):
            self._improvement = Improvement(plan, *place)
        return self._improvement.run(transaction.ready(), halt)

    def inquire(
        self,
        update: StreamUpdate,
        doubted: FrozenSet[clingo.Symbol],
        untold: FrozenSet[clingo.Symbol],
        stopped: Optional[Stopped] = None,
        dropped: Optional[Stopped] = None,
    ) -> Verdict:
        """Tell whether there would be an answer after ``update``, had the facts ``untold`` never been told.

        Nothing is taken. The ``untold`` are among those ``doubted``: facts of the stream or of the update, and actions,
        which were not executed then. As long as the log, the update and the facts in doubt are the same, the program is
        ground once, whatever is untold. For ``shortest`` solvers. Raises SolverError as :meth:`update` does.
        """
        self._stop = False
        self.read()
        self._setting.check(update, self.horizon)
        halt = self._halting(stopped)
        inquiry, self._inquiry = self._inquiry, None  # what a failure leaves of it is let go
        if inquiry is None or not inquiry.is_about(self.state, update, doubted):
            idles = may_idle(self.program, halt)
            inquiry = Inquiry(self._setting, self.state, replace(update, bound=None), doubted, idles)
        try:
            verdict = inquiry.ask(untold, update.bound, halt, dropped)
        except RuntimeError as error:
            raise SolverError(explain(error, None, self.program)) from None
        self._inquiry = inquiry
        return verdict

    def _halting(self, stopped: Optional[Stopped]) -> Callable[[], bool]:
        """Return what a search asks: whether it was interrupted, or is ``stopped``."""
        return lambda: self._stop or (stopped is not None and stopped())

    def read(self, coming: Optional[StreamUpdate] = None) -> None:
        """Read what is new in the log, without a search; raises SolverError where the program can't be ground.

        Where the program is ground anew for that, it is with a view to the update that is ``coming``.
        """
        unread: List[StreamLog] = []
        known = self._log
        while known.state is None and known.before is not None:
            unread.append(known)
            known = known.before
        state = known.state = known.state or self._setting.fresh_state()
        if known is not self._read:
            self._grounding, self._read = None, known
        updates = [log.entry.update for log in unread if isinstance(log.entry, Taken)]
        heads = [head for one in (*updates, coming) for head in self._setting.open_heads(one)] if unread else ()
        for log in reversed(unread):
            transaction = Transaction(self._setting, state.copy(), self._grounding, coming=heads)
            grounding = self._grounding if log.foreseen else None
            satisfied = grounding is not None and grounding.satisfied
            with self._taking(transaction):
                transaction.take_again(log.entry)
            if satisfied and grounding is self._grounding is not None:
                self._grounding.satisfied = True
            state = log.state = transaction.state
            self._read = log

    @contextmanager
    def _taking(self, transaction: Transaction) -> Iterator[None]:
        """Keep the transaction's grounding; what a failure leaves of it fits no state, and is let go."""
        self._grounding, self._under_way = None, lambda: transaction.state.horizon
        try:
            yield
        except RuntimeError as error:
            raise SolverError(explain(error, transaction.grounding, self.program)) from None
        self._grounding = transaction.grounding

    def _run(
        self, update: Optional[StreamUpdate], stopped: Optional[Stopped], dropped: Optional[Stopped]
    ) -> SolveResult:
        self._stop = False
        self.read(update)
        self._setting.check(update, self.horizon)
        transaction = Transaction(self._setting, self.state.copy(), self._grounding, dropped)
        with self._taking(transaction):
            self._log = self._read = transaction.retire(self._log, update)
            result = self._search(transaction, update, self._halting(stopped))
        log = self._log.then(Taken(update, transaction.state.horizon))
        log.state = transaction.state
        log.plan = (result.plan if self.shortest else None) or log.plan
        self._log = self._read = log
        if log.is_longer(self._log_limit):
            self.begin_log_anew(idle=False)
        self._has_answered(result)
        return result

    def begin_log_anew(self, idle: bool = True) -> None:
        """Put a checkpoint at the end of the log, in which steps that are over are retired, while ``idle`` sooner."""
        self.read()
        self._replace_log(checkpoint(self._setting, self._log, self._grounding, idle))
        self._read = self._log

    def _search(
        self, transaction: Transaction, update: Optional[StreamUpdate], halt: Callable[[], bool]
    ) -> SolveResult:
        start, began = time.perf_counter(), time.process_time()
        search = self._make_search(update, halt)
        found = Search(None)
        if transaction.begin(update, halt):
            found = search.run(transaction)
        if found.satisfiable:
            self._hint = found.horizon
        outcome = SolveOutcome.INTERRUPTED
        if found.satisfiable is not None:
            outcome = SolveOutcome.SATISFIABLE if found.satisfiable else SolveOutcome.UNSATISFIABLE
        spent = {"solve": search.seconds, "ground": time.perf_counter() - start - search.seconds}
        spent["needed"] = (search.answered or time.process_time()) - began
        state, warnings = transaction.state, (*transaction.warnings, *transaction.remarks())
        horizon = found.horizon if found.satisfiable else state.horizon
        if search.hopeless:
            horizon = max(horizon, transaction.last_horizon())
        answers, proven, returns = found.answers, search.proven, self._foreseen(found, state, search.proven)
        return SolveResult(outcome, answers, horizon, state.step, warnings, search.permanent, spent, proven, returns)

    def _foreseen(self, found: Search, state: StreamState, proven: bool) -> FrozenSet[clingo.Symbol]:
        """Return which returns are foreseen with what was ``found``; no shorter answer may come in with them."""
        if not state.is_steady:
            return frozenset()
        return found.foreseen.certain if proven else found.foreseen.returns

    def _make_search(self, update: Optional[StreamUpdate], halt: Callable[[], bool]) -> HorizonSearch:
        block = BLOCK if self.shortest and may_idle(self.program, halt) else 1
        if self._plan_time is None:
            return HorizonSearch(self.models, self.shortest, self._hint, block, halt)
        foreseen = update is not None and is_foreseen(update, self.state.permanent)
        limit = TimeLimit(self._plan_time, foreseen, self._clock)
        return PlanSearch(self.models, self._log.plan, block, halt, limit)
