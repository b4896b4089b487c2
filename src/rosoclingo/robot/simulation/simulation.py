"""The simulated world in motion."""

import math
from typing import Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.simulation.compiled.shapes import (
    CLEAR,
    HIT_DISC,
    HIT_SEGMENT,
    HIT_WALL,
    body_hits,
    covers_wall,
    inside,
)
from rosoclingo.robot.simulation.simulated_robot import Robot, Surroundings
from rosoclingo.robot.simulation.spec import Box, DoorSpec, ObstacleSpec, RobotSpec, WorldError, WorldSpec
from rosoclingo.robot.simulation.world_file import load_world

__all__ = ["Collision", "Simulation", "load_simulation"]

Segment = Tuple[float, float, float, float]

# Who touches something stands free of it: a pose that was reached by driving must not be refused by rounding.
TOUCH = 1e-9
HITS = {HIT_WALL: "a wall", HIT_SEGMENT: "a door, a box or a robot's side", HIT_DISC: "an obstacle or a robot"}


class Collision(NamedTuple):
    """A robot has run into something: at a time (s), from its pose (m) at a standstill, and what it was."""

    robot: str
    time: float
    pose: Pose2D
    what: str


class Simulation:
    """A world made from its spec. All that happens in it follows from the spec, its seed and the calls made.

    ``watchdog``: a robot that no command has reached for that long (s of simulated time) stops; 0: it never does.
    """

    def __init__(self, spec: WorldSpec, watchdog: float = 0.2) -> None:
        self.spec = spec
        self.watchdog = watchdog
        self.steps = 0
        self._occupied = spec.grid.occupied()
        self._scale = spec.grid.resolution
        self._origin = (spec.grid.origin_x, spec.grid.origin_y)
        self.doors: Dict[str, DoorSpec] = {door.name: door for door in spec.doors}
        self.obstacles: Dict[str, ObstacleSpec] = {obstacle.name: obstacle for obstacle in spec.obstacles}
        self.robots: Dict[str, Robot] = {
            robot.name: Robot(robot, spec.seed + 1000 * i) for i, robot in enumerate(spec.robots)
        }
        self._outlines = {
            name: np.array(robot.outline, dtype=np.float64).reshape(-1, 2) / self._scale
            for name, robot in self.robots.items()
        }
        self._build()
        for name in self.robots:
            self._check_place(name, self.robots[name].pose)

    @property
    def time(self) -> float:
        """Simulated time in s."""
        return self.steps * self.spec.interval

    def command(self, robot: str, v: float, w: float) -> None:
        """Give a robot a velocity (m/s, rad/s)."""
        self._robot(robot).command(v, w, self.time)

    def step(self) -> List[Collision]:
        """Go on by one interval; return the collisions that began in it."""
        now, dt = self.time, self.spec.interval
        self.steps += 1
        collisions = []
        for name, robot in self.robots.items():
            robot.accelerate(now, dt, self.watchdog)
            stalled = robot.stalled
            hit = robot.move(dt, self._around(name), self._outlines[name], self._origin, self._scale)
            if hit != CLEAR and not stalled:
                collisions.append(Collision(name, self.time, robot.pose, HITS[hit]))
        return collisions

    def scan(self, robot: str, laser: int = 0) -> np.ndarray:
        """Return the ranges (float32, m) of one of a robot's lasers now. Raises WorldError for one that it lacks."""
        lasers = self._robot(robot).lasers
        if not 0 <= laser < len(lasers):
            raise WorldError(f"robot {robot!r} has no laser {laser}; it has {len(lasers)}")
        place = self._robot(robot).seen_from(laser, self.spec.interval)
        return lasers[laser].scan(self._in_cells(place), self._around(robot), self._scale)

    def reset(self) -> None:
        """Put every robot back to its start, as stage_ros's reset_positions does; time, doors, obstacles stay.

        Raises WorldError where something stands at a start; then nothing has moved.
        """
        before = {name: robot.pose for name, robot in self.robots.items()}
        for robot in self.robots.values():
            robot.pose = robot.spec.pose
        try:
            for name, robot in self.robots.items():
                self._check_place(name, robot.pose)
        except WorldError:
            for name, robot in self.robots.items():
                robot.pose = before[name]
            raise
        for robot in self.robots.values():
            robot.reset()

    def place(self, robot: str, pose: Pose2D) -> None:
        """Carry a robot to a pose (m). Raises WorldError where it would stand in something."""
        self._check_place(robot, pose)
        self._robot(robot).place(pose)

    def arrange(
        self, robots: Mapping[str, Tuple[Pose2D, Pose2D]], doors: Mapping[str, bool], obstacles: Dict[str, ObstacleSpec]
    ) -> None:
        """Put robots (pose and odometry, m), doors and obstacles where they were, all at once.

        Raises WorldError where a robot would stand in something, or an obstacle cannot be; then part of it is done.
        """
        for obstacle in obstacles.values():
            self._check_obstacle(obstacle)
        self.doors = {name: door._replace(open=doors[name]) for name, door in self.doors.items()}
        self.obstacles = dict(obstacles)
        for name, (pose, odometry) in robots.items():
            self.robots[name].place(pose)
            self.robots[name].odometry = odometry
        self._build()
        for name, robot in self.robots.items():
            self._check_place(name, robot.pose)

    def set_door(self, door: str, opened: bool) -> None:
        """Open or close a door. Raises WorldError for an unknown one, and where a robot stands in it."""
        if door not in self.doors:
            raise WorldError("door {!r} is unknown; doors: {}".format(door, ", ".join(self.doors) or "none"))
        before = dict(self.doors)
        self.doors[door] = self.doors[door]._replace(open=opened)
        self._build_or_undo("doors", before, f"the door {door!r}")

    def put_obstacle(self, obstacle: ObstacleSpec) -> None:
        """Put an obstacle into the world, or move the one of that name.

        Raises WorldError where a robot stands, and for one that has no place or no size.
        """
        self._check_obstacle(obstacle)
        before = dict(self.obstacles)
        self.obstacles[obstacle.name] = obstacle
        self._build_or_undo("obstacles", before, f"the obstacle {obstacle.name!r}")

    def remove_obstacle(self, name: str) -> None:
        """Take an obstacle away. Raises WorldError for an unknown one."""
        if name not in self.obstacles:
            known = ", ".join(self.obstacles) or "none"
            raise WorldError(f"obstacle {name!r} is unknown; obstacles: {known}")
        del self.obstacles[name]
        self._build()

    def _check_obstacle(self, obstacle: ObstacleSpec) -> None:
        problem = obstacle.problem() or self.spec.grid.beyond(*obstacle.at)
        if problem:
            raise WorldError(f"the obstacle {obstacle.name!r}: {problem}")

    def _robot(self, name: str) -> Robot:
        if name not in self.robots:
            raise WorldError("robot {!r} is unknown; robots: {}".format(name, ", ".join(self.robots)))
        return self.robots[name]

    def _build_or_undo(self, attribute: str, before: Dict, what: str) -> None:
        """Rebuild the world after a change; take it back and raise WorldError when a robot stands in the way."""
        self._build()
        for name, robot in self.robots.items():
            if self._hits(name, robot.pose) != CLEAR:
                setattr(self, attribute, before)
                self._build()
                raise WorldError(f"{what} would stand where robot {name!r} is")

    def _build(self) -> None:
        """Gather segments and discs of closed doors and obstacles, in cells."""
        segments = [(*door.start, *door.end) for door in self.doors.values() if not door.open]
        discs = []
        for obstacle in self.obstacles.values():
            if obstacle.box is None:
                discs.append((*obstacle.at, obstacle.radius))
            else:
                segments.extend(_edges(_corners(obstacle.at, obstacle.box)))
        self._segments = self._segments_in_cells(segments)
        self._discs = np.array(
            [(*self._point(x, y), radius / self._scale) for x, y, radius in discs], dtype=np.float64
        ).reshape(-1, 3)

    def _around(self, robot: str) -> Surroundings:
        """Return what one robot can hit: the world and the other robots."""
        segments, discs = self._segments, self._discs
        if len(self.robots) > 1:
            others = [other for name, other in self.robots.items() if name != robot]
            round_ones = [other for other in others if not other.outline]
            edges = [edge for other in others if other.outline for edge in _edges(_outline(other))]
            bodies = [
                (*self._point(other.pose.x, other.pose.y), other.spec.radius / self._scale) for other in round_ones
            ]
            discs = np.concatenate((discs, np.array(bodies, dtype=np.float64).reshape(-1, 3)))
            segments = np.concatenate((segments, self._segments_in_cells(edges)))
        return Surroundings(self._occupied, segments, discs)

    def _hits(self, robot: str, pose: Pose2D) -> int:
        """Tell what a robot would stand in; who is swallowed whole touches no edge, and is in it nevertheless."""
        around, cells, outline = self._around(robot), self._in_cells(pose), self._outlines[robot] * (1.0 - TOUCH)
        hit = body_hits(
            around.occupied, around.segments, around.discs, outline,
            self._robot(robot).spec.radius / self._scale * (1.0 - TOUCH), cells.x, cells.y, cells.yaw,
        )  # fmt: skip
        if hit == CLEAR and len(outline) and covers_wall(self._occupied, outline, *cells):
            return HIT_WALL
        point = pose.compose(Pose2D(*self._robot(robot).outline[0])) if len(outline) else pose
        if hit == CLEAR and any(inside(np.array(solid), point.x, point.y) for solid in self._solids(robot)):
            return HIT_SEGMENT
        return int(hit)

    def _solids(self, robot: str) -> List[List[Tuple[float, float]]]:
        """Return the corners (m) of all that has sides and an inside: boxes, and other robots' footprints."""
        boxes = [_corners(obstacle.at, obstacle.box) for obstacle in self.obstacles.values() if obstacle.box]
        return boxes + [_outline(other) for name, other in self.robots.items() if name != robot and other.outline]

    def _check_place(self, robot: str, pose: Pose2D) -> None:
        if not all(map(math.isfinite, pose)):
            raise WorldError(f"robot {robot!r}: a pose must be finite, is {tuple(pose)}")
        self._robot(robot)
        beyond = self.spec.grid.beyond(pose.x, pose.y)
        if beyond:
            raise WorldError(f"robot {robot!r}: {beyond}")
        hit = self._hits(robot, pose)
        if hit != CLEAR:
            place = f"({pose.x:.2f}, {pose.y:.2f})"
            raise WorldError(f"robot {robot!r} would stand in {HITS[hit]} at {place}")

    def _point(self, x: float, y: float) -> Tuple[float, float]:
        return (x - self._origin[0]) / self._scale, (y - self._origin[1]) / self._scale

    def _in_cells(self, pose: Pose2D) -> Pose2D:
        return Pose2D(*self._point(pose.x, pose.y), pose.yaw)

    def _segments_in_cells(self, segments: Sequence[Segment]) -> np.ndarray:
        cells = [self._point(s[0], s[1]) + self._point(s[2], s[3]) for s in segments]
        return np.array(cells, dtype=np.float64).reshape(-1, 4)


