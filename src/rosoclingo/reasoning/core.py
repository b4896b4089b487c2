"""The core of Fig. 4: clients' goals and the interfaces' facts go in, the actions of each cycle come out."""

from contextlib import suppress
from dataclasses import dataclass
from typing import List, Optional, Sequence, Tuple

from rosoclingo.oclingo import ProgressionError, ReactiveProgram, SolveOutcome, SolverError, SolveResult, parse_atom
from rosoclingo.reasoning.action_extractor import TaskPlan, extract_plan
from rosoclingo.reasoning.dispatch import Dispatch, ReturnError
from rosoclingo.reasoning.events import (
    ActionsDispatched,
    FactTaken,
    GoalProgress,
    Observer,
    PlanMade,
    Problem,
    ReturnTaken,
    UpdateSent,
)
from rosoclingo.reasoning.facts import FactError, check_fact, take_return
from rosoclingo.reasoning.feeding import feed
from rosoclingo.reasoning.goal_desk import GoalDesk
from rosoclingo.reasoning.goals import Goal, Outcome
from rosoclingo.reasoning.input_feeder import Batch, InputFeeder
from rosoclingo.reasoning.judge import judge
from rosoclingo.reasoning.keywords import TIMEOUT, Action, KeywordError, Return
from rosoclingo.reasoning.planner import DisturbedError, Planner, SearchWatch, SolverFactory, unwatched
from rosoclingo.reasoning.recovery import Recovery, recover, requests_of
from rosoclingo.reasoning.statuses import Statuses


@dataclass(frozen=True)
class CoreSettings:
    """How far to plan and how long to wait.

    ``horizon_limit``: steps that a plan may reach beyond the current cycle. ``action_timeout``: seconds until an
    action that has not returned counts as failed with the value ``timeout``; 0 waits for ever.
    """

    horizon_limit: int = 100
    action_timeout: float = 600.0


