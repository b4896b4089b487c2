"""Recovery behaviours: what the robot tries when it is stuck."""

import math
from typing import List, NamedTuple, Optional

from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.robot.navigation.local_planner import STOP, LocalPlanner, Velocity


class RecoveryStep(NamedTuple):
    """One step of a recovery: what to drive, and whether that was the last."""

    velocity: Velocity = STOP
    done: bool = True


class RecoveryBehavior:
    """What a recovery plugin does: subclasses are named by class path in ``recovery_behaviors``."""

    def __init__(self, name: str, parameters: Optional[dict] = None) -> None:
        self.name = name
        self.parameters = dict(parameters or {})

    def start(self, now: float, pose: Pose2D) -> None:
        """Begin, at a time (s) and pose."""

    def step(self, now: float, pose: Pose2D, costmap: Costmap, follower: LocalPlanner) -> RecoveryStep:
        """Go on; called once a control period until the answer is done."""
        raise NotImplementedError


class ClearCostmap(RecoveryBehavior):
    """Forgets what the laser marked further than ``reset_distance`` m away (0: everything)."""

    def step(self, now: float, pose: Pose2D, costmap: Costmap, follower: LocalPlanner) -> RecoveryStep:
        """Clear at once."""
        costmap.forget(pose.x, pose.y, 0.5 * float(self.parameters.get("reset_distance", 3.0)))
        return RecoveryStep()


class RotateRecovery(RecoveryBehavior):
    """Turns once around on the spot, to look everywhere; gives up after ``patience`` s (default 20)."""

    def __init__(self, name: str, parameters: Optional[dict] = None) -> None:
        super().__init__(name, parameters)
        self._turned, self._yaw, self._since = 0.0, 0.0, 0.0

    def start(self, now: float, pose: Pose2D) -> None:
        """Begin; see :class:`RecoveryBehavior`."""
        self._turned, self._yaw, self._since = 0.0, pose.yaw, now

    def step(self, now: float, pose: Pose2D, costmap: Costmap, follower: LocalPlanner) -> RecoveryStep:
        """Turn on; ends early where turning would touch something."""
        self._turned += abs(normalize_angle(pose.yaw - self._yaw))
        self._yaw = pose.yaw
        rate = float(self.parameters.get("max_vel_theta", 1.0))
        late = now - self._since > float(self.parameters.get("patience", 20.0))
        if late or self._turned >= 2.0 * math.pi - 0.2 or not follower.may_turn(costmap, pose, rate):
            return RecoveryStep()
        return RecoveryStep(Velocity(0.0, rate), False)


def default_recoveries(
    conservative_reset_dist: float = 3.0,
    aggressive_reset_dist: float = 1.84,
    rotation_allowed: bool = True,
    turning: Optional[dict] = None,
) -> List[RecoveryBehavior]:
    """Return move_base's own list: clear far away, turn around, clear nearly everything, turn around.

    ``turning``: the parameters of :class:`RotateRecovery`.
    """
    turns = [RotateRecovery("rotate_recovery", turning)] if rotation_allowed else []
    return [
        ClearCostmap("conservative_reset", {"reset_distance": conservative_reset_dist}),
        *turns,
        ClearCostmap("aggressive_reset", {"reset_distance": aggressive_reset_dist}),
        *turns,
    ]
