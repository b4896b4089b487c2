"""States, outcomes and settings of driving to a goal."""

import enum
from typing import NamedTuple, Optional

from rosoclingo.robot.navigation.local_planner import STOP, Velocity


class NavigationError(RuntimeError):
    """A call that the navigator's state does not allow."""


class NavigatorState(enum.Enum):
    """move_base's states, and idle."""

    IDLE = "idle"
    PLANNING = "planning"
    CONTROLLING = "controlling"
    CLEARING = "clearing"


class NavigationOutcome(enum.Enum):
    """How a goal ended; the message of the result says why."""

    REACHED = 0
    NO_PLAN = 1
    NO_CONTROL = 2
    OSCILLATING = 3
    LOCALISATION_LOST = 4
    LASER_LOST = 5
    NO_PROGRESS = 6


class Trigger(enum.Enum):
    """Why the robot recovers: the outcome if it cannot, and the words of move_base."""

    PLANNING = (NavigationOutcome.NO_PLAN, "Failed to find a valid plan.")
    CONTROLLING = (NavigationOutcome.NO_CONTROL, "Failed to find a valid control.")
    OSCILLATION = (NavigationOutcome.OSCILLATING, "Robot is oscillating.")
    STUCK = (NavigationOutcome.NO_PROGRESS, "Robot makes no progress.")


#: The states that can follow each state, by their values.
TRANSITIONS = {
    "idle": ("planning",),
    "planning": ("controlling", "clearing", "idle", "planning"),
    "controlling": ("planning", "clearing", "idle"),
    "clearing": ("planning", "idle"),
}


class NavigatorLimits(NamedTuple):
    """Settings, named as move_base names them (s, m, Hz); ``progress_timeout`` (0: never) is this navigator's own.

    ``planner_frequency`` 0: plan for a new goal and when the way is blocked only. ``max_planning_retries`` -1: as
    many as planner_patience allows. ``oscillation_timeout`` 0: never.
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
    """The end of a goal."""

    outcome: NavigationOutcome
    message: str


class Tick(NamedTuple):
    """What one control period gives: the velocity to drive, and the result once the goal has ended."""

    velocity: Velocity = STOP
    result: Optional[Result] = None


class FollowerLimits(NamedTuple):
    """Settings of :class:`~rosoclingo.robot.navigation.follower.RolloutFollower` (m, rad, s).

    Named as move_base's local planners name theirs.

    Its own: ``lookahead``, how far ahead on the path it aims; ``margin``, what it keeps free beside the robot where
    there is room, at ``creep_vel_x`` and slower where there is not; ``comfort``, up to where more room counts as
    better; ``turn_gain`` (1/s), by which it turns slower towards the end of a turn.
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