class Core:
    """The cycle: solve, dispatch the actions planned for now, await their returns, feed what happened, solve again.

    ``observer`` hears of everything, in order. Time (``now``) is in seconds of whatever clock the caller keeps. The
    caller passes on what arrives (``add_goal``, ``cancel_goal``, ``receive``), calls ``poll`` as time passes and
    ``advance`` until it returns False. Nothing here blocks except the search in ``start`` and ``advance``.
    """

    def __init__(
        self,
        program: ReactiveProgram,
        make_solver: SolverFactory,
        observer: Observer,
        settings: CoreSettings = CoreSettings(),
        watch: SearchWatch = unwatched,
    ) -> None:
        self._program = program
        self._tell = observer
        self._settings = settings
        self._planner = Planner(make_solver, settings.horizon_limit, watch)
        self._feeder = InputFeeder()
        self._desk = GoalDesk(program, self._feeder, observer, lambda: self.cycle)
        self._step = 0
        self._plan = TaskPlan()
        self._dispatch: Optional[Dispatch] = None
        self._waits = 0
        self._unanswered = False  # the search was left: there is to be another
        self._untaken = False  # so was the update of the present step

    @property
    def cycle(self) -> int:
        """The logical time point, from 1."""
        return max(1, self._step)

    @property
    def plan(self) -> TaskPlan:
        """The task plan of the latest answer."""
        return self._plan

    @property
    def live_goals(self) -> List[Goal]:
        """The goals that have not ended, oldest first."""
        return self._desk.live

    @property
    def awaited(self) -> Tuple[Action, ...]:
        """The actions under way that have not returned."""
        return self._dispatch.missing if self._dispatch else ()

    def add_goal(self, key: str, text: str) -> None:
        """The client's handle ``key`` asks for the goal ``text``; it ends as refused when it cannot be taken."""
        self._desk.add(key, text)

    def cancel_goal(self, key: str) -> None:
        """A client cancels; without effect on a goal that has ended."""
        self._desk.cancel(key)

    def receive(self, origin: str, facts: Sequence[str]) -> None:
        """Facts from the interface ``origin``. One that makes no sense is told as a problem, and the rest are taken."""
        for text in facts:
            try:
                self._take(text)
            except (ProgressionError, KeywordError, ReturnError, FactError) as error:
                self._problem(f"'{text}' from '{origin}' is ignored: {error}")

    def poll(self, now: float) -> None:
        """Time passes: actions that have not returned in time count as failed."""
        limit = self._settings.action_timeout
        if self._dispatch is None or limit <= 0:
            return
        self._dispatch.started = min(self._dispatch.started, now)  # time jumped back: the wait begins anew
        if now - self._dispatch.started < limit:
            return
        for action in self._dispatch.missing:
            self._problem(f"{action.atom} has not returned within {limit:g} s: it counts as failed")
            self._take(str(Return(action.interface, TIMEOUT, action.cycle).atom))

    def start(self) -> None:
        """Solve once before any update; an empty plan leaves the core idle in cycle 1."""
        try:
            result = self._planner.solve()
        except DisturbedError:
            self._unanswered = True
            return
        except SolverError as error:
            self._problem(f"the program can't be solved before any request: {error}")
            return
        if result.outcome is SolveOutcome.SATISFIABLE:
            self._plan = extract_plan(result.answers[0])
        else:
            self._problem(f"the program has no answer before any request: {self._planner.why_none(result)}")
        self._tell_plan(result)

    def advance(self, now: float) -> bool:
        """Start the next cycle if there is reason to; False when the core waits for something to arrive."""
        if self.awaited or not self._due():
            return False
        self._next_cycle(now)
        return True

    def abandon(self, why: str) -> None:
        """The core goes away: every goal is aborted."""
        self._desk.end(self._desk.live, Outcome.ABORTED, why)

    def _take(self, text: str) -> None:
        atom = parse_atom(text)
        if take_return(atom, self._dispatch):
            self._tell(ReturnTaken(self.cycle, atom))
            check_fact(atom, self._program)
        else:
            check_fact(atom, self._program)
            self._tell(FactTaken(self.cycle, atom))
        self._feeder.add_fact(atom)

    def _due(self) -> bool:
        """Whether something happened, an action has ended, a search was left, or the plan has something later only."""
        return bool(self._feeder.pending or self._dispatch or self._unanswered or self._later())

    def _later(self) -> bool:
        unseen = any(goal.request_cycle is not None and goal.request_cycle > self._step for goal in self._desk.fed)
        return unseen or bool(self._plan.after(self._step))

    def _next_cycle(self, now: float) -> None:
        executed = self._dispatch.actions if self._dispatch else ()
        self._waits = 0 if executed or self._feeder.pending else self._waits + 1
        self._dispatch = None
        if self._step and not self._untaken:
            self._planner.end_cycle(self._step, [action.atom for action in executed])
        self._step += 0 if self._untaken else 1
        self._unanswered = self._untaken = False
        batch = self._feeder.next_update(self._step, executed)
        for goal in batch.goals:
            goal.request_cycle = self._step + 1
        self._tell(UpdateSent(self._step, str(batch.update)))
        self._solve(batch, now)

    def _solve(self, batch: Batch, now: float) -> None:
        try:
            result = feed(self._planner, batch, self._desk, self._problem)
        except DisturbedError as disturbance:
            self._leave(disturbance)
            if not disturbance.kept:
                self._untaken = True
                self._feeder.put_back(batch)
            return
        try:
            if result is None:
                self._give_up()
            else:
                self._answered(result, batch.goals, now)
        except DisturbedError as disturbance:
            self._leave(disturbance)

    def _leave(self, disturbance: DisturbedError) -> None:
        """Leave the search: there is another as soon as what has come is taken."""
        self._plan, self._unanswered = TaskPlan(), True
        self._problem(str(disturbance))

    def _give_up(self) -> None:
        """Go back to a short horizon, without the goals' requests."""
        self._plan, requests = TaskPlan(), requests_of(self._desk.fed)
        self._desk.end(self._desk.live, Outcome.ABORTED, "is given up: the solver takes no update any more")
        with suppress(SolverError):
            self._planner = self._planner.restarted(requests)

    def _answered(self, result: SolveResult, fresh: Sequence[Goal], now: float) -> None:
        for warning in result.warnings:
            self._problem(warning)
        self._desk.reject_undeclared(fresh, result.warnings)
        self._plan = TaskPlan()
        if result.outcome is SolveOutcome.SATISFIABLE:
            self._use(result, now)
        else:
            self._tell_plan(result)
            self._recover(self._planner.why_none(result), fresh, now)

    def _use(self, result: SolveResult, now: float) -> None:
        answer = result.answers[0]
        self._plan, statuses = extract_plan(answer), Statuses(answer)
        for fault in (*self._plan.faults, *statuses.faults):
            self._problem(fault)
        self._tell_plan(result)
        for goal in self._desk.fed:
            judge(goal, statuses, self._plan, self._step, result.horizon)
        for goal in self._desk.fed:
            self._tell(GoalProgress(self._step, goal.key, goal.state, self._plan.actions))
        actions = self._plan.at(self._step)
        if actions:
            self._dispatch = Dispatch(self._step, actions, now)
            self._tell(ActionsDispatched(self._step, actions))
        elif self._waits >= self._settings.horizon_limit and self._later():
            self._lose_patience()

    def _lose_patience(self) -> None:
        """A cycle without actions ends at once; a plan that is put off for more cycles than it may be long is none."""
        self._problem(f"the plan was put off {self._waits} times in a row: it is given up")
        self._plan = TaskPlan()
        self._desk.drop(self._desk.fed, "cannot be met: the program keeps putting off its plan")

    def _recover(self, why: str, fresh: Sequence[Goal], now: float) -> None:
        """No plan: end the goals that must go and start the next cycle without them."""
        goals = self._desk.fed
        found = (
            recover(self._planner, self._step + 1, goals, [goal for goal in goals if goal in fresh]) if goals else None
        )
        if found is not None:
            self._adopt(found, why, now)
            return
        self._problem(f"the program has no answer, whatever goals are given up: {why}")
        self._desk.end(goals, Outcome.ABORTED, f"cannot be met: {why}")
        with suppress(SolverError):
            self._planner = self._planner.restarted()

    def _adopt(self, found: Recovery, why: str, now: float) -> None:
        if found.forgotten:
            self._problem("cancelling did not help: the requests that cannot be met are withheld from the solver")
        self._planner = found.planner
        self._step += 1
        self._tell(UpdateSent(self._step, str(found.update)))
        self._desk.end(found.dropped, Outcome.ABORTED, f"cannot be met: {why}")
        self._answered(found.result, (), now)

    def _tell_plan(self, result: SolveResult) -> None:
        seconds = result.statistics
        self._tell(PlanMade(self.cycle, result.horizon, self._plan.actions, seconds["ground"], seconds["solve"]))

    def _problem(self, message: str) -> None:
        self._tell(Problem(self.cycle, message))
