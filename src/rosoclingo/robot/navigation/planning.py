"""Planning for a navigator, either synchronously or in another thread."""

from typing import Optional

import numpy as np

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


def cut_start(points: np.ndarray, pose: Pose2D, moved: float) -> np.ndarray:
    """Return the rest of a path (n, 2; m) from the point nearest to a robot that has moved by ``moved`` m.

    The search is limited to the part of the path that the robot can have covered.
    """
    if len(points) < 3 or moved <= 0.0:
        return points
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    near = points[along <= 2.0 * moved][:-1] if along[-1] <= 2.0 * moved else points[along <= 2.0 * moved]
    return points[int(np.hypot(*(near - (pose.x, pose.y)).T).argmin()) :]