def load_simulation(path: str, map_file: str = "", watchdog: float = 0.2, delay: Optional[float] = None) -> Simulation:
    """Return the simulation of a world file, whose robots stand free. Raises WorldError, which names file and place.

    ``delay``: that of all lasers (s), in place of what the file says.
    """
    spec = load_world(path, map_file)
    if delay is not None:
        spec = spec._replace(robots=tuple(_late(robot, delay) for robot in spec.robots))
    try:
        return Simulation(spec, watchdog)
    except WorldError as error:
        raise WorldError(f"world {path}: robots: {error}; change its pose, or what is there") from error


def _late(robot: RobotSpec, delay: float) -> RobotSpec:
    return robot._replace(lasers=tuple(laser._replace(delay=delay) for laser in robot.lasers))


def _corners(at: Tuple[float, float], box: Box) -> List[Tuple[float, float]]:
    """Return the corners (m) of a rectangle around a point."""
    centre = Pose2D(at[0], at[1], box.yaw)
    x, y = box.width / 2.0, box.depth / 2.0
    return [centre.compose(Pose2D(sx * x, sy * y))[:2] for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]


def _outline(robot: Robot) -> List[Tuple[float, float]]:
    """Return the corners (m) of a robot's footprint where it stands."""
    return [robot.pose.compose(Pose2D(x, y))[:2] for x, y in robot.outline]


def _edges(corners: List[Tuple[float, float]]) -> List[Segment]:
    return [(*a, *b) for a, b in zip(corners, corners[1:] + corners[:1])]
