"""The planner: a solver under a stream of updates whose answers are plans.

Its only state is the history; everything else is a cache.
"""

import time
from contextlib import suppress
from dataclasses import replace
from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.oclingo.program.action_rules import RUNNING
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.update_reader import reports_only_success
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import Answer, SolveOutcome, SolveResult
from rosoclingo.oclingo.solving.stream_solver import check_horizon_limit
from rosoclingo.planning.compaction import compacted, end_of_past, first_open, recent_atoms
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import AcceptedUpdate, Plan
from rosoclingo.planning.idling import may_idle
from rosoclingo.planning.planning_solver import LONG, PlanningSolver
from rosoclingo.planning.question import UNKNOWN, Reply, Stop, never
from rosoclingo.planning.return_rules import is_predictable
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.strategies.improve import Improvement
from rosoclingo.planning.strategies.probe import probe
from rosoclingo.planning.strategies.shortest import all_answers, shortest
from rosoclingo.planning.strategies.soon import FirstPlan, FirstPlanSearch
from rosoclingo.planning.strategy_runner import StrategyRunner

BLOCK = 8
"""Number of steps to ground at once if further steps leave answers valid."""

LEAST_STEPS = 16
"""Least number of past steps to compact."""

MANY_STEPS = 64
"""Number of past steps that are compacted after a search; fewer are compacted while the robot acts."""

LOG_LIMIT = 2 * LONG
"""Number of updates after which a checkpoint follows a search; it comes earlier if the robot acts meanwhile."""

_OUTCOMES = {
    True: SolveOutcome.SATISFIABLE,
    False: SolveOutcome.UNSATISFIABLE,
    None: SolveOutcome.INTERRUPTED,
}


class _Probed(NamedTuple):
    """The grounding of the last hypothetical question; the key contains the values from which it was built."""

    key: object
    runner: StrategyRunner


