"""Planning for a navigator, either synchronously or in another thread."""

from typing import Optional

from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid_planner import GlobalPlan, GlobalPlanner


class Planning:
    """Calls a global planner synchronously. Subclasses can run it in the background."""

    def __init__(self, planner: GlobalPlanner) -> None:
        self.planner = planner
        self._plan: Optional[GlobalPlan] = None

    def ask(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> None:
        """Request a plan. This replaces any previous request."""
        self._plan = self.planner.plan(costmap, start, goal)

    def answer(self) -> Optional[GlobalPlan]:
        """Return the requested plan, None while it is pending. Raises the exception of the planner."""
        plan, self._plan = self._plan, None
        return plan

    def drop(self) -> None:
        """Cancel the request."""
        self._plan = None
