"""What a simulated world is made of."""

import math
from typing import List, NamedTuple, Optional, Tuple, Union

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import OccupancyGrid

Point = Tuple[float, float]


class WorldError(ValueError):
    """A world that cannot be, or a change that it does not allow; the message names the place."""


class LaserSpec(NamedTuple):
    """A planar laser scanner: m, degrees (``angle``: of the whole fan), beams, standard deviation (m), Hz, its pose.

    ``delay``: by so much (s) a scan is older than it says: it is taken from where the robot was then.
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

    ``drift``: the greatest relative error (linear, angular) of its odometry; the error itself comes from the seed.
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
    """A door: the segment that it closes (m)."""

    name: str
    start: Point
    end: Point
    open: bool = True


class Box(NamedTuple):
    """The size (m) of a rectangle and its turn (rad)."""

    width: float
    depth: float
    yaw: float = 0.0


class ObstacleSpec(NamedTuple):
    """A movable obstacle that no map shows: a disc of ``radius`` m, or a ``box``."""

    name: str
    at: Point
    radius: float = 0.0
    box: Optional[Box] = None

    def corners(self) -> List[Point]:
        """Return the corners (m) of its box, none of a disc."""
        if self.box is None:
            return []
        centre, x, y = Pose2D(*self.at, self.box.yaw), self.box.width / 2.0, self.box.depth / 2.0
        return [centre.compose(Pose2D(sx * x, sy * y))[:2] for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]

    def problem(self) -> str:
        """Return in words why there can be no such thing; empty if there can."""
        numbers = (*self.at, self.radius, *(self.box or ()))
        if not all(map(math.isfinite, numbers)):
            return f"its place and size must be finite, are {numbers}"
        if self.radius < 0.0 or (self.radius > 0.0) == (self.box is not None):
            return "an obstacle has either a radius, more than 0, or a box: [width, depth] or [width, depth, yaw]"
        if self.box is not None and min(self.box[:2]) <= 0.0:
            return f"the width and depth of its box must be more than 0, are {self.box[:2]}"
        return ""


class PackageSpec(NamedTuple):
    """A package: its id (text, as in a term) and where it is (a label's name, or x, y in m)."""

    id: str
    at: Union[str, Point]


class WorldSpec(NamedTuple):
    """A whole world. ``interval`` is the length of a step in s, ``map_file`` names the map's YAML file, if any."""

    grid: OccupancyGrid
    robots: Tuple[RobotSpec, ...]
    doors: Tuple[DoorSpec, ...] = ()
    obstacles: Tuple[ObstacleSpec, ...] = ()
    packages: Tuple[PackageSpec, ...] = ()
    interval: float = 0.1
    seed: int = 0
    map_file: str = ""
