"""One simulated robot: a differential drive with limits, drifting odometry, a watchdog and lasers."""

import math
from collections import deque
from typing import Deque, Tuple

import numpy as np

from rosoclingo.robot.navigation.compiled.clearance import cast_rays
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.simulation.compiled.shapes import CLEAR, shorten_rays, sweep
from rosoclingo.robot.simulation.spec import LaserSpec, RobotSpec

__all__ = ["Laser", "Robot", "Surroundings"]

GRAIN = 0.25  # cells: so far apart at most are the places where a moving robot is looked at


class Surroundings:
    """What can be hit, in cells: the occupied cells, segments, discs (``shapes``)."""

    def __init__(self, occupied: np.ndarray, segments: np.ndarray, discs: np.ndarray) -> None:
        self.occupied, self.segments, self.discs = occupied, segments, discs


class Laser:
    """A laser scanner; its noise comes from ``seed``."""

    def __init__(self, spec: LaserSpec, seed: int) -> None:
        self.spec = spec
        half = math.radians(spec.angle) / 2.0
        self.angles = np.linspace(-half, half, spec.beams)
        self._random = np.random.Generator(np.random.PCG64(seed))

    def scan(self, pose: Pose2D, around: Surroundings, scale: float) -> np.ndarray:
        """Return the ranges (float32, m) from a pose of the robot (in cells), ``scale`` m a cell."""
        mount = self.spec.pose
        place = pose.compose(Pose2D(mount.x / scale, mount.y / scale, mount.yaw))
        angles = self.angles + place.yaw
        out = np.empty(len(angles))
        cast_rays(around.occupied, place.x, place.y, angles, self.spec.range / scale, out)
        shorten_rays(place.x, place.y, angles, around.segments, around.discs, out)
        out *= scale
        if self.spec.noise > 0.0:
            hit = out < self.spec.range
            out[hit] += self._random.normal(0.0, self.spec.noise, int(hit.sum()))
        return np.minimum(np.maximum(out, self.spec.min_range), self.spec.range).astype(np.float32)


class Robot:
    """The state of a robot: ``pose`` and what ``odometry`` takes for it (m, the world's frame), velocity, stall.

    ``drift``: by what (v, w) odometry multiplies the velocities. ``before``: its poses at the ends of the last steps,
    the newest first, as far back as its lasers are late.
    """

    def __init__(self, spec: RobotSpec, seed: int) -> None:
        self.spec = spec
        self._seed = seed
        corners = np.array(spec.footprint or [(-spec.radius, -spec.radius), (spec.radius, spec.radius)])
        self.before: Deque[Pose2D] = deque()
        self._width = float(np.ptp(corners, axis=0).min())
        self._reach = float(np.hypot(*corners.T).max()) if spec.footprint else spec.radius
        self.pose = self.odometry = spec.pose
        self.lasers = tuple(Laser(laser, seed + 1 + i) for i, laser in enumerate(spec.lasers))
        self.reset()

    def reset(self) -> None:
        """Put the robot at its start, at rest, odometry set to it, drift as at the start."""
        self.pose = self.odometry = self.spec.pose
        self.before.clear()
        self.v = self.w = 0.0
        self.stalled = False
        self._command: Tuple[float, float] = (0.0, 0.0)
        self._commanded_at = -math.inf
        draw = np.random.Generator(np.random.PCG64(self._seed)).uniform(-1.0, 1.0, 2)
        self.drift = (1.0 + self.spec.drift[0] * draw[0], 1.0 + self.spec.drift[1] * draw[1])

    @property
    def outline(self) -> Tuple[Tuple[float, float], ...]:
        """The corners (m) of its footprint, empty for a disc."""
        return self.spec.footprint

    def command(self, v: float, w: float, now: float) -> None:
        """Ask for a velocity (m/s, rad/s) at a time (s). What is not finite is taken for a stop."""
        good = math.isfinite(v) and math.isfinite(w)
        self._command = (v, w) if good else (0.0, 0.0)
        self._commanded_at = now

    def place(self, pose: Pose2D) -> None:
        """Carry the robot to a pose (m): odometry does not notice, as when a real robot is lifted."""
        self.pose, self.v, self.w, self.stalled = pose, 0.0, 0.0, False
        self.before.clear()

    def seen_from(self, laser: int, dt: float) -> Pose2D:
        """Return the pose (m) from which a laser's scan of now is taken, ``dt`` s being a step."""
        late = self.lasers[laser].spec.delay / dt
        if late <= 0.0 or not self.before:
            return self.pose
        whole = int(late)
        path = [self.pose, *self.before]
        newer, older = path[min(whole, len(path) - 1)], path[min(whole + 1, len(path) - 1)]
        return newer.towards(older, late - whole)

    def _remember(self, dt: float) -> None:
        """Keep where it is, as a step begins."""
        most = math.ceil(max((laser.spec.delay for laser in self.lasers), default=0.0) / dt - 1e-9)
        if most > 0:
            self.before.appendleft(self.pose)
            while len(self.before) > most:
                self.before.pop()

    def accelerate(self, now: float, dt: float, watchdog: float) -> None:
        """Change the velocity towards the command, within the limits; towards a stop when that is too old.

        As stage_ros has it, a command of the age ``watchdog`` (s) is too old; 0: none ever is.
        """
        fresh = watchdog <= 0.0 or now - self._commanded_at < watchdog - 1e-9
        v, w = self._command if fresh else (0.0, 0.0)
        spec = self.spec
        self.v = _nearer(self.v, _within(v, spec.max_speed), spec.acceleration * dt)
        self.w = _nearer(self.w, _within(w, spec.max_turn), spec.turn_acceleration * dt)

    def move(
        self, dt: float, around: Surroundings, outline: np.ndarray, origin: Tuple[float, float], scale: float
    ) -> int:
        """Drive for ``dt`` s along the exact arc of the present velocity; return what was hit (CLEAR: nothing).

        ``outline`` is the footprint in cells, ``origin`` the grid's origin (m) and ``scale`` its resolution. Whoever
        hits something stands still, free of it.
        """
        self._remember(dt)
        if self.v == 0.0 and self.w == 0.0:
            self.stalled = False
            return CLEAR
        x, y = (self.pose.x - origin[0]) / scale, (self.pose.y - origin[1]) / scale
        part, hit = sweep(
            around.occupied, around.segments, around.discs, outline, self._reach / scale,
            x, y, self.pose.yaw, self.v / scale, self.w, dt, min(GRAIN, 0.5 * self._width / scale),
        )  # fmt: skip
        self.pose = self.pose.moved(self.v, self.w, dt * part)
        self.odometry = self.odometry.moved(self.v * self.drift[0], self.w * self.drift[1], dt * part)
        self.stalled = hit != CLEAR
        if self.stalled:
            self.v = self.w = 0.0
        return int(hit)


def _nearer(value: float, wanted: float, most: float) -> float:
    """Return what is wanted, exactly, or a value that is ``most`` nearer to it."""
    return wanted if abs(wanted - value) <= most else value + math.copysign(most, wanted - value)


def _within(value: float, limit: float) -> float:
    """Return ``value``, cut off at ``limit`` either way."""
    return max(-limit, min(limit, value))
