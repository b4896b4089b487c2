"""Clients' goals: checked on arrival, kept while they live, passed to the feeder as requests, ended with a reason."""

from typing import Callable, Iterable, List, Sequence

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.events import Event, GoalChanged, GoalRefused
from rosoclingo.reasoning.goals import Goal, GoalBook, GoalError, GoalEvent, Outcome, read_goal
from rosoclingo.reasoning.input_feeder import InputFeeder
from rosoclingo.reasoning.keywords import REQUEST, request


class GoalManager:
    """The goals of all clients. ``tell`` hears of each change, ``cycle`` gives the logical time point.

    At most ``at_once`` goals (0: any number) are with the program at a time; further ones wait for their turn.
    """

    def __init__(
        self,
        program: ReactiveProgram,
        feeder: InputFeeder,
        tell: Callable[[Event], None],
        cycle: Callable[[], int],
        at_once: int = 0,
    ) -> None:
        self._program = program
        self._feeder = feeder
        self._tell = tell
        self._cycle = cycle
        self._book = GoalBook()
        self._at_once = at_once
        self._waiting: List[Goal] = []

    @property
    def live(self) -> List[Goal]:
        """The goals that have not ended, oldest first."""
        return self._book.live

    @property
    def fed(self) -> List[Goal]:
        """The live goals that the program knows, oldest first."""
        return self._book.fed

    def add(self, key: str, text: str) -> None:
        """Take the goal ``text``; a goal that cannot be taken is rejected with the reason."""
        try:
            goal = Goal(key, read_goal(text), self._changed)
            if not self._program.declares_external(REQUEST, 2):
                raise GoalError("the program takes no requests: it declares no external _request/2")
            self._book.add(goal)
        except GoalError as error:
            self._tell(GoalRefused(self._cycle(), key, text, str(error)))
        else:
            self._waiting.append(goal)
            self._admit()

    def cancel(self, key: str) -> None:
        """Cancel a goal; without effect on one that has ended or is being cancelled."""
        goal = self._book.by_key(key)
        if goal is None or goal.cancelling:
            return
        goal.apply(GoalEvent.CANCEL_REQUEST)
        if goal.fed:
            self._feeder.add_cancellation(goal.identifier)
        else:
            self._withdraw(goal)
            goal.end(Outcome.CANCELED, f"{goal} is cancelled before it was planned for")

    def drop(self, goals: Sequence[Goal], why: str) -> None:
        """Abort goals that the program knows, and send it their cancellations."""
        for goal in goals:
            self._feeder.add_cancellation(goal.identifier)
        self.end(goals, Outcome.ABORTED, why)

    def end(self, goals: Iterable[Goal], outcome: Outcome, why: str) -> None:
        """End those of the goals that have not ended, each with its term and the reason as its message."""
        for goal in goals:
            if goal.live:
                self._withdraw(goal)
                goal.end(outcome, f"{goal} {why}")

    def again(self, goals: Iterable[Goal]) -> None:
        """Send the requests of the goals that have not ended once more, to a program that has forgotten them."""
        for goal in goals:
            if goal.live:
                goal.forget()
                self._feeder.add_goal(goal)

    def reject_undeclared(self, goals: Iterable[Goal], warnings: Sequence[str]) -> None:
        """End the goals whose requests the solver ignored because the program declares no external for them."""
        for goal in goals:
            head = f"Head {request(goal.term, goal.request_cycle or 0)} has not been declared"
            if any(head in warning for warning in warnings):
                self.end([goal], Outcome.REJECTED, "is unknown to the program: no external is declared for its request")

    def _changed(self, goal: Goal, event: GoalEvent) -> None:
        if not goal.live:
            self._book.remove(goal)
            self._admit()
        self._tell(GoalChanged(self._cycle(), goal.key, goal.term, event, goal.state, goal.outcome, goal.message))

    def _admit(self) -> None:
        """Let goals in that wait, as long as there is room."""
        while self._waiting and not 0 < self._at_once <= len(self._book.live) - len(self._waiting):
            self._feeder.add_goal(self._waiting.pop(0))

    def _withdraw(self, goal: Goal) -> None:
        """Let a goal that the program has not been told of wait no longer."""
        self._waiting = [other for other in self._waiting if other is not goal]
        self._feeder.withdraw(goal)
