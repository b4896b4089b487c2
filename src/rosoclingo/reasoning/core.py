"""The core of Fig. 4: it receives goals and facts, and sends the actions of each cycle."""

from contextlib import suppress
from typing import Callable, ClassVar, List, Optional, Sequence, Tuple

from rosoclingo.oclingo import DroppedError, ReactiveProgram, SolveOutcome, SolverError, SolveResult, StreamUpdate
from rosoclingo.planning.minimal_sets import UndecidedError
from rosoclingo.reasoning.action_extractor import TaskPlan, extract_plan
from rosoclingo.reasoning.admission import Admission
from rosoclingo.reasoning.deferral import defer
from rosoclingo.reasoning.events import (
    ActionsDispatched,
    ActionsPreempted,
    Announcer,
    GoalUnmet,
    Mode,
    ModeChanged,
    Observer,
)
from rosoclingo.reasoning.explanations import explanations_in, refusals, streams_of
from rosoclingo.reasoning.goal_manager import GoalManager
from rosoclingo.reasoning.goal_status import Reading
from rosoclingo.reasoning.goals import Goal, Outcome
from rosoclingo.reasoning.hypotheses import Impasse, Way
from rosoclingo.reasoning.input_feeder import Batch, Clock, InputFeeder
from rosoclingo.reasoning.interface_watch import InterfaceWatch
from rosoclingo.reasoning.keywords import CANCEL_ACTION, STATUS, Action
from rosoclingo.reasoning.preemption import Preemption
from rosoclingo.reasoning.preparations import Preparations
from rosoclingo.reasoning.recorded_history import RecordedHistory
from rosoclingo.reasoning.records import PersistentPart, Record, fields, record_of
from rosoclingo.reasoning.recovery import Recovery, forget_history, recover, settle
from rosoclingo.reasoning.repair import repair
from rosoclingo.reasoning.returns import DONE, ExecutionMonitor
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.reasoning.situations import SITUATION_AFTER, Response, Situation, State
from rosoclingo.reasoning.stream_planner import (
    DisturbedError,
    Planner,
    SearchWatch,
    SolverFactory,
    split_batch,
    unwatched,
)


