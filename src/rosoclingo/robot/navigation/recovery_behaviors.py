"""Recovery behaviours for a robot that is stuck."""

import math
from typing import List, NamedTuple, Optional

from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.robot.navigation.local_planner import STOP, LocalPlanner, Velocity


class RecoveryStep(NamedTuple):
    """One step of a recovery behaviour: the velocity, and whether the behaviour is done."""

    velocity: Velocity = STOP
    done: bool = True


class RecoveryBehavior:
    """Base class of recovery plugins, which ``recovery_behaviors`` names by class path."""

    def __init__(self, name: str, parameters: Optional[dict] = None) -> None:
        self.name = name
        self.parameters = dict(parameters or {})

    def start(self, now: float, pose: Pose2D) -> None:
        """Start at a time (s) and pose."""

    def step(self, now: float, pose: Pose2D, costmap: Costmap, follower: LocalPlanner) -> RecoveryStep:
        """Return the next step. Called once per control period until it is done."""
        raise NotImplementedError


class ClearCostmap(RecoveryBehavior):
    """Clears marks outside a square of edge ``reset_distance`` (m) around the robot; 0 clears all marks."""

    def step(self, now: float, pose: Pose2D, costmap: Costmap, follower: LocalPlanner) -> RecoveryStep:
        """Clear the costmap; done after one step."""
        costmap.forget(pose.x, pose.y, 0.5 * float(self.parameters.get("reset_distance", 3.0)))
        return RecoveryStep()


class RotateRecovery(RecoveryBehavior):
    """Turns once on the spot to look around. Ends after ``patience`` s (default 20) in any case."""

    def __init__(self, name: str, parameters: Optional[dict] = None) -> None:
        super().__init__(name, parameters)
        self._turned, self._yaw, self._since = 0.0, 0.0, 0.0

    def start(self, now: float, pose: Pose2D) -> None:
        """Start; see :class:`RecoveryBehavior`."""
        self._turned, self._yaw, self._since = 0.0, pose.yaw, now

    def step(self, now: float, pose: Pose2D, costmap: Costmap, follower: LocalPlanner) -> RecoveryStep:
        """Continue the turn. Ends early if the robot would touch an obstacle."""
        self._turned += abs(normalize_angle(pose.yaw - self._yaw))
        self._yaw = pose.yaw
        rate = float(self.parameters.get("max_vel_theta", 1.0))
        late = now - self._since > float(self.parameters.get("patience", 20.0))
        if late or self._turned >= 2.0 * math.pi - 0.2 or not follower.can_turn(costmap, pose, rate):
            return RecoveryStep()
        return RecoveryStep(Velocity(0.0, rate), False)


def default_recoveries(
    conservative_reset_dist: float = 3.0,
    aggressive_reset_dist: float = 1.84,
    rotation_allowed: bool = True,
    turning: Optional[dict] = None,
) -> List[RecoveryBehavior]:
    """Return the default list of move_base: clear far away, rotate, clear nearby, rotate.

    ``turning``: parameters of :class:`RotateRecovery`.
    """
    turns = [RotateRecovery("rotate_recovery", turning)] if rotation_allowed else []
    return [
        ClearCostmap("conservative_reset", {"reset_distance": conservative_reset_dist}),
        *turns,
        ClearCostmap("aggressive_reset", {"reset_distance": aggressive_reset_dist}),
        *turns,
    ]
