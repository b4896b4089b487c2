"""Simulation of a world: robots, doors and obstacles."""

import math
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import numpy as np

from rosoclingo.common.reading import Reader
from rosoclingo.robot.navigation.compiled.outlines import gap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.simulation.compiled.shapes import CLEAR, HIT_DISC, HIT_SEGMENT, HIT_WALL, body_hits
from rosoclingo.robot.simulation.simulated_robot import Robot, Surroundings
from rosoclingo.robot.simulation.spec import Box, DoorSpec, ObstacleSpec, Point, WorldError, WorldSpec
from rosoclingo.robot.simulation.world_file import load_world

# Relative tolerance of contacts, so that rounding does not turn a pose reached by driving into a collision.
CONTACT_TOLERANCE = 1e-9
HITS = {HIT_WALL: "a wall", HIT_SEGMENT: "a door, a box or a robot's side", HIT_DISC: "an obstacle or a robot"}


class Collision(NamedTuple):
    """Collision of a robot: the time (s), the pose (m) at which it stopped, and the obstacle."""

    robot: str
    time: float
    pose: Pose2D
    what: str


class Simulation:
    """A simulated world. Its course is determined by the spec, its seed and the calls.

    ``watchdog``: simulated seconds without a command after which a robot stops; 0: no limit.
    """

    def __init__(self, spec: WorldSpec, watchdog: float = 0.2) -> None:
        self.spec = spec
        self.watchdog = watchdog
        self.steps = 0
        self._occupied, self._scale = spec.grid.occupied(), spec.grid.resolution
        self.robots = {robot.name: Robot(robot, spec.seed + 1000 * i) for i, robot in enumerate(spec.robots)}
        self._outlines = {
            name: np.array(robot.outline, dtype=np.float64).reshape(-1, 2) / self._scale
            for name, robot in self.robots.items()
        }
        self._build({}, {door.name: door for door in spec.doors}, {one.name: one for one in spec.obstacles})
        self._check()

    @property
    def time(self) -> float:
        """Simulated time (s)."""
        return self.steps * self.spec.interval

    def command(self, robot: str, v: float, w: float) -> None:
        """Set the desired velocity (m/s, rad/s) of a robot."""
        self._robot(robot).command(v, w, self.time)

    def step(self) -> List[Collision]:
        """Advance by one interval. Return the collisions that began in it."""
        now, dt = self.time, self.spec.interval
        self.steps += 1
        collisions = []
        for name, robot in self.robots.items():
            robot.accelerate(now, dt, self.watchdog)
            stalled = robot.stalled
            hit = robot.move(
                dt, self._surroundings(name), self._outlines[name], self._in_cells(robot.pose), self._scale
            )
            if hit != CLEAR and not stalled:
                collisions.append(Collision(name, self.time, robot.pose, HITS[hit]))
        return collisions

    def scan(self, robot: str, laser: int = 0) -> np.ndarray:
        """Return the present ranges (float32, m) of a robot's laser. Raises WorldError if there is no such laser."""
        lasers = self._robot(robot).lasers
        if not 0 <= laser < len(lasers):
            raise WorldError(f"robot {robot!r} has no laser {laser}; it has {len(lasers)}")
        pose = self._robot(robot).scan_pose(laser, self.spec.interval)
        return lasers[laser].scan(self._in_cells(pose), self._surroundings(robot), self._scale)

    def reset(self) -> None:
        """Return all robots to their initial poses. Time, doors and obstacles stay, as with stage_ros.

        Raises WorldError if an initial pose is occupied; then no robot moves.
        """
        self._change({name: robot.spec.pose for name, robot in self.robots.items()}, self.doors, self.obstacles)
        for robot in self.robots.values():
            robot.reset()

    def place(self, robot: str, pose: Pose2D) -> None:
        """Move a robot to a pose (m). Raises WorldError if it would be in collision there."""
        placed = self._robot(robot)
        self._change({robot: pose}, self.doors, self.obstacles)
        placed.place(pose)

    def state(self) -> Dict[str, Any]:
        """Return the present state as plain values (m, rad), from which a new process can resume after a crash.

        ``robots`` contains pose and odometry (x, y, yaw each), ``doors`` whether they are open, ``obstacles`` x, y and
        a radius, or x, y, width, depth and yaw. Time and velocities are not included.
        """
        sizes = {name: one.at + (one.box or (one.radius,)) for name, one in self.obstacles.items()}
        return {
            "robots": {name: [*map(float, robot.pose + robot.odometry)] for name, robot in self.robots.items()},
            "doors": {name: door.open for name, door in self.doors.items()},
            "obstacles": {name: [*map(float, size)] for name, size in sizes.items()},
        }

    def resume(self, kept: Reader) -> None:
        """Restore a state, with robots at rest.

        Raises WorldError if the state does not fit this world, which then stays as it is.
        """
        wanted = "x, y, yaw of the robot, and x, y, yaw of its odometry"
        robots = {name: item.numbers((6,), wanted=wanted) for name, item in kept.at("robots").entries()}
        doors = {name: item.flag() for name, item in kept.at("doors").entries()}
        wanted = "x, y and a radius, or x, y, width, depth and yaw"
        sizes = {name: item.numbers((3, 5), wanted=wanted) for name, item in kept.at("obstacles").entries()}
        kept.check(WorldError)
        for known, found, what in ((self.robots, robots, "robots"), (self.doors, doors, "doors")):
            if known.keys() != found.keys():
                raise WorldError("the {} are {}, not {}".format(what, ", ".join(known), ", ".join(found)))
        self._change(
            {name: Pose2D(*numbers[:3]) for name, numbers in robots.items()},
            {name: door._replace(open=doors[name]) for name, door in self.doors.items()},
            {name: _obstacle(name, *numbers) for name, numbers in sizes.items()},
        )
        for name, robot in self.robots.items():
            robot.place(robot.pose)
            robot.odometry = Pose2D(*robots[name][3:])

    def set_door(self, door: str, opened: bool) -> None:
        """Open or close a door. Raises WorldError if it is unknown or a robot stands in it."""
        if door not in self.doors:
            raise WorldError("unknown door {!r}; doors: {}".format(door, ", ".join(self.doors) or "none"))
        doors = {**self.doors, door: self.doors[door]._replace(open=opened)}
        self._change({}, doors, self.obstacles)

    def put_obstacle(self, obstacle: ObstacleSpec) -> None:
        """Add an obstacle, or move the one of that name.

        Raises WorldError if a robot stands there, or if position or size are invalid.
        """
        self._change({}, self.doors, {**self.obstacles, obstacle.name: obstacle})

    def remove_obstacle(self, name: str) -> None:
        """Remove an obstacle. Raises WorldError if it is unknown."""
        if name not in self.obstacles:
            known = ", ".join(self.obstacles) or "none"
            raise WorldError(f"unknown obstacle {name!r}; obstacles: {known}")
        self._build({}, self.doors, {other: one for other, one in self.obstacles.items() if other != name})

    def _change(
        self, poses: Mapping[str, Pose2D], doors: Dict[str, DoorSpec], obstacles: Dict[str, ObstacleSpec]
    ) -> None:
        """Move robots to poses (m), and replace doors and obstacles.

        Raises WorldError if an obstacle is invalid or a robot would be in collision; then nothing changes.
        """
        before = {name: robot.pose for name, robot in self.robots.items()}, self.doors, self.obstacles
        self._build(poses, doors, obstacles)
        try:
            self._check()
        except WorldError:
            self._build(*before)
            raise

    def _build(
        self, poses: Mapping[str, Pose2D], doors: Dict[str, DoorSpec], obstacles: Dict[str, ObstacleSpec]
    ) -> None:
        """Set poses, doors and obstacles, and compute segments and discs in cells."""
        for name, pose in poses.items():
            self.robots[name].pose = pose
        self.doors, self.obstacles = doors, obstacles
        self._solids = [obstacle.corners() for obstacle in obstacles.values() if obstacle.box]
        segments = [(door.start, door.end) for door in doors.values() if not door.open]
        self._segments = self._points([*segments, *(edge for solid in self._solids for edge in _edges(solid))], 4)
        self._discs = self._with_radii([(one.at, one.radius) for one in obstacles.values() if not one.box])

    def _surroundings(self, robot: str) -> Surroundings:
        """Return the obstacles of a robot: the world and the other robots."""
        others = [other for name, other in self.robots.items() if name != robot]
        if not others:
            return self._occupied, self._segments, self._discs
        edges = self._points([edge for other in others if other.outline for edge in _edges(other.corners())], 4)
        discs = self._with_radii([(other.pose[:2], other.spec.radius) for other in others if not other.outline])
        segments = np.concatenate((self._segments, edges))
        return self._occupied, segments, np.concatenate((self._discs, discs))

    def _hits(self, robot: str, pose: Pose2D) -> int:
        """Return the kind of obstacle that a robot at a pose overlaps, including one that contains the whole robot."""
        body, outline = self.robots[robot], self._outlines[robot] * (1.0 - CONTACT_TOLERANCE)
        radius = body.reach / self._scale * (1.0 - CONTACT_TOLERANCE)
        hit = int(body_hits(*self._surroundings(robot), outline, radius, *self._in_cells(pose)))
        point = pose.compose(Pose2D(*body.outline[0])) if body.outline else pose
        solids = self._solids + [other.corners() for other in self.robots.values() if other is not body]
        if hit == CLEAR and any(gap(np.array(solid), 0.0, point.x, point.y) < 0.0 for solid in solids if solid):
            return HIT_SEGMENT
        return hit

    def _check(self) -> None:
        """Check that obstacles are valid and robots free. Raises WorldError."""
        for obstacle in self.obstacles.values():
            problem = obstacle.problem() or self.spec.grid.off_map(*obstacle.at)
            if problem:
                raise WorldError(f"the obstacle {obstacle.name!r}: {problem}")
        for name, robot in self.robots.items():
            pose = robot.pose
            if not all(map(math.isfinite, pose)):
                raise WorldError(f"robot {name!r}: the pose must be finite, not {tuple(pose)}")
            outside = self.spec.grid.off_map(pose.x, pose.y)
            if outside:
                raise WorldError(f"robot {name!r}: {outside}")
            hit = self._hits(name, pose)
            if hit != CLEAR:
                raise WorldError(f"robot {name!r} would collide with {HITS[hit]} at ({pose.x:.2f}, {pose.y:.2f})")

    def _robot(self, name: str) -> Robot:
        if name not in self.robots:
            raise WorldError("unknown robot {!r}; robots: {}".format(name, ", ".join(self.robots)))
        return self.robots[name]

    def _points(self, points: Sequence, columns: int) -> np.ndarray:
        """Convert points (m), or pairs of points, to rows of an array in cells."""
        origin = (self.spec.grid.origin_x, self.spec.grid.origin_y)
        return ((np.array(points, dtype=np.float64).reshape(-1, 2) - origin) / self._scale).reshape(-1, columns)

    def _with_radii(self, discs: Sequence[Tuple[Point, float]]) -> np.ndarray:
        radii = np.array([radius for _, radius in discs], dtype=np.float64) / self._scale
        return np.column_stack((self._points([at for at, _ in discs], 2), radii))

    def _in_cells(self, pose: Pose2D) -> Pose2D:
        grid = self.spec.grid
        return Pose2D((pose.x - grid.origin_x) / self._scale, (pose.y - grid.origin_y) / self._scale, pose.yaw)


