"""The reference for the simulated world: its geometry computed again, slowly, from its definition, in metres."""

import math

import numpy as np

from rosoclingo.robot.navigation import Pose2D

DEEP = 1e-6  # m: bodies that overlap by less only touch


def squares(grid):
    """Return the occupied cells as (n, 4): x0, y0, x1, y1."""
    rows, columns = np.nonzero(grid.cells >= 100)
    x, y = grid.origin_x + columns * grid.resolution, grid.origin_y + rows * grid.resolution
    return np.stack([x, y, x + grid.resolution, y + grid.resolution], axis=1)


def place(corners, pose):
    """Return points (n, 2) of a body's frame at the body's pose."""
    return np.array([pose.compose(Pose2D(x, y))[:2] for x, y in corners]).reshape(-1, 2)


def box_corners(at, box):
    half = [(sx * box.width / 2, sy * box.depth / 2) for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    return place(half, Pose2D(*at, box.yaw))


def edges(corners):
    """Return the edges (n, 4) of a polygon."""
    return np.concatenate([corners, np.roll(corners, -1, axis=0)], axis=1)


def to_segments(points, segments):
    """Return the distance of each point (n, 2) from the nearest of some segments (m, 4)."""
    if not len(segments) or not len(points):
        return np.full(len(points), math.inf)
    a, d = segments[None, :, :2], segments[None, :, 2:] - segments[None, :, :2]
    t = ((points[:, None] - a) * d).sum(axis=2) / np.maximum((d * d).sum(axis=2), 1e-300)
    nearest = a + np.clip(t, 0.0, 1.0)[..., None] * d
    return np.hypot(*(points[:, None] - nearest).transpose(2, 0, 1)).min(axis=1)


def within(points, corners):
    """Return which points (n, 2) are inside a polygon, deeper than DEEP: by the turns of its edges around each."""
    a = corners[None] - points[:, None]
    b = np.roll(a, -1, axis=1)
    turn = np.arctan2(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0], (a * b).sum(axis=2)).sum(axis=1)
    return (np.abs(turn) > math.pi) & (to_segments(points, edges(corners)) > DEEP)


def along(corners, gap=0.004):
    """Return points of a polygon's sides, at most ``gap`` m apart."""
    parts = []
    for x0, y0, x1, y1 in edges(corners):
        t = np.linspace(0.0, 1.0, 2 + int(math.hypot(x1 - x0, y1 - y0) / gap))[:-1, None]
        parts.append(np.array([[x0, y0]]) + t * np.array([[x1 - x0, y1 - y0]]))
    return np.concatenate(parts)


class Things:
    """All objects that a robot could be inside at its present pose; ``others``: also the other robots."""

    def __init__(self, world, robot, others=True):
        self.squares = squares(world.spec.grid)
        self.doors = np.array([(*d.start, *d.end) for d in world.doors.values() if not d.open]).reshape(-1, 4)
        self.solids = [box_corners(o.at, o.box) for o in world.obstacles.values() if o.box]
        self.discs = [(*o.at, o.radius) for o in world.obstacles.values() if not o.box]
        for name, other in world.robots.items() if others else ():
            if name != robot and other.outline:
                self.solids.append(place(other.outline, other.pose))
            elif name != robot:
                self.discs.append((other.pose.x, other.pose.y, other.spec.radius))
        self.discs = np.array(self.discs).reshape(-1, 3)

    def overlap_disc(self, x, y, radius):
        """Return the objects that a disc overlaps, empty for none."""
        point, s = np.array([[x, y]]), self.squares
        gaps = np.maximum(np.maximum(s[:, :2] - point, point - s[:, 2:]), 0.0)
        if (np.hypot(*gaps.T) < radius - DEEP).any():
            return "wall"
        if (to_segments(point, self.doors) < radius - DEEP).any():
            return "door"
        if any(within(point, c)[0] or (to_segments(point, edges(c)) < radius - DEEP).any() for c in self.solids):
            return "solid"
        apart = np.hypot(self.discs[:, 0] - x, self.discs[:, 1] - y) - self.discs[:, 2]
        return "disc" if (apart < radius - DEEP).any() else ""

    def overlap_polygon(self, corners):
        """Return the objects that a polygon overlaps, empty for none."""
        sides, s = along(corners), self.squares
        deep = (sides[:, None] > s[None, :, :2] + DEEP) & (sides[:, None] < s[None, :, 2:] - DEEP)
        if deep.all(axis=2).any() or within((s[:, :2] + s[:, 2:]) / 2, corners).any():
            return "wall"
        if any(within(along(np.array([d[:2], d[2:]])), corners).any() for d in self.doors):
            return "door"
        if any(within(along(c), corners).any() or within(sides, c).any() for c in self.solids):
            return "solid"
        away = to_segments(self.discs[:, :2], edges(corners))
        inside = within(self.discs[:, :2], corners)
        return "disc" if (inside | (away < self.discs[:, 2] - DEEP)).any() else ""

    def overlap(self, robot, pose=None):
        """Return the objects that a robot overlaps at a pose, by default the present one."""
        pose = pose or robot.pose
        if robot.outline:
            return self.overlap_polygon(place(robot.outline, pose))
        return self.overlap_disc(pose.x, pose.y, robot.spec.radius)


def cast(things, x, y, angles, reach, grown):
    """Return how far rays from a point run (m), with all objects ``grown`` by some metres."""
    out = np.full(len(angles), float(reach))
    dx, dy = np.cos(angles)[:, None], np.sin(angles)[:, None]
    if len(things.squares):
        low, high = things.squares[:, :2] - grown, things.squares[:, 2:] + grown
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            tx0, tx1 = (low[None, :, 0] - x) / dx, (high[None, :, 0] - x) / dx
            ty0, ty1 = (low[None, :, 1] - y) / dy, (high[None, :, 1] - y) / dy
        enter = np.maximum(np.fmin(tx0, tx1), np.fmin(ty0, ty1))
        leave = np.minimum(np.fmax(tx0, tx1), np.fmax(ty0, ty1))
        hit = np.where((enter <= leave) & (leave >= 0.0), np.maximum(enter, 0.0), np.inf)
        out = np.minimum(out, hit.min(axis=1))
    for x0, y0, x1, y1 in np.concatenate([things.doors, *(edges(c) for c in things.solids)]):
        ex, ey = x1 - x0, y1 - y0
        cross = dx[:, 0] * ey - dy[:, 0] * ex
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            t = ((x0 - x) * ey - (y0 - y) * ex) / cross
            u = ((x0 - x) * dy[:, 0] - (y0 - y) * dx[:, 0]) / cross
        spare = grown / math.hypot(ex, ey)
        hit = (cross != 0.0) & (u >= -spare) & (u <= 1.0 + spare) & (t >= -grown)
        out = np.where(hit, np.minimum(out, np.maximum(t, 0.0)), out)
    for px, py, radius in things.discs:
        ahead = (px - x) * dx[:, 0] + (py - y) * dy[:, 0]
        aside = (px - x) * dy[:, 0] - (py - y) * dx[:, 0]
        half = np.sqrt(np.maximum((radius + grown) ** 2 - aside**2, 0.0))
        hit = (np.abs(aside) <= radius + grown) & (ahead + half >= 0.0)
        out = np.where(hit, np.minimum(out, np.maximum(ahead - half, 0.0)), out)
    return out
