"""States, outcomes and settings of navigation."""

import enum
from typing import NamedTuple, Optional

from rosoclingo.robot.navigation.local_planner import STOP, Velocity


class NavigationError(RuntimeError):
    """Call that is invalid in the present state of the navigator."""


class NavigatorState(enum.Enum):
    """States of move_base, and idle."""

    IDLE = "idle"
    PLANNING = "planning"
    CONTROLLING = "controlling"
    CLEARING = "clearing"


class NavigationOutcome(enum.Enum):
    """How a goal ended. The value begins the message of the result, which adds the reason."""

    REACHED = "Goal reached"
    NO_PLAN = "Failed to find a valid plan"
    NO_CONTROL = "Failed to find a valid control"
    OSCILLATING = "Robot is oscillating"
    NO_PROGRESS = "Robot makes no progress"
    LOCALISATION_LOST = "Localisation is lost"
    LASER_LOST = "The laser is lost"


#: Allowed transitions between states.
TRANSITIONS = {
    "idle": ("planning",),
    "planning": ("controlling", "clearing", "idle", "planning"),
    "controlling": ("planning", "clearing", "idle"),
    "clearing": ("planning", "idle"),
}


class NavigatorLimits(NamedTuple):
    """Settings with the names of move_base (s, m, Hz); only ``progress_timeout`` (0: no limit) is an addition.

    ``planner_frequency`` 0: plan only for a new goal and when the path is blocked. ``max_planning_retries`` -1: limited
    only by planner_patience. ``oscillation_timeout`` 0: no limit.
    """

    planner_frequency: float = 1.0
    planner_patience: float = 5.0
    controller_patience: float = 15.0
    max_planning_retries: int = -1
    oscillation_timeout: float = 0.0
    oscillation_distance: float = 0.5
    progress_timeout: float = 60.0
    recovery_behavior_enabled: bool = True


class Result(NamedTuple):
    """Outcome and message of a goal."""

    outcome: NavigationOutcome
    message: str


class Tick(NamedTuple):
    """Result of a control period: the velocity to drive, and the result of the goal once it has ended."""

    velocity: Velocity = STOP
    result: Optional[Result] = None


class FollowerLimits(NamedTuple):
    """Settings of :class:`~rosoclingo.robot.navigation.follower.RolloutFollower` (m, rad, s).

    Names are those of move_base's local planners, with these additions:

    ``lookahead``: distance along the path to the point that it aims at.
    ``margin``: clearance where there is room; with less clearance it drives at most ``creep_vel_x``.
    ``comfort``: clearance up to which more room gives a better score.
    ``turn_gain`` (1/s): slows a turn towards its end.
    """

    max_vel_x: float = 0.65
    max_vel_theta: float = 1.2
    acc_lim_x: float = 1.0
    acc_lim_theta: float = 3.2
    xy_goal_tolerance: float = 0.1
    yaw_goal_tolerance: float = 0.1
    sim_time: float = 1.2
    vx_samples: int = 7
    vtheta_samples: int = 21
    lookahead: float = 0.7
    margin: float = 0.02
    creep_vel_x: float = 0.15
    comfort: float = 0.15
    turn_gain: float = 1.8
