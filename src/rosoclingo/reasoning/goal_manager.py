"""The goal manager: it checks the goals of clients, passes them to the feeder and ends them with a reason."""

from typing import Container, Dict, Iterable, List, Optional, Sequence

from clingo import Symbol

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.solving.results import is_ignored
from rosoclingo.reasoning.admission import Admission
from rosoclingo.reasoning.events import Announcer, GoalChanged, GoalProgress
from rosoclingo.reasoning.goal_status import Reading, update_status
from rosoclingo.reasoning.goals import Goal, GoalError, GoalEvent, GoalState, Outcome, read_goal
from rosoclingo.reasoning.input_feeder import InputFeeder, requests_of
from rosoclingo.reasoning.keywords import REQUEST, SHOWN, request, shortened
from rosoclingo.reasoning.records import PersistentPart, Record, tables
from rosoclingo.reasoning.relevance import RelevanceAnalysis
from rosoclingo.reasoning.settings import CoreSettings


class GoalManager(PersistentPart):
    """The goals of all clients. ``announce`` reports each change.

    Attributes:
        queue: the admission, which decides which goals the program has and which are queued.

    """

    GROUP = "goals"
    TABLES = tables(_goals=("goal", str, Goal))

    def __init__(
        self,
        program: ReactiveProgram,
        feeder: InputFeeder,
        announce: Announcer,
        settings: CoreSettings,
    ) -> None:
        self._program, self._relevance = program, RelevanceAnalysis.of(program)
        self._feeder = feeder
        self._announce = announce
        self._goals: Dict[str, Goal] = {}  # the live goals by their handles, oldest first
        self._now = 0.0
        self.queue = Admission(lambda: self.live, settings, batches=not program.actions_go_on)

    @property
    def live(self) -> List[Goal]:
        """The goals that have not ended, oldest first."""
        return list(self._goals.values())

    @property
    def fed(self) -> List[Goal]:
        """The live goals that the program has, oldest first."""
        return [goal for goal in self._goals.values() if goal.fed]

    def by_key(self, key: str) -> Optional[Goal]:
        """Return the live goal with a client's handle, None if there is none."""
        return self._goals.get(key)

    def add(self, key: str, text: str) -> None:
        """Add the goal ``text``, or reject it with a reason."""
        try:
            goal = Goal(key, read_goal(text))
            if not self._program.declares_external(REQUEST, 2):
                raise GoalError("the program takes no requests: it declares no external _request/2")
            self._check_relevant(goal)
            self._check_unique(goal)
        except GoalError as error:
            rejected = GoalEvent.REJECT, GoalState.REJECTED, Outcome.REJECTED
            self._announce.emit(GoalChanged(self._announce.cycle, key, *rejected, str(error)))
            return
        self._goals[key], goal.waits, goal.observer = goal, True, self._changed
        self._feeder.arrivals += 1
        self._admit()
        if goal.waits:
            before = self.queue.first or self.queue.tried
            limit = f"at most {self.queue.size} goals are planned for at a time"
            why = limit if before is None else f"{before} has priority"
            self.report_wait([goal], why)

    def _check_relevant(self, goal: Goal) -> None:
        """Raise GoalError for a goal that no rule can see; it would count as met without a plan."""
        requests = [request(goal.term, self._announce.cycle + ahead) for ahead in (1, 2)]  # 1 before the first update
        if not any(map(self._relevance.is_relevant, requests)):
            advice = shortened(self._relevance.advice(requests[0]), 2 * SHOWN)
            raise GoalError(f"no rule of the program can see {goal}: {advice}")

    def _check_unique(self, goal: Goal) -> None:
        """Raise GoalError for a goal with the handle or the identifier of a live goal."""
        if goal.key in self._goals:
            raise GoalError(f"the goal handle '{goal.key}' is in use")
        twin = next((one for one in self.live if one.identifier == goal.identifier), None)
        if twin is not None:
            raise GoalError(f"the identifier '{shortened(str(goal.identifier))}' is in use: {twin} has not ended")

    def cancel(self, key: str) -> None:
        """Cancel a goal; has no effect on goals that have ended or have been cancelled before."""
        goal = self._goals.get(key)
        if goal is None or goal.cancelling:
            return
        goal.apply(GoalEvent.CANCEL_REQUEST)
        if goal.fed:
            self._feeder.add_cancellation(goal.identifier)
        else:
            self._feeder.withdraw(goal)
            goal.end(Outcome.CANCELED, f"{goal} was cancelled before it was planned for")

    def tick(self, now: float) -> None:
        """Advance the time, and admit goals if there is room."""
        self._now = now
        self._admit()

    def drop(self, goals: Sequence[Goal], why: str) -> None:
        """Abort goals that the program has, and feed their cancellations."""
        for goal in goals:
            self._feeder.add_cancellation(goal.identifier)
        self.end(goals, Outcome.ABORTED, why)

    def read(self, reading: Reading) -> None:
        """Update the states of the program's goals from an answer; report its faults."""
        for fault in reading.faults:
            self._announce.problem(fault)
        for goal in self.fed:
            update_status(goal, reading)
            if goal.refused:
                self._feeder.add_rejection(goal.identifier)

    def abort(self, goal: Goal, message: str) -> None:
        """Abort a goal that the program has; the next update, if there is one, cancels it in the program."""
        self._feeder.add_rejection(goal.identifier)
        goal.end(Outcome.ABORTED, message)

    def end(self, goals: Iterable[Goal], outcome: Outcome, why: str) -> None:
        """End the live ones among some goals; the message of each is its term and the reason."""
        for goal in goals:
            if goal.live:
                self._feeder.withdraw(goal)
                goal.end(outcome, f"{goal} {why}")

    def resend(self, goals: Iterable[Goal]) -> None:
        """Feed the requests of live goals again, to a program that has forgotten them."""
        for goal in goals:
            if goal.live:
                goal.request_cycle = None
                self._feeder.add_goal(goal)

    def reject_undeclared(self, goals: Iterable[Goal], warnings: Sequence[str]) -> None:
        """Reject the goals whose requests the solver ignored because the program declares no external for them."""
        for goal in goals:
            if is_ignored(request(goal.term, goal.request_cycle or 0), warnings):
                self.end([goal], Outcome.REJECTED, "is unknown to the program: no external is declared for its request")

    # -- admission and deferral

    def plan_found(self, seconds: Optional[float]) -> None:
        """Record a plan for the program's goals, and admit further goals if there is room.

        ``seconds`` is the planning time, None if none of the goals is new.
        """
        self.queue.plan_found(seconds)
        self._admit()

    def take_out(self, goals: Sequence[Goal], published: int) -> None:
        """End cancelled goals that were withdrawn from the program; ``published`` is the last reported cycle."""
        self._withdraw(goals, published)
        for goal in goals:
            goal.end(Outcome.CANCELED, f"{goal} was cancelled before any action was executed for it")
        self.queue.reset_patience()

    def defer(self, goals: Sequence[Goal], why: str, published: int) -> None:
        """Queue goals that were withdrawn from the program; ``published`` is the last reported cycle."""
        self._withdraw(goals, published)
        self.queue.defer(goals)
        self._wait(goals, why)

    def _withdraw(self, goals: Sequence[Goal], published: int) -> None:
        known = requests_of(goal for goal in goals if (goal.request_cycle or 0) <= published + 1)
        self._feeder.add_withdrawals(known)

    def update_accepted(self, goals: Sequence[Goal], heads: Container[Optional[Symbol]]) -> None:
        """Defer the goals whose requests are not among the heads of the accepted update: the solver dropped them.

        A goal that was dropped alone is tried again after the other queued goals. If there are none, the next update
        waits for an arrival, at most for ``PAUSE`` seconds since the last tick.
        """
        left = [goal for goal in goals if goal.live and not any(one in heads for one in requests_of([goal]))]
        if not left:
            return
        others = len(self.queue.served) - len(left)
        if len(left) + others > 1:
            self.queue.limit(others + len(left) // 2)
        else:
            left[0].tries, left[0].overtaken = left[0].tries + 1, 0
        self._wait(left, "the solver did not accept it in time")
        if self.live == left:
            self._feeder.wait(self._now)

    def _wait(self, goals: Sequence[Goal], why: str) -> None:
        for goal in goals:
            goal.waits = True
            self._feeder.withdraw(goal)
            goal.request_cycle = None
        self.report_wait(goals, why)
        self._admit()

    def restore(self, record: Record) -> None:
        """Restore the goals from all rows."""
        super().restore(record)
        for goal in self.live:
            goal.observer = self._changed

    def join(self, goals: Iterable[Goal]) -> None:
        """Feed queued goals, even if there is no room."""
        for goal in goals:
            goal.waits = False
            self._feeder.add_goal(goal)

    def report_wait(self, goals: Iterable[Goal], why: str) -> None:
        """Report why goals wait."""
        for goal in goals:
            self._announce.emit(GoalProgress(self._announce.cycle, goal.key, goal.state, (), waits=why))

    # -- changes of goals

    def _changed(self, goal: Goal, event: GoalEvent) -> None:
        if not goal.live:
            self.queue.end(goal)
            del self._goals[goal.key]
            self._admit()
        self._announce.emit(GoalChanged(self._announce.cycle, goal.key, event, goal.state, goal.outcome, goal.message))

    def _admit(self) -> None:
        """Feed the goals that are admitted now."""
        self.join(self.queue.admit())
