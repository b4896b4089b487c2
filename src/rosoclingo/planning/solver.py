"""A solver of plans: takes stream updates, answers each, and keeps no state but the history and caches of it."""

import time
from dataclasses import replace
from typing import Callable, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.update_reader import Reader, is_predictable
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult
from rosoclingo.oclingo.solving.stream_solver import check_horizon_limit
from rosoclingo.planning.asking import Asking
from rosoclingo.planning.compaction import LEAST_STEPS, compacted, end_of_past
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import AcceptedUpdate, AdoptedPlan, History, Plan
from rosoclingo.planning.idling import may_idle
from rosoclingo.planning.prediction import log_after
from rosoclingo.planning.question import UNKNOWN, Question, Reply, Stop, StoppedError
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.strategies.improve import Improvement
from rosoclingo.planning.strategies.probe import Verdict, probe
from rosoclingo.planning.strategies.shortest import SearchResult, shortest
from rosoclingo.planning.strategies.soon import CLOCK, Clock, Soon, TimeLimit

BLOCK = 8
"""Steps to grow by at once if the program allows it."""

LONG = 10
"""Entries of the history after which there is a checkpoint."""

LONG_PREDICTED = 20
"""Entries after which there is one though none of them took a search: who reads them has to take each."""


class PredictingSolver:
    """What a solver knows of its history alone, wherever it works, and when its last answer is that of the next update.

    Attributes:
        log: all that was taken, from which all else follows.

    """

    def __init__(self) -> None:
        self.log = History()
        self._answer: Optional[Tuple[History, SolveResult]] = None  # the last one, and the history that it answers
        self._under_way: Callable[[], int] = lambda: 0  # what a search has ground up to now

    @property
    def horizon(self) -> int:
        """N, the last step that was searched."""
        return self.log.horizon

    @property
    def reached(self) -> int:
        """The last step that is ground in the midst of a search; the horizon between two of them."""
        return max(self.horizon, self._under_way())

    @property
    def step(self) -> int:
        """k, the step of the last update."""
        return self.log.step

    def restore(self, log: History) -> None:
        """Go on from a history, an earlier one of this solver or any other."""
        self.log = log

    def prepare(self, update: StreamUpdate, before: Sequence[StreamUpdate] = ()) -> bool:
        """Have the answer to ``update`` prepared, should it come after those ``before``; tell whether that is done.

        It is not if nothing can do so beside.
        """
        return False

    def has_prepared(self, update: StreamUpdate) -> bool:
        """Whether the answer to ``update`` is there, should it come next."""
        return False

    def _adopt(self, result: SolveResult) -> None:
        """Adopt the plan in ``result``, the answer to the whole history."""
        self.log = self.log.adopt(Plan.in_result(result))
        self._answer = self.log, result

    @property
    def _known_answer(self) -> Optional[SolveResult]:
        """The answer to the whole history, None if it is not known."""
        return self._answer[1] if self._answer is not None and self._answer[0] is self.log else None

    def _replace_log(self, log: History) -> None:
        """Continue with an equivalent history: its answer is known as before."""
        answer, self.log = self._known_answer, log
        self._answer = None if answer is None else (log, answer)

    def _log_after(self, updates: Sequence[StreamUpdate]) -> Optional[History]:
        """Return the history after ``updates`` that are all predicted; None if one takes a search."""
        answer, plan = self._known_answer, self.log.plan
        if answer is None or plan is None or not answer.predicted:
            return None
        return log_after(self.log, plan, answer.predicted, updates)

    def _go_on(self, update: Optional[StreamUpdate]) -> Optional[SolveResult]:
        """Take ``update`` if it is predicted, and return the answer; None if it takes a search."""
        log, result = None if update is None else self._log_after([update]), self._known_answer
        if log is None or result is None:
            return None
        self.log = log
        result = replace(result, step=self.step, warnings=(), statistics=dict.fromkeys(result.statistics, 0.0))
        self._answer = log, result
        return result


class _Searched(NamedTuple):
    """A history that was searched, and its grounding."""

    log: History
    asking: Asking


class _Inquiry(NamedTuple):
    """A question what would be: the update that is not taken, the assumable facts, and their grounding."""

    log: History
    update: StreamUpdate
    assumable: FrozenSet[clingo.Symbol]
    asking: Asking
    least: int


