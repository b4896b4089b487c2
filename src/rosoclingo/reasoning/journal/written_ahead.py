"""What a journal says ahead: the actions that go out next if all goes as planned, which its plan holds already."""

from typing import Optional, Sequence

from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.events import (
    ActionsDispatched,
    Event,
    FactTaken,
    GoalProgress,
    PlanMade,
    ReturnTaken,
    StateChanged,
    UpdateSent,
)
from rosoclingo.reasoning.keywords import success_of

#: What is told together with actions, and follows from the plan as they do.
FOLLOWING = (ActionsDispatched, UpdateSent, PlanMade, StateChanged, GoalProgress)


class WrittenAhead:
    """Knows which actions may go out before the disk has that they do, as it has a plan that goes on with them.

    Should the machine lose what the disk did not have yet, the core that goes on from that plan has these actions go
    out again, with the same cycles, and whoever has begun them knows them.
    """

    def __init__(self) -> None:
        self._plan = TaskPlan()
        self._as_planned = True  # since the last actions went out

    def on_disk(self, plan: Optional[TaskPlan]) -> None:
        """The disk has this plan, or none that could be relied on."""
        self._plan = plan or TaskPlan()

    def covers(self, events: Sequence[Event], plan: TaskPlan) -> bool:
        """Take what was told; whether actions are among it that what the disk has says, and it goes on as ``plan``."""
        covered = False
        for one in events:
            if isinstance(one, ReturnTaken):
                self._as_planned &= any(success_of(action) == one.atom for action in self._plan.at(one.cycle))
            elif isinstance(one, FactTaken):
                self._as_planned = False
            elif isinstance(one, ActionsDispatched):
                same = self._plan.at(one.cycle) == one.actions and self._plan.after(one.cycle) == plan.after(one.cycle)
                covered, self._as_planned = same and self._as_planned, True
        return covered