class PlanSolver(PlanningSolver):
    """Solves a reactive logic program under a stream of updates; answers are plans, without actions after the horizon.

    Not thread-safe. The ``stopped`` functions are polled every few milliseconds of wall time while clingo searches, and
    between two pieces of steps while it grounds. A stopped search has the outcome INTERRUPTED. A stop while the program
    is grounded for an update discards the update and raises StoppedError.
    """

    def __init__(
        self,
        program: ReactiveProgram,
        models: int = 1,
        horizon_limit: Optional[int] = None,
        log_limit: int = LOG_LIMIT,
        plan_time: Optional[float] = None,
        idles: Optional[bool] = None,
    ) -> None:
        """Create a solver with an empty history.

        Args:
            program: the reactive logic program.
            models: the number of answers to compute for an update, 0 for all.
            horizon_limit: the last step to ground.
            log_limit: the number of updates after which a checkpoint follows a search; higher for large snapshots.
            plan_time: the time limit for shortest plans, in seconds of processor time. After it, the answer is the best
                plan so far, or else the first plan found. None for no limit.
            idles: whether answers stay valid when further steps are grounded; None to test it.

        """
        super().__init__()
        self.program = program
        self.models = models
        self._horizon_limit, self._log_limit = horizon_limit, log_limit
        self._plan_time = plan_time
        self._predicts = models == 1 and is_predictable(program)
        self._idles = idles
        self._searched: Optional[StrategyRunner] = None  # the runner of the last search or improvement
        self._probed: Optional[_Probed] = None  # the last hypothetical question, by history, update and assumable facts
        self._improvement: Optional[Improvement] = None
        self._checked_until = 0  # earlier steps cannot be compacted
        self._remarks = set(program.warnings)  # clingo's remarks, each of which is reported once

    @property
    def snapshot(self) -> Snapshot:
        """The snapshot of the history."""
        return self.log.snapshot(self.program)

    # ---- Searching ---------------------------------------------------------------------------------------------------

    def search(self, update: Optional[StreamUpdate], stopped: Stop) -> SolveResult:
        """Accept ``update``, if there is one, and search for answers; raises like :meth:`update`."""
        start, began = time.perf_counter(), time.process_time()
        check_horizon_limit(update, self.horizon, self._horizon_limit)
        if self._steps_to_check >= 4 * MANY_STEPS:  # otherwise, the search would ground all of them
            self.checkpoint(stopped)
        before = self.snapshot
        after = before.with_update(update, self.program)
        # Only programs with running actions have many updates for which the last grounding helps.
        goes_on = RUNNING in self.program.open_signatures
        runner = (self._following(after) if goes_on else None) or self._runner(after, stopped)
        self._searched, self._under_way = None, lambda: runner.horizon
        limit_from = time.process_time()
        found = self._first_plan(runner, update, stopped)
        spent = {"needed": time.process_time() - began}
        reply, proven = found.reply, bool(found.reply.satisfiable)
        if reply.satisfiable and self._plan_time is not None:
            reply, proven = self._shortened(runner, found, limit_from + self._plan_time * found.share, stopped)
        spent.update(solve=runner.seconds, ground=time.perf_counter() - start - runner.seconds)
        warnings = () if update is None else update.warnings
        result = self._result(runner, reply, proven, warnings, spent)
        answered = bool(result.answers)
        horizon = result.horizon if answered else runner.horizon
        self.log = self.log.with_entries(AcceptedUpdate(update, horizon, answered))
        runner.snapshot, self._searched = self.snapshot, runner
        self._adopt(result)
        if self._steps_to_check >= MANY_STEPS:
            with suppress(StoppedError):
                self.checkpoint(stopped)
        elif self.log.length > max(self._log_limit, self.snapshot.size // 100):  # to write a large one takes long
            self._replace_log(self.log.checkpoint(self.snapshot))
        return result

    def _first_plan(self, runner: StrategyRunner, update: Optional[StreamUpdate], stopped: Stop) -> FirstPlan:
        """Return a shortest plan, or any plan if the time is limited."""
        plan = self.log.plan
        try:
            if self._plan_time is None:
                return FirstPlan(runner.run(shortest(runner, self.models, plan.horizon if plan else 0), stopped))
            succeeds = update is not None and reports_only_success(update, self.snapshot.permanent)
            return runner.run(FirstPlanSearch(runner, plan, succeeds).run(), stopped)
        except StoppedError:
            return FirstPlan(UNKNOWN)

    def _shortened(self, runner: StrategyRunner, first: FirstPlan, end: float, stopped: Stop) -> Tuple[Reply, bool]:
        """Return the best plan that is found until the processor time ``end``, and whether no plan is better."""

        def is_over() -> bool:
            """Return whether to accept the best plan so far."""
            return stopped() or time.process_time() >= end

        if not runner.snapshot.running:
            self._improvement = None  # so that all workers give the same answer
        improvement = self._improving(first.reply.plan, runner.step - 1, first.least)
        reply, better = first.reply, first.reply  # type: Reply, Optional[Reply]
        while better is not None:
            reply, better = better, runner.run(improvement.run(runner), is_over)
        if self.models != 1:
            with suppress(StoppedError):
                reply = runner.run(all_answers(reply, self.models), stopped)
        return reply, improvement.is_proven

    def _result(
        self, runner: StrategyRunner, reply: Reply, proven: bool, warnings: Tuple[str, ...], spent: Dict[str, float]
    ) -> SolveResult:
        horizon = runner.horizon
        if reply.satisfiable:
            horizon = reply.horizon
        elif reply.hopeless:
            horizon = max(horizon, runner.last())
        return SolveResult(
            _OUTCOMES[reply.satisfiable],
            reply.answers,
            horizon,
            runner.step,
            (*warnings, *self._warnings(runner)),
            reply.permanent,
            spent,
            proven,
            self._predicted(runner, reply, proven),
        )

    def _runner(
        self,
        snapshot: Snapshot,
        stopped: Stop,
        assumable: FrozenSet[clingo.Symbol] = frozenset(),
    ) -> StrategyRunner:
        """Return a runner for strategies that ask about ``snapshot``; raises StoppedError."""

        def build(snapshot: Snapshot, horizon: int, stopped: Stop) -> Grounding:
            predicts = self._predicts and not assumable
            return Grounding(self.program, snapshot, horizon, assumable, stopped, predicts)

        idles = may_idle(self.program, stopped) if self._idles is None else self._idles
        return StrategyRunner(self.program, snapshot, build, BLOCK if idles else 1, self._horizon_limit, stopped)

    def _following(self, snapshot: Snapshot) -> Optional[StrategyRunner]:
        """Return a runner that uses the grounding of the last search; None if it has to be regrounded."""
        return None if self._searched is None else self._searched.following(snapshot)

    def _warnings(self, runner: StrategyRunner) -> Iterator[str]:
        """Yield warnings about the last update, and new remarks of clingo."""
        yield from () if runner.follows else runner.grounding.warnings
        messages = runner.grounding.messages
        for one in messages.new_remarks(self.program.parameter_at) if messages.received else ():
            if str(one) not in self._remarks:
                self._remarks.add(str(one))
                yield str(one)

    def recent(self, answer: Answer) -> Answer:
        """Return ``answer`` without the atoms of old cycles."""
        return recent_atoms(answer, self.step, self.program)

    def _predicted(self, runner: StrategyRunner, reply: Reply, proven: bool) -> FrozenSet[clingo.Symbol]:
        """Return the predicted returns; a plan that is ``proven`` shortest must remain shortest."""
        if not runner.snapshot.is_steady or runner.grounding.is_cyclic:
            return frozenset()
        return reply.predicted.certain if proven else reply.predicted.returns

    # ---- Better plans ------------------------------------------------------------------------------------------------

    def improve(self, stopped: Optional[Stop] = None) -> Optional[SolveResult]:
        """Search for a better plan with the same actions up to the present step, and adopt it.

        A better plan has fewer steps. If it has the same number, it has fewer actions, a robot acts earlier, or it
        costs less according to ``#minimize`` statements. The first better plan is returned as another answer to the
        last update; further calls can find still better plans. Returns None after a stop, if the search is exhausted
        until the next update, or if the solver computes several answers.
        """
        plan = self.log.plan
        if plan is None or plan.shortest or self.models != 1:
            return None
        halt = stopped or never
        start, improvement = time.perf_counter(), self._improving(plan, self.step, self.snapshot.min_horizon)
        try:
            runner = self._following(self.snapshot) or self._runner(self.snapshot, halt)
        except StoppedError:
            return None
        self._searched, self._under_way = runner, lambda: runner.horizon
        if runner.grounding.is_cyclic:
            return None
        reply = runner.run(improvement.run(runner), halt)
        while reply is not None and reply.plan.rest(self.step) == plan.rest(self.step):
            reply = runner.run(improvement.run(runner), halt)
        if reply is None:
            return None
        spent = {"solve": time.perf_counter() - start, "ground": 0.0, "needed": 0.0}
        predicted = self._predicted(runner, reply, proven=False)
        answers, step = reply.answers, self.step
        result = SolveResult(SolveOutcome.SATISFIABLE, answers, reply.horizon, step, (), False, spent, False, predicted)
        self._adopt(result)
        return result

    def _improving(self, plan: Plan, step: int, first: int) -> Improvement:
        """Return the improvement of ``plan`` after ``step``: the last one if it can continue."""
        if self._improvement is None or not self._improvement.moves_to(plan, step, first):
            self._improvement = Improvement(plan, step, first)
        return self._improvement

    # ---- Hypothetical questions --------------------------------------------------------------------------------------

    def inquire(
        self,
        update: StreamUpdate,
        assumable: FrozenSet[clingo.Symbol],
        disabled: FrozenSet[clingo.Symbol],
        stopped: Optional[Stop] = None,
        kept: Sequence[clingo.Symbol] = (),
        believes: bool = True,
    ) -> Reply:
        """Return whether ``update`` has an answer if the ``disabled`` facts do not hold; the history is unchanged.

        The ``disabled`` facts are a subset of the ``assumable`` ones. These are facts of the stream or the update, and
        executed actions; a disabled action counts as not executed. The atoms ``kept`` must be true. For ``believes``
        see :class:`Question`. The grounding is cached by history, update and assumable facts. Raises like
        :meth:`update`.
        """
        check_horizon_limit(update, self.horizon, self._horizon_limit)
        halt = stopped or never
        unbounded = replace(update, bound=None)
        key = self.log.key, unbounded, assumable
        probed, self._probed = self._probed, None  # no cache remains after an error
        try:
            if probed is None or probed.key != key or probed.runner.block == 1:
                snapshot = self.snapshot.with_update(unbounded, self.program)
                probed = _Probed(key, self._runner(replace(snapshot, bound=None), halt, assumable))
            runner = probed.runner
            last = runner.last(None if update.bound is None else runner.step + update.bound)
            end = max(self.horizon, runner.snapshot.horizon, last)
            reply = runner.run(probe(runner, end, disabled, kept, believes), halt)
        except StoppedError:
            reply = UNKNOWN
        self._probed = probed
        return reply

    def probed_atoms(self) -> List[clingo.Symbol]:
        """Return all atoms that can be true at the steps grounded for the last hypothetical question."""
        return [] if self._probed is None else self._probed.runner.grounding.possible_atoms

    # ---- Checkpoints -------------------------------------------------------------------------------------------------

    def checkpoint(self, stopped: Stop = never) -> None:
        """Append a checkpoint to the history; compact past steps if there are enough."""
        if stopped():
            return
        snapshot, plan, compact = self.snapshot, self.log.plan, None
        if plan is not None and self._steps_to_check >= LEAST_STEPS:
            compact = compacted(self.program, snapshot, plan, stopped)
            self._checked_until = 0 if compact is not None else end_of_past(self.program, snapshot)
        self._replace_log(self.log.checkpoint(compact or snapshot))

    @property
    def _steps_to_check(self) -> int:
        """The number of past grounded steps that can be compacted and were not checked for that."""
        first = max(first_open(self.program, self.snapshot), self._checked_until)
        return end_of_past(self.program, self.snapshot) - first if self.log.answered else 0
