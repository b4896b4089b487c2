"""Simulated robot: a differential drive with limits, odometry drift, a watchdog and lasers."""

import math
from typing import List, Tuple

import numpy as np

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.simulation.compiled.shapes import CLEAR, cast_rays, sweep
from rosoclingo.robot.simulation.spec import LaserSpec, Point, RobotSpec

# The obstacles of a robot: occupied cells, segments and discs, as in ``shapes``.
Surroundings = Tuple[np.ndarray, np.ndarray, np.ndarray]

CHECK_DISTANCE = 0.25  # cells: maximum distance between two collision checks of a moving robot


class Laser:
    """A laser scanner. ``seed`` determines its noise."""

    def __init__(self, spec: LaserSpec, seed: int) -> None:
        self.spec = spec
        half = math.radians(spec.angle) / 2.0
        self.angles = np.linspace(-half, half, spec.beams)
        self._random = np.random.Generator(np.random.PCG64(seed))

    def scan(self, pose: Pose2D, around: Surroundings, scale: float) -> np.ndarray:
        """Return the ranges (float32, m) from a pose of the robot (cells); a cell is ``scale`` m wide."""
        spec = self.spec
        place = pose.compose(Pose2D(spec.pose.x / scale, spec.pose.y / scale, spec.pose.yaw))
        out = np.empty(len(self.angles))
        cast_rays(*around, place.x, place.y, self.angles + place.yaw, spec.range / scale, out)
        out *= scale
        if spec.noise > 0.0:
            hit = out < spec.range
            out[hit] += self._random.normal(0.0, spec.noise, int(hit.sum()))
        return np.minimum(np.maximum(out, spec.min_range), spec.range).astype(np.float32)


class Robot:
    """State of a robot: ``pose`` and ``odometry`` (m, rad; in the world frame), velocity, stall.

    ``drift``: factors of the odometry's velocities (v, w). ``outline``: corners (m) of the footprint, empty for a disc.
    ``reach``: radius (m) of the circumscribed circle.
    """

    def __init__(self, spec: RobotSpec, seed: int) -> None:
        self.spec = spec
        self.outline = spec.footprint
        self._seed = seed
        corners = np.array(spec.footprint or [(-spec.radius, -spec.radius), (spec.radius, spec.radius)])
        self._width = float(np.ptp(corners, axis=0).min())
        self.reach = float(np.hypot(*corners.T).max()) if spec.footprint else spec.radius
        self.lasers = tuple(Laser(laser, seed + 1 + i) for i, laser in enumerate(spec.lasers))
        self.reset()

    def reset(self) -> None:
        """Return to the initial pose, at rest, and reset odometry and drift."""
        self.place(self.spec.pose)
        self.odometry = self.spec.pose
        self._command: Tuple[float, float] = (0.0, 0.0)
        self._commanded_at = -math.inf
        draw = np.random.Generator(np.random.PCG64(self._seed)).uniform(-1.0, 1.0, 2)
        self.drift = (1.0 + self.spec.drift[0] * draw[0], 1.0 + self.spec.drift[1] * draw[1])

    def place(self, pose: Pose2D) -> None:
        """Move the robot to a pose (m) without changing its odometry, as if it were lifted."""
        self.pose, self.v, self.w, self.stalled = pose, 0.0, 0.0, False
        self._before: List[Pose2D] = []  # poses at the last steps, newest first

    def corners(self) -> List[Point]:
        """Return the corners (m) of the footprint in the world frame."""
        return [self.pose.compose(Pose2D(x, y))[:2] for x, y in self.outline]

    def command(self, v: float, w: float, now: float) -> None:
        """Set the desired velocity (m/s, rad/s) at a time (s). A velocity that is not finite is a stop."""
        good = math.isfinite(v) and math.isfinite(w)
        self._command = (v, w) if good else (0.0, 0.0)
        self._commanded_at = now

    def scan_pose(self, laser: int, dt: float) -> Pose2D:
        """Return the pose (m) of the robot for the present scan of a laser, given the delay and the step ``dt`` (s)."""
        late = self.lasers[laser].spec.delay / dt
        if late <= 0.0 or not self._before:
            return self.pose
        path = [self.pose, *self._before]
        newer, older = (path[min(int(late) + i, len(path) - 1)] for i in (0, 1))
        return newer.interpolate(older, late % 1.0)

    def accelerate(self, now: float, dt: float, watchdog: float) -> None:
        """Accelerate towards the command, within the limits; stop if the command is too old.

        As in stage_ros, a command is too old at the age ``watchdog`` (s); 0: never.
        """
        fresh = watchdog <= 0.0 or now - self._commanded_at < watchdog - 1e-9
        v, w = self._command if fresh else (0.0, 0.0)
        spec = self.spec
        self.v = _approach(self.v, _clamp(v, spec.max_speed), spec.acceleration * dt)
        self.w = _approach(self.w, _clamp(w, spec.max_turn), spec.turn_acceleration * dt)

    def move(self, dt: float, around: Surroundings, outline: np.ndarray, pose: Pose2D, scale: float) -> int:
        """Move for ``dt`` s along the arc of the present velocity. Return the kind of obstacle hit, or CLEAR.

        ``outline`` and ``pose`` are in cells of ``scale`` m. A robot that hits an obstacle stops before it.
        """
        late = max((laser.spec.delay for laser in self.lasers), default=0.0)
        self._before = [self.pose, *self._before][: math.ceil(late / dt - 1e-9)]
        if self.v == 0.0 and self.w == 0.0:
            self.stalled = False
            return CLEAR
        grain = min(CHECK_DISTANCE, 0.5 * self._width / scale)
        part, hit = sweep(*around, outline, self.reach / scale, *pose, self.v / scale, self.w, dt, grain)
        self.pose = self.pose.advance(self.v, self.w, dt * part)
        self.odometry = self.odometry.advance(self.v * self.drift[0], self.w * self.drift[1], dt * part)
        self.stalled = hit != CLEAR
        if self.stalled:
            self.v = self.w = 0.0
        return int(hit)


def _approach(value: float, target: float, most: float) -> float:
    """Return ``value`` moved towards ``target`` by at most ``most``."""
    return target if abs(target - value) <= most else value + math.copysign(most, target - value)


def _clamp(value: float, limit: float) -> float:
    """Return ``value`` limited to -``limit`` .. ``limit``."""
    return max(-limit, min(limit, value))