class PlanSolver(PredictingSolver):
    """Solves a reactive logic program under a stream of updates; answers are plans, with no action beyond the horizon.

    Not thread-safe, except for :meth:`interrupt`. Time is that of the ``stopped`` callable: it is asked every few
    milliseconds of wall time while clingo searches, and before each piece of steps is ground.
    """

    def __init__(
        self,
        program: ReactiveProgram,
        models: int = 1,
        horizon_limit: Optional[int] = None,
        oclingo_strings: bool = False,
        log_limit: int = LONG,
        plan_time: Optional[float] = None,
        clock: Clock = CLOCK,
        idles: Optional[bool] = None,
    ) -> None:
        """Make a solver.

        Args:
            program: the reactive logic program.
            models: how many answers to compute for an update, 0 for all.
            horizon_limit: no step beyond it is ground.
            oclingo_strings: take strings in updates as oClingo did, see :mod:`~rosoclingo.oclingo.progression.strings`.
            log_limit: after so many entries of the history, or more if there is much in force, there is a checkpoint.
            plan_time: if the shortest plan is not found in so many seconds of processor time, the best that is known
                is the answer, and if none is known the search goes on until one is; None for no such limit.
            clock: tells the processor time.
            idles: whether answers outlive further steps; None to find it out.

        """
        super().__init__()
        self.program = program
        self.models = models
        self._horizon_limit, self._log_limit = horizon_limit, log_limit
        self._plan_time, self._clock = plan_time, clock
        self._reader = Reader(program, oclingo_strings)
        self._predicts = models == 1 and program.tells_plainly and not oclingo_strings
        self._hint, self._idles = 0, idles
        self._searched: Optional[_Searched] = None
        self._improvement: Optional[Improvement] = None
        self._inquiry: Optional[_Inquiry] = None
        self._tried = 0  # before which step it was tried last to retire steps
        self.remarks = set(program.warnings)  # of clingo, each of which is reported once
        self._stop = False

    @property
    def snapshot(self) -> Snapshot:
        """What is in force after the whole history."""
        return self.log.snapshot(self._reader)

    def interrupt(self) -> None:
        """End the running search, if there is one, with outcome INTERRUPTED; may be called from any thread."""
        self._stop = True

    def solve(self, stopped: Optional[Stop] = None, dropped: Optional[Stop] = None) -> SolveResult:
        """Search without an update (before the first one: at horizon 1)."""
        return self._run(None, stopped, dropped)

    def update(
        self, update: StreamUpdate, stopped: Optional[Stop] = None, dropped: Optional[Stop] = None
    ) -> SolveResult:
        """Take ``update`` and search for answers, growing the horizon until there is one or the bound is reached.

        Raises SolverError if the update as a whole can't be taken; the history is then as it was before. An
        interrupted search leaves the update in force. ``dropped`` is asked between the pieces in which the program is
        ground, which ``stopped`` does not end: if it says so, DroppedError is raised.

        What was predicted is answered at once.
        """
        result = self._go_on(update) or self._run(update, stopped, dropped)
        return replace(result, warnings=update.warnings + result.warnings)

    # ---- Searching ---------------------------------------------------------------------------------------------------

    def _run(self, update: Optional[StreamUpdate], stopped: Optional[Stop], dropped: Optional[Stop]) -> SolveResult:
        self._stop = False
        halt = self._halting(stopped)
        before = self.snapshot
        check_horizon_limit(update, self.horizon, self._horizon_limit)
        snapshot = before.after(update, self._reader)
        asking = self._asking(snapshot, halt, dropped)
        self._searched, self._under_way = None, lambda: asking.horizon
        result, self.log = self._search(asking, before, update, halt)
        self._searched = _Searched(self.log, asking)
        self._adopt(result)
        self._retire(self._log_limit)
        return result

    def _search(
        self, asking: Asking, before: Snapshot, update: Optional[StreamUpdate], halt: Stop
    ) -> Tuple[SolveResult, History]:
        start, began = time.perf_counter(), time.process_time()
        outcome, found = SolveOutcome.INTERRUPTED, SearchResult(UNKNOWN)
        try:
            if self._plan_time is None:
                found = asking.run(shortest(asking, self.models, self._hint), halt)
            else:
                limit = TimeLimit(
                    self._plan_time, update is not None and is_predictable(update, before.permanent), self._clock
                )
                found = asking.run(Soon(asking, self.models, self.log.plan, limit).run(), halt)
        except StoppedError:
            pass
        reply, horizon = found.reply, asking.horizon
        if reply.satisfiable is not None:
            outcome = SolveOutcome.SATISFIABLE if reply.satisfiable else SolveOutcome.UNSATISFIABLE
        if reply.satisfiable:
            self._hint = horizon = reply.horizon
        elif reply.hopeless:
            horizon = max(horizon, asking.last())
        spent = {"solve": asking.seconds, "ground": time.perf_counter() - start - asking.seconds}
        spent["needed"] = (found.answered or time.process_time()) - began
        result = SolveResult(
            outcome,
            reply.answers,
            horizon,
            asking.step,
            tuple(self._warnings(asking)),
            reply.permanent,
            spent,
            found.proven,
            self._predicted(asking, reply, found.proven),
        )
        return result, self.log.then(AcceptedUpdate(update, asking.horizon))

    def _asking(
        self,
        snapshot: Snapshot,
        halt: Stop,
        dropped: Optional[Stop],
        assumable: FrozenSet[clingo.Symbol] = frozenset(),
    ) -> Asking:
        """Return a snapshot that can be asked about."""

        def build(snapshot: Snapshot, horizon: int) -> Grounding:
            """Ground the program, as a whole if clingo does not take it in pieces."""
            told = self.program, snapshot, horizon, assumable, dropped or (lambda: False)
            predicts = self._predicts and not assumable
            try:
                return Grounding(*told, predicts)
            except DroppedError:
                raise
            except SolverError:
                if self.program.heads_apart:
                    raise
            return Grounding(*told, predicts, whole=True)

        block = BLOCK if (may_idle(self.program, halt) if self._idles is None else self._idles) else 1
        return Asking(self.program, snapshot, build, block, self._horizon_limit)

    def _halting(self, stopped: Optional[Stop]) -> Stop:
        """Return what a search asks: whether it was interrupted, or is ``stopped``."""
        return lambda: self._stop or (stopped is not None and stopped())

    def _warnings(self, asking: Asking) -> Iterator[str]:
        """Yield what was ignored of the update, and what clingo has found odd, each of which is told once."""
        grounding = asking.grounding
        if grounding is None:
            yield from asking.snapshot.odd
            return
        yield from grounding.warnings
        for one in grounding.messages.new_remarks(self.program.parameter_at) if grounding.messages.said else ():
            if str(one) not in self.remarks:
                self.remarks.add(str(one))
                yield str(one)

    def _predicted(self, asking: Asking, reply: Reply, proven: bool) -> FrozenSet[clingo.Symbol]:
        """Return which returns are predicted with a reply; no shorter answer may come in with them."""
        if not asking.snapshot.is_steady or asking.grounding is None or asking.grounding.is_cyclic:
            return frozenset()
        return reply.predicted.certain if proven else reply.predicted.returns

    # ---- Shorter plans -----------------------------------------------------------------------------------------------

    def improve(self, stopped: Optional[Stop] = None) -> Optional[SolveResult]:
        """Look for a shorter plan than the last one, with what is done up to the present step left as it is.

        It is an answer of the last update, which the next update begins with. Returns it as soon as it is found: there
        may be a still shorter one. Returns None if ``stopped`` says so, or nothing is left to try: that is so until
        there is another update. Only for solvers of one answer, and programs that do not optimize.
        """
        self._stop = False
        plan = self.log.plan
        if plan is None or plan.shortest or self.models != 1 or self.program.optimizes:
            return None
        halt = self._halting(stopped)
        start, (asking, told) = time.perf_counter(), self._latest(halt)
        if asking.grounding is not None and asking.grounding.is_cyclic:
            return None
        place = self.step, self.snapshot.settled
        if self._improvement is None or not self._improvement.moves_to(plan, *place):
            self._improvement = Improvement(plan, *place)
        try:
            reply = asking.run(self._improvement.run(asking), halt)
        except DroppedError:  # stopped while the program was ground
            self._searched = None
            return None
        if reply is None:
            return None
        if not told <= reply.predicted.returns:  # it is no answer with what was told since the program was ground
            self._searched = None
            return self.improve(stopped)
        spent = {"solve": time.perf_counter() - start, "ground": 0.0, "needed": 0.0}
        returns = self._predicted(asking, reply, proven=False) - told
        answers, step = reply.answers, self.step
        result = SolveResult(SolveOutcome.SATISFIABLE, answers, reply.horizon, step, (), False, spent, False, returns)
        self._adopt(result)
        return result

    def _latest(self, halt: Stop) -> Tuple[Asking, FrozenSet[clingo.Symbol]]:
        """Return what was searched last, and the returns that were told since, all of them predicted.

        If anything else was told the program is ground anew.
        """
        told = self._told_since_search()
        if self._searched is None or told is None:
            told = frozenset()
            self._searched = _Searched(self.log.without_plan, self._asking(self.snapshot, halt, halt))
        return self._searched.asking, told

    def _told_since_search(self) -> Optional[FrozenSet[clingo.Symbol]]:
        """Return the returns that were told since the last search, None if anything else was or there was none."""
        told, log = set(), self.log
        while self._searched is not None and log is not self._searched.log:
            entry = log.entry
            if isinstance(entry, AcceptedUpdate) and entry.predicted and entry.update is not None:
                told |= {head for head in entry.update.heads if head is not None}
            elif not isinstance(entry, AdoptedPlan):
                return None
            if log.before is None:
                return None
            log = log.before
        return None if self._searched is None else frozenset(told)

    # ---- What would be -----------------------------------------------------------------------------------------------

    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Stop] = None,
        dropped: Optional[Stop] = None,
    ) -> Verdict:
        """Return whether there would be an answer after ``update`` without the facts ``disabled``.

        The history stays as it is. The ``disabled`` are some of the ``assumable``: facts of the stream or the update,
        and actions, which then were not executed. The program is ground once for a history, an update and assumable
        facts. Raises SolverError as :meth:`update` does.
        """
        self._stop = False
        check_horizon_limit(update, self.horizon, self._horizon_limit)
        found = self.probe(update, assumable, disabled, self._halting(stopped), dropped)
        return Verdict(found.satisfiable, found.core)

    def probe(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        halt: Stop,
        dropped: Optional[Stop] = None,
        kept: Sequence[clingo.Symbol] = (),
        believes: bool = True,
    ) -> Reply:
        """Return the reply to :meth:`inquire`, for answers in which the atoms ``kept`` are true."""
        unbounded = replace(update, bound=None)
        inquiry, self._inquiry = self._inquiry, None  # what a failure leaves of it is dropped
        same = inquiry is not None and inquiry[:3] == (self.log, unbounded, assumable)
        if inquiry is None or not same or inquiry.asking.block == 1:
            before = self.snapshot
            snapshot = before.shortened().after(unbounded, self._reader)
            asking = self._asking(snapshot, halt, dropped, assumable)
            inquiry = _Inquiry(self.log, unbounded, assumable, asking, max(before.horizon, snapshot.horizon))
        asking = inquiry.asking
        bound = None if update.bound is None else asking.step + update.bound
        asking.snapshot = replace(asking.snapshot, bound=bound)
        try:
            reply = asking.run(probe(asking, inquiry.least, disabled, kept, believes), halt)
        except StoppedError:
            reply = UNKNOWN
        self._inquiry = inquiry
        return reply

    def probed_atoms(self) -> List[clingo.Symbol]:
        """Return all atoms that may be true at the steps that were ground for the last question what would be."""
        grounding = None if self._inquiry is None else self._inquiry.asking.grounding
        return [] if grounding is None else grounding.possible_atoms

    # ---- The history -------------------------------------------------------------------------------------------------

    def shorten_log(self, stopped: Optional[Stop] = None) -> None:
        """Put a checkpoint at the end of the history if many predicted updates have followed the last one."""
        if self.log.length > LONG_PREDICTED and not (stopped is not None and stopped()):
            self.checkpoint()

    def checkpoint(self) -> None:
        """Put a checkpoint at the end of the history, and compact it if enough steps are over."""
        plan = self.log.plan
        if self._steps_over >= LEAST_STEPS and self.log.predicted and plan is not None:
            self._answer_again(plan)
        self._retire(-1)

    def _answer_again(self, plan: Plan) -> None:
        """Ground the program with the whole history, and find the predicted answer there: all its actions are given."""
        asking = self._asking(self.snapshot, lambda: False, None)
        grounding, horizon = asking.ground(), max(plan.horizon, self.snapshot.settled)
        actions = grounding.actions(self.program.first_step, grounding.horizon)
        given = [(action, action in plan.actions) for action in actions]
        grounding.ask(Question(horizon, horizon, given), lambda: False)
        self._searched = _Searched(self.log.without_plan, asking)

    @property
    def _steps_over(self) -> int:
        """The number of ground steps that are over, and were not when it was tried last to retire some."""
        snapshot = self.snapshot
        return end_of_past(self.program, snapshot) - max(snapshot.first_ground(self.program), self._tried)

    def _retire(self, limit: int) -> None:
        """Put a checkpoint at the end of the history: if steps can be retired, or it is longer than ``limit``.

        That is always so for a limit below 0.
        """
        snapshot, searched, short = self.snapshot, self._searched, None
        fits = searched is not None and searched.log is self.log.without_plan
        if searched is not None and fits and self._steps_over >= LEAST_STEPS:
            self._tried = end_of_past(self.program, snapshot)
            grounding = searched.asking.grounding
            short = None if grounding is None else compacted(grounding, snapshot)
        if short is None and limit >= 0 and not self.log.is_longer(limit, snapshot):
            return
        self._replace_log(self.log.checkpoint(short or snapshot))
        if searched is not None and fits:
            self._searched = searched._replace(log=self.log.without_plan)