class Core(PersistentPart):
    """The cycle: solve, dispatch the actions planned for now, await their returns, feed them back, and solve again.

    The caller passes on arrivals by ``add_goal``, ``cancel_goal`` and ``receive``. It calls ``poll`` as time passes,
    and ``advance`` until that returns False. Only the searches in ``start`` and ``advance`` block. After each search, a
    loop walks the table :attr:`responses`, which lists the steps to try in each situation.

    The ``observer`` receives all events, in order. Times (``now``) are in seconds of any clock.

    ``interfaces`` receives the announcements of interfaces and their messages; call its ``look`` as wall time passes.

    ``watch`` can end any search, and ``watch_recovery`` the search for goals to abort and for the reasons.
    ``watch_joining`` ends the wait for a plan with new goals while the current plan continues; None waits until the
    plan is found.

    A core resumes from the ``record`` of the :meth:`state` of a core with the same program, between any two of its
    steps. The state and the arrivals determine the behaviour, except for searches that time out and for the choice
    among equally good answers.
    """

    GROUP = "core"
    FIELDS = fields(
        _started=bool,
        _step=int,
        _waits=int,
        _improvable=bool,
        _lookahead=int,
        _plan=Optional[TaskPlan],
        _last_plan=TaskPlan,
        _last_cycle=int,
        _mode=Mode,
        _withheld=bool,
    )

    def __init__(
        self,
        program: ReactiveProgram,
        make_solver: SolverFactory,
        observer: Observer,
        settings: CoreSettings,
        watch: SearchWatch = unwatched,
        watch_recovery: SearchWatch = unwatched,
        watch_joining: Optional[SearchWatch] = None,
        record: Optional[Record] = None,
    ) -> None:
        self._announce = Announcer(observer, lambda: self.cycle, program.time_position)
        self._problem = self._announce.problem
        self._settings, self._watch_recovery = settings, watch_recovery
        self._planner = Planner(make_solver, settings.horizon_limit, watch, running=lambda: self._execution.running)
        self._has_status_rules = program.defines(STATUS, 3)
        self._clock = Clock(program.delay_of, program.first_step)
        self._feeder = InputFeeder(self._clock)
        self._goals = GoalManager(program, self._feeder, self._announce, settings)
        learns = settings.learn_durations
        self._execution = ExecutionMonitor(program, self._feeder, self._clock, self._announce, learns)
        limits = settings.interface_timeout, settings.lost_timeout
        self.interfaces = InterfaceWatch(program, self._execution, self._announce, *limits)
        joining = None if self._execution.goes_on else watch_joining  # running actions do not wait for a plan
        self._ahead = Preparations(self._goals, self._feeder, self._execution, settings.horizon_limit, joining)
        self._preemption = Preemption(self._feeder, self._execution, program.declares_external(CANCEL_ACTION, 3))
        self._plan: Optional[TaskPlan] = TaskPlan()  # None after an interrupted search, which has to be repeated
        self._last_plan, self._last_cycle = TaskPlan(), 0  # the last executed plan and its cycle
        self._step, self._waits = 0, 0
        self._improvable = False  # whether a shorter plan can exist
        self._mode = Mode.RUNNING
        self._withheld = False  # whether actions of this cycle were not dispatched because of the mode
        self._recorded, self._started = RecordedHistory(), False
        if record is not None:
            self._resume(record)

    @property
    def cycle(self) -> int:
        """The logical time point, from 1."""
        return max(1, self._step)

    @property
    def plan(self) -> TaskPlan:
        """The task plan of the latest answer."""
        return TaskPlan() if self._plan is None else self._plan

    @property
    def queue(self) -> Admission:
        """The admission of goals: it queues goals, and sets the time limit of searches for the others."""
        return self._goals.queue

    @property
    def mode(self) -> Mode:
        """Whether the core dispatches actions."""
        return self._mode

    @property
    def live_goals(self) -> List[Goal]:
        """The goals that have not ended, oldest first."""
        return self._goals.live

    @property
    def awaited(self) -> Tuple[Action, ...]:
        """The running actions."""
        return self._execution.awaited

    @property
    def preempted(self) -> Tuple[Action, ...]:
        """The running actions that the plan no longer needs."""
        return self._preemption.found

    @property
    def shown(self) -> Tuple[Action, ...]:
        """The actions to report: the last executed ones, even after compaction, and the rest of the plan."""
        return self._execution.executed[-DONE:] + self.plan.remaining(self.cycle)

    @property
    def horizon(self) -> int:
        """The horizon of the last answer."""
        return self._planner.log.horizon

    def goal(self, key: str) -> Optional[Goal]:
        """Return the live goal with a client's handle, None if there is none."""
        return self._goals.by_key(key)

    def add_goal(self, key: str, text: str) -> None:
        """Add the goal ``text`` under the client's handle ``key``, or reject it with a reason."""
        self._goals.add(key, text)
        if self._mode is Mode.STOPPED and self._goals.live:
            self._set_mode(Mode.RUNNING)

    def cancel_goal(self, key: str) -> None:
        """Cancel a goal; has no effect if the goal has ended."""
        self._goals.cancel(key)

    def receive(self, origin: str, facts: Sequence[str]) -> None:
        """Accept facts from the interface ``origin``; invalid facts are reported as problems and ignored."""
        self._execution.receive(origin, facts)

    def poll(self, now: float) -> None:
        """Advance the time: fail actions that have not returned in time, and admit goals that have rested."""
        self._execution.expire(now, self._settings.action_timeout)
        self._goals.tick(now)
        self._feeder.tick(now)

    def start(self) -> None:
        """Solve once before any update; an empty plan leaves the core idle in cycle 1. A resumed core continues."""
        if self._started:
            return
        self._started = True
        try:
            result = self._planner.solve()
        except DisturbedError:
            self._plan = None
            return
        except SolverError as error:
            self._problem(f"the program can't be solved before any request: {error}")
            return
        if result.outcome is SolveOutcome.SATISFIABLE:
            self._plan = extract_plan(result.answers[0])
        else:
            why = f"{self._planner.why_none(result)} (the command check --plan names the rules that exclude one)"
            self._problem(f"the program has no answer before any request: {why}")
        self._announce.plan(result, self.shown)

    def advance(self, now: float) -> bool:
        """Start the next cycle if there is a reason to; return False if the core waits for an arrival."""
        due = self._due()
        if not due and self.awaited:  # cheap while actions run
            self._preempt()  # which can end the cycle, as a cancellation is an arrival for the program
            due = self._due()
        if due:
            self._next_cycle(now)
        return due

    def improve(self, stopped: Callable[[], bool]) -> bool:
        """Improve the plan while actions run and nothing waits; return whether a better plan can still exist.

        Running actions stay in the plan. The call returns with each better plan, and soon after ``stopped``, which is
        polled every few milliseconds, returns True.
        """
        if not self.awaited or self._feeder.pending or self._ahead.join is not None:
            return False
        result = self._planner.improve(stopped) if self._improvable and not stopped() else None
        if result is not None:
            self._follow(result)
            self._announce.plan(result, self.shown)
            self._report_progress()
        self._improvable = self._improvable and (result is not None or stopped())
        return self._improvable

    def compact(self, stopped: Callable[[], bool]) -> None:
        """Compact a long history if actions run and nothing waits; ``stopped`` is polled as by :meth:`improve`."""
        if self.awaited and not self._feeder.pending:
            self._planner.compact(stopped)

    def prepare(self) -> None:
        """Prefetch the answer to a likely update, or a plan with queued goals, while actions run."""
        self._ahead.prepare(self._planner, self._last_plan, self._announce.published + 1)

    def pause(self, paused: bool) -> None:
        """Dispatch no further actions, or continue. Running actions go on, and goals join and are planned for."""
        self._set_mode(Mode.PAUSED if paused else Mode.RUNNING)

    def stop(self, why: str) -> None:
        """Cancel the running actions, abort every goal, and dispatch no actions until the next goal arrives.

        A paused core stays paused.
        """
        self.shut_down(why)
        if self._mode is Mode.RUNNING:
            self._set_mode(Mode.STOPPED)

    def _set_mode(self, mode: Mode) -> None:
        if mode is not self._mode:
            self._mode = mode
            self._announce.emit(ModeChanged(self.cycle, mode))
            self._report_progress()

    def _report_progress(self) -> None:
        self._announce.progress(self._step, self._goals.fed, self.shown, self._mode is Mode.PAUSED)

    def shut_down(self, why: str) -> None:
        """Cancel the running actions and abort every goal.

        A core that resumes sends the same cancels, and cancels the goals that its program has.
        """
        self._end(self._preemption.end_all())
        self.abandon(why)

    def abandon(self, why: str) -> None:
        """Abort every goal, and cancel the goals in the program with the next update."""
        self._goals.drop(self._goals.fed, why)
        self._goals.end(self._goals.live, Outcome.ABORTED, why)

    def _preempt(self) -> None:
        """Preempt running actions that an arrival has made useless."""
        with suppress(DisturbedError):
            self._end(self._preemption.unwanted(self._planner) if self._settings.preempt else ())

    def _end(self, actions: Tuple[Action, ...]) -> None:
        """Cancel running actions at their interfaces."""
        if actions:
            self._announce.emit(ActionsPreempted(self.cycle, actions))

    def _due(self) -> bool:
        """Return whether to start another cycle: there is input, a search was interrupted, or the plan continues.

        While actions run, a cycle can end only if they can go on in the next one.
        """
        continues = self._withheld and self._mode is Mode.RUNNING and bool(self.plan.at(self._step))
        arrived = self._feeder.pending or (self._plan is None and not self._feeder.pauses) or continues
        if self.awaited:
            return self._execution.goes_on and (arrived or (self._unseen and not self._execution.has_dispatched))
        return arrived or bool(self._execution.under_way) or self._later()

    @property
    def _unseen(self) -> bool:
        """Whether the program sees the request of a goal only in a later cycle."""
        return any((one.request_cycle or 0) > self._step for one in self._goals.fed)

    def _later(self) -> bool:
        fed, patient = self._goals.fed, self._waits < self._planner.lookahead
        if self._unseen or self._mode is not Mode.RUNNING:
            return self._unseen
        planned = self.plan.remaining(self._step + 1)
        return bool(planned) or (patient and bool(fed) and self._planner.ends_later(self._step))

    def _next_cycle(self, now: float) -> None:
        if goals := self.queue.yielding():
            with suppress(DisturbedError):
                self._defer(goals, "no plan was found in time")
        executed = self._execution.end_cycle()
        self._waits = 0 if executed or self._feeder.pending else self._waits + 1
        self._feeder.add_executed(executed)
        self._step = self._announce.published + 1
        followed = self._mode is Mode.RUNNING and not self._withheld
        batch = self._ahead.next_update(self._planner, self._last_plan, self._step, followed)
        self._respond(State(Situation.DUE, batch, now))

    def _respond(self, state: State) -> None:
        """Try the steps of the table until the cycle has begun or the core waits."""
        while state.situation is not Situation.SETTLED:
            steps = (row.step for row in self.responses if row.situation is state.situation)
            try:
                state = next(filter(None, (step(self, state) for step in steps)))
            except UndecidedError:
                why = f"{state.why}, and the goals that cannot be met were not found in time"
                state = state._replace(situation=Situation.TIMEOUT, why=why)
            except DisturbedError as disturbance:
                self._problem(str(disturbance))
                if disturbance.accepted and not state.accepted:
                    state = self._accept(state, state.batch)
                state = state._replace(situation=Situation.DISTURBED)
        if state.accepted:
            self._announce.update(self._step, self._planner.last_update)

    # -- sending updates

    def _send(self, state: State) -> Optional[State]:
        return self._offer(state, self._planner.update, state.batch.update)

    def _send_without_goals(self, state: State) -> Optional[State]:
        if not state.batch.goals or (state.situation is Situation.DROPPED and not self._goals.fed):
            return None
        return self._offer(state, self._planner.update, state.batch.without_goals)

    def _take(self, state: State) -> Optional[State]:
        if state.batch.goals and self._goals.fed:
            return None
        return self._offer(state, self._planner.take, state.batch.update)

    def _send_essentials(self, state: State) -> Optional[State]:
        if state.batch.indispensable == state.batch.update:
            return None
        ask = self._planner.update if state.situation is Situation.REFUSED else self._planner.take
        return self._offer(state, ask, state.batch.indispensable)

    def _offer(self, state: State, ask: Callable[[StreamUpdate], SolveResult], update: StreamUpdate) -> Optional[State]:
        """Send an update to the solver; return None if it fails again in the same way.

        Goals of a refused update are rejected; goals of a dropped update stay.
        """
        batch = state.batch
        try:
            result = ask(update)
            if update is batch.update:
                self._planner, batch, result = split_batch(self._planner, batch, result)
        except DroppedError as error:
            why = ": ".join(filter(None, (self._planner.ended_by, str(error))))
            self._problem(f"update {batch.step} is dropped: {why}")
            again, situation = state.situation is Situation.DROPPED, Situation.DROPPED
        except SolverError as error:
            self._problem(f"update {batch.step} is refused by the solver: {error}")
            if update is batch.update:
                self._goals.end(batch.goals, Outcome.REJECTED, f"is refused by the solver: {error}")
            again, situation = state.situation is not Situation.DUE, Situation.REFUSED
        else:
            return self._answered(self._accept(state, batch), result)
        return None if again else state._replace(situation=situation)

    def _wait(self, state: State) -> State:
        """Send the update again later, with more time."""
        self._plan, self._planner = None, self._planner.restarted()
        self.queue.give_time()
        self._feeder.wait(state.now)
        return state.settled

    def _abandon(self, state: State) -> State:
        self._plan, self._planner = TaskPlan(), self._planner.restarted()
        self.abandon("is aborted: the solver accepts no more updates")
        self._feeder.forget_executed()
        self._feeder.wait()
        return state.settled

    def _accept(self, state: State, batch: Batch) -> State:
        """Record the facts of an accepted update; omitted facts are fed again unless the solver refused them."""
        self._step, present = batch.step, self._planner.last_update.heads
        for fact in self._feeder.update_accepted(batch, present, state.situation is Situation.REFUSED):
            self._problem(f"{fact.sent} is dropped: the solver accepts no update with it", fact.origin)
        self._execution.update_accepted(batch.facts, present)
        self._execution.begin_cycle(self._step)
        self._goals.update_accepted(batch.goals, present)
        return state._replace(batch=batch, accepted=True)

    # -- results of searches

    def _answered(self, state: State, result: SolveResult) -> State:
        """Return the state after the search for a new update."""
        self._plan, batch = TaskPlan(), state.batch
        for warning in result.warnings:
            self._problem(warning)
        self._goals.reject_undeclared(batch.goals, result.warnings)
        if self._execution.has_unhandled(batch.failures, result.warnings):
            return state._replace(situation=Situation.UNHANDLED, result=result)
        return self._judged(state, result)

    def _judged(self, state: State, result: SolveResult) -> State:
        situation = SITUATION_AFTER[result.outcome]
        if situation is not Situation.PLAN:
            self._announce.plan(result, self.shown)
        return state._replace(situation=situation, result=result, why=self._planner.why_none(result))

    def _settle_failures(self, state: State) -> State:
        impasse, unhandled = self._impasse(state.batch), self._execution.unhandled
        settled = settle(self._planner, state.result, impasse, unhandled, self._problem)
        self._planner, result = settled.planner, settled.result
        self._execution.unhandled.clear()
        if settled.recovery is None:
            for one in settled.unmet:
                self._goals.abort(one.goal, one.text({}, ""))
            return self._judged(state, result)
        self._plan = extract_plan(result.answers[0]) if result.answers else None
        self._announce.plan(result, self.shown)
        return self._adopt(state._replace(why=""), settled.recovery)

    def _dispatch(self, state: State) -> Optional[State]:
        """Execute the plan of the answer; return None if it was deferred too often."""
        self._announce.update(self._step, self._planner.last_update)
        self._use(state.result, state.now, any(goal.fed for goal in state.batch.goals))  # some can be left out
        for problem in refusals(state.result.answers[0], state.batch.facts):
            self._problem(*problem)
        deferred = not self._execution.under_way and self._waits >= self._planner.lookahead and self._later()
        return None if deferred else state.settled

    def _use(self, result: SolveResult, now: float, new_goals: bool = False) -> None:
        """Dispatch the actions that are due before reporting the rest of the answer."""
        since, plan = self._last_cycle + 1, self._follow(result)
        due = plan.at(self._step)
        actions, left_out = self._execution.begin(self._step, due, now, sends=self._mode is Mode.RUNNING)
        self._withheld = len(self._execution.under_way) < len(due)
        self._preemption.begin(actions)
        if self._settings.preempt:
            self._end(self._preemption.end(left_out))
        if actions:
            self._announce.emit(ActionsDispatched(self._step, actions))
        shown = self.shown
        self._announce.plan(result, shown)
        self._improvable = not result.shortest
        self._goals.plan_found(result.statistics["needed"] if new_goals else None)
        answer, has_rules = result.answers[0], self._has_status_rules
        self._goals.read(Reading(answer, plan, since, self._step, result.horizon, has_rules))
        self._report_progress()

    def _follow(self, result: SolveResult) -> TaskPlan:
        """Adopt the plan of an answer."""
        plan = self._plan = self._last_plan = extract_plan(result.answers[0])
        self._last_cycle = self._step
        return plan

    def _lose_patience(self, state: State) -> State:
        """Drop a plan that the program has deferred for more cycles than a plan can have steps."""
        self._problem(f"the plan was deferred {self._waits} times in a row: it is dropped")
        self._plan = TaskPlan()
        self._goals.drop(self._goals.fed, "cannot be met: the program keeps deferring its plan")
        return state.settled

    def _impasse(self, batch: Batch) -> Impasse:
        goals, seen = tuple(reversed(self._goals.fed)), tuple(reversed(self._execution.observations))
        watch, alone, executed = self._watch_recovery, self._settings.horizon_limit, self._execution.executed
        return Impasse(self._step + 1, goals, seen, watch, alone, batch.facts, executed, self._clock)

    def _give_up_goals(self, state: State) -> Optional[State]:
        found = recover(self._planner, self._impasse(state.batch))
        return None if found is None else self._adopt(state._replace(no_plan=self._planner.stream), found)

    def _adopt(self, state: State, found: Recovery) -> State:
        """Start the next cycle without the unmet goals."""
        self._announce.update(self._step, self._planner.last_update)
        if found.way is Way.WITHHELD:
            self._problem("cancelling did not help: the requests of the unmet goals are withheld from the solver")
        for one, stream in streams_of(found.unmet, state.no_plan) if state.no_plan is not None else ():
            self._announce.emit(GoalUnmet(self.cycle, one.goal.key, one.goal.term, stream))
        self._planner = found.planner
        self._step += 1
        self._execution.begin_cycle(self._step)
        explanations, faults = explanations_in(found.result.answers[0])
        for fault in faults:
            self._problem(fault)
        for one in found.unmet:
            one.goal.end(Outcome.ABORTED, one.text(explanations, state.why))
        return self._answered(state._replace(batch=Batch(found.update), no_plan=None), found.result)

    def _repair(self, state: State) -> Optional[State]:
        """Redate or drop the fewest observations, once for each update."""
        if state.no_plan is not None:
            return None
        found = repair(self._planner, self._impasse(state.batch))
        if found is None:
            return None
        no_plan = self._planner.stream
        self._planner, result, changes = found
        self._execution.change(changes, state.batch.failures)
        return self._answered(state._replace(no_plan=no_plan), result)

    def _forget_history(self, state: State) -> Optional[State]:
        found = forget_history(self._planner, self._step, state.why, self._problem)
        if found is None:
            return None
        self._planner, updates, result = found
        self._problem(f"ERROR: the program has no answer with its history: {state.why}; it forgets its history")
        old = [goal for goal in self._goals.fed if goal not in state.batch.goals]
        self._goals.end(old, Outcome.ABORTED, "is aborted: the program forgets its history")
        self._goals.resend(state.batch.goals)
        self._execution.forget_all()
        self._announce.updates(self._step, updates)
        return self._answered(state._replace(batch=Batch(self._planner.last_update), no_plan=None), result)

    def _cancel_all(self, state: State) -> State:
        self._problem(f"no answer was found, even without goals: {state.why}")
        self._goals.drop(self._goals.fed, f"cannot be met: {state.why}")
        self._planner = self._planner.restarted()
        return state.settled

    # -- time-outs

    def _keep_plan(self, state: State) -> Optional[State]:
        """Keep the last plan if it is still valid, deferred by the cycles without actions."""
        last = self._last_cycle - self._withheld
        actions = [one._replace(cycle=one.cycle + self._step - last - 1) for one in self._last_plan.remaining(last + 1)]
        result = self._planner.solve_with(actions) if actions and not state.batch.known_goals else None
        return None if result is None else state._replace(situation=Situation.PLAN, result=result)

    def _defer_goals(self, state: State) -> Optional[State]:
        self._plan = None
        if state.deferred or not self._defer(self.queue.too_many(state.batch.known_goals), state.why):
            return None
        return state._replace(deferred=True)

    def _defer(self, chosen: Sequence[Goal], why: str) -> bool:
        """Withdraw goals from the program until they are admitted again; return whether there are any."""
        published, done, look = self._announce.published, self._execution.executed, self._watch_recovery()
        planner, text = defer(self._planner, self._goals, chosen, why, published, done, look)
        deferred, self._planner = planner is not self._planner, planner
        self._problem(text)
        return deferred

    def _search_again(self, state: State) -> State:
        self._plan = None
        self.queue.interrupted |= state.situation is Situation.DISTURBED
        return state.settled

    # -- persisted state

    @property
    def parts(self) -> Tuple[PersistentPart, ...]:
        """The parts with a persisted state; valid between two steps."""
        self._recorded.follow(self._planner.log)
        goals, execution = self._goals, self._execution
        parts = goals, goals.queue, self._feeder, execution, execution.durations
        return (self._recorded, self, *parts, self.interfaces, self._preemption, self._announce)

    def state(self) -> Record:
        """Return the rows of all parts."""
        return record_of(self.parts)

    @property
    def _lookahead(self) -> int:
        return self._planner.lookahead

    @_lookahead.setter
    def _lookahead(self, steps: int) -> None:
        self._planner.lookahead = steps

    def _resume(self, record: Record) -> None:
        for part in self.parts:
            part.restore(record)
        self._feeder.find_goals(self._goals.by_key)
        self._planner = self._planner.with_log(self._recorded.history)

    def report_beliefs(self) -> None:
        """Report the restored beliefs of a resumed core, before any search."""
        self._announce.present()

    # -- the table

    #: The steps to try in each situation, in this order. The last row of each situation always applies.
    responses: ClassVar[Tuple[Response, ...]] = (
        Response(Situation.DUE, "send the update", _send),
        Response(Situation.REFUSED, "send it without new goals, which are rejected", _send_without_goals),
        Response(Situation.REFUSED, "send it without facts, too", _send_essentials),
        Response(Situation.REFUSED, "abort all goals", _abandon),
        Response(Situation.DROPPED, "send it without new goals, if the program has others", _send_without_goals),
        Response(Situation.DROPPED, "else send it whole, without a search", _take),
        Response(Situation.DROPPED, "send it without new goals, facts and search", _send_essentials),
        Response(Situation.DROPPED, "send it again later, with more time", _wait),
        Response(
            Situation.UNHANDLED, "count the action as not done, abort the goals that rest on it", _settle_failures
        ),
        Response(Situation.PLAN, "dispatch the actions of the cycle", _dispatch),
        Response(Situation.PLAN, "abort all goals, if the program keeps deferring its plan", _lose_patience),
        Response(Situation.NO_PLAN, "abort the fewest goals, the newest first", _give_up_goals),
        Response(Situation.NO_PLAN, "redate or drop the fewest observations", _repair),
        Response(Situation.NO_PLAN, "start again: the program forgets its history", _forget_history),
        Response(Situation.NO_PLAN, "cancel all goals", _cancel_all),
        Response(Situation.TIMEOUT, "keep the current plan, if the update has no new goals", _keep_plan),
        Response(Situation.TIMEOUT, "defer goals, the newest first", _defer_goals),
        Response(Situation.TIMEOUT, "search again, with more time", _search_again),
        Response(Situation.DISTURBED, "search again, with the arrivals", _search_again),
    )
