"""Specification of a simulated world."""

import math
from typing import List, NamedTuple, Optional, Tuple

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OccupancyGrid

Point = Tuple[float, float]


class WorldError(ValueError):
    """Invalid world, or invalid change of a world. The message names the place."""


class LaserSpec(NamedTuple):
    """A planar laser scanner: m, degrees (``angle``: field of view), beams, standard deviation (m), Hz, pose.

    ``delay`` (s): age of a scan at its stamp; the scan is taken from the pose of the robot at that time.
    """

    range: float = 8.0
    angle: float = 270.0
    beams: int = 270
    noise: float = 0.0
    rate: float = 10.0
    pose: Pose2D = Pose2D(0.05, 0.0, 0.0)
    min_range: float = 0.0
    delay: float = 0.0


class RobotSpec(NamedTuple):
    """A differential-drive robot: a disc of ``radius`` (m) or a ``footprint`` polygon; limits in m, rad, s.

    ``drift``: maximum relative errors (linear, angular) of the odometry. The seed determines the actual errors.
    """

    name: str = "robot_0"
    pose: Pose2D = Pose2D(0.0, 0.0, 0.0)
    radius: float = 0.18
    footprint: Tuple[Point, ...] = ()
    max_speed: float = 0.65
    max_turn: float = 3.14
    acceleration: float = 2.5
    turn_acceleration: float = 6.0
    lasers: Tuple[LaserSpec, ...] = (LaserSpec(),)
    drift: Tuple[float, float] = (0.0, 0.0)


class DoorSpec(NamedTuple):
    """A door, which closes a segment (m)."""

    name: str
    start: Point
    end: Point
    open: bool = True


class Box(NamedTuple):
    """A rectangle: its size (m) and its rotation (rad)."""

    width: float
    depth: float
    yaw: float = 0.0


class ObstacleSpec(NamedTuple):
    """A movable obstacle that is not on the map: a disc of ``radius`` m, or a ``box``."""

    name: str
    at: Point
    radius: float = 0.0
    box: Optional[Box] = None

    def corners(self) -> List[Point]:
        """Return the corners (m) of a box; empty for a disc."""
        if self.box is None:
            return []
        centre, x, y = Pose2D(*self.at, self.box.yaw), self.box.width / 2.0, self.box.depth / 2.0
        return [centre.compose(Pose2D(sx * x, sy * y))[:2] for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]

    def problem(self) -> str:
        """Return why the obstacle is invalid; empty if it is valid."""
        numbers = (*self.at, self.radius, *(self.box or ()))
        if not all(map(math.isfinite, numbers)):
            return f"its position and size must be finite, not {numbers}"
        if self.radius < 0.0 or (self.radius > 0.0) == (self.box is not None):
            return "an obstacle has either a positive radius or a box: [width, depth] or [width, depth, yaw]"
        if self.box is not None and min(self.box[:2]) <= 0.0:
            return f"the width and depth of its box must be positive, not {self.box[:2]}"
        return ""


class WorldSpec(NamedTuple):
    """A world. ``interval``: length of a step (s). ``map_file``: YAML file of the map, if any."""

    grid: OccupancyGrid
    robots: Tuple[RobotSpec, ...]
    doors: Tuple[DoorSpec, ...] = ()
    obstacles: Tuple[ObstacleSpec, ...] = ()
    interval: float = 0.1
    seed: int = 0
    map_file: str = ""