def load_simulation(
    path: str, map_file: str = "", watchdog: float = 0.2, delay: Optional[float] = None, robots: int = 0
) -> Simulation:
    """Load a world file and check that its robots are free of collisions. Raises WorldError, which names file and key.

    ``delay``: delay (s) of all lasers, overrides the file. ``robots``: use the first robots of the file; 0: all.
    """
    spec = load_world(path, map_file)
    if robots > len(spec.robots):
        raise WorldError(f"world {path}: robots: there are {len(spec.robots)}, not {robots}; add robots to the file")
    spec = spec._replace(robots=spec.robots[: robots or None])
    if delay is not None:
        late = (
            robot._replace(lasers=tuple(laser._replace(delay=delay) for laser in robot.lasers)) for robot in spec.robots
        )
        spec = spec._replace(robots=tuple(late))
    try:
        return Simulation(spec, watchdog)
    except WorldError as error:
        raise WorldError(f"world {path}: robots: {error}; change the pose or move the obstacle") from error


def _obstacle(name: str, x: float, y: float, *size: float) -> ObstacleSpec:
    return ObstacleSpec(name, (x, y), box=Box(*size)) if len(size) > 1 else ObstacleSpec(name, (x, y), size[0])


def _edges(corners: List[Point]) -> List[Tuple[Point, Point]]:
    return list(zip(corners, corners[1:] + corners[:1]))
