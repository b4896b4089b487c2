"""Who plans for a navigator: at once, or beside all else while the robot is driven on."""

from typing import Optional

import numpy as np

from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid_planner import GlobalPlan, GlobalPlanner


class Planning:
    """Has a planner plan at once; subclasses do it elsewhere, and answer when it is done."""

    def __init__(self, planner: GlobalPlanner) -> None:
        self.planner = planner
        self._plan: Optional[GlobalPlan] = None

    def ask(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> None:
        """Ask for a plan; what was asked for before is not wanted any more."""
        self._plan = self.planner.plan(costmap, start, goal)

    def answer(self) -> Optional[GlobalPlan]:
        """Return the plan that was asked for, None while it is not there; raises what the planner has raised."""
        plan, self._plan = self._plan, None
        return plan

    def drop(self) -> None:
        """Want no plan any more."""
        self._plan = None


def from_here(points: np.ndarray, pose: Pose2D, moved: float) -> np.ndarray:
    """Return what is left of a path (n, 2; m) for a robot that has moved (m) since its start: from where it is nearest.

    It is looked for as far along the path as the robot can have come.
    """
    if len(points) < 3 or moved <= 0.0:
        return points
    along = np.append(0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T)))
    near = points[along <= 2.0 * moved][:-1] if along[-1] <= 2.0 * moved else points[along <= 2.0 * moved]
    return points[int(np.hypot(*(near - (pose.x, pose.y)).T).argmin()) :]
