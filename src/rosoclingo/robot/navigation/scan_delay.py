"""By how much a laser's scans are older than they say, told from how they fit the map while the robot turns."""

from typing import Callable, List, Optional

import numpy as np

from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle

__all__ = ["ScanDelay"]

TRIALS = np.arange(7) * 0.05  # s
TURN = 0.2  # rad/s: who turns slower learns nothing
SINCE = 0.1  # s over which the rate of turning is taken
BEAMS = 90  # of a scan that are looked at
APART = 0.3  # m: what is further off the map's things is no worse, as it is none of them
FADE = 0.97  # of what was seen before, at each scan
ENOUGH = 0.4  # rad to have turned
PLAIN, BETTER = 1.3, 0.9  # times as bad as the best is the worst; as good as the one in use is a better one
UNSURE, SURE = 0.1, 0.025  # s by which it may be wrong: the period of a usual laser, half of what is between trials


class ScanDelay:
    """Finds the ``delay`` (s, from 0 on) that is to be taken off the stamps of scans.

    Stage stamps a scan a step late, others when it has come through a cable: while the robot turns, its walls are
    beside those of the map. ``doubt`` (s) is by how much the delay may be wrong: what is seen while turning is off by
    that times the rate.
    """

    def __init__(self) -> None:
        self.delay, self.doubt = 0.0, UNSURE
        self._costs = np.zeros(len(TRIALS))
        self._turned = 0.0
        self._last: Optional[Pose2D] = None

    def see(
        self, costmap: Costmap, angles: np.ndarray, ranges: np.ndarray, where: Callable[[float], Optional[Pose2D]]
    ) -> float:
        """Take a scan: ``angles`` (rad), ``ranges`` (m; NaN and infinity hit nothing); return the rate of turning.

        ``where`` tells the laser's pose in the map's frame so many s before the scan's stamp, None where that is not
        known; the rate (rad/s) is that at the stamp, less the delay.
        """
        here, before = where(self.delay), where(self.delay + SINCE)
        if here is None or before is None:
            return 0.0
        rate = normalize_angle(here.yaw - before.yaw) / SINCE
        if abs(rate) > TURN:
            self._learn(costmap, angles, ranges, where, abs(rate))
        return rate

    def _learn(self, costmap: Costmap, angles: np.ndarray, ranges: np.ndarray, where: Callable, rate: float) -> None:
        hit = np.flatnonzero(np.isfinite(ranges) & (ranges > 0.0) & (ranges < costmap.limits.obstacle_range))
        hit = hit[:: max(1, len(hit) // BEAMS)]
        poses = [where(float(trial)) for trial in TRIALS]
        if not len(hit) or None in poses:
            return
        found = np.array([_distance(costmap, pose, angles[hit], ranges[hit]) for pose in _known(poses)])
        self._costs = FADE * self._costs + rate * found
        self._turned = FADE * self._turned + rate * SINCE
        if self._turned < ENOUGH:
            return
        best, used = int(self._costs.argmin()), round(self.delay / float(TRIALS[1]))
        if self._costs[best] < BETTER * self._costs[used]:
            self.delay = float(TRIALS[best])
        self.doubt = SURE if self._costs.max() > PLAIN * self._costs[best] else UNSURE


def _known(poses: List[Optional[Pose2D]]) -> List[Pose2D]:
    return [pose for pose in poses if pose is not None]


def _distance(costmap: Costmap, pose: Pose2D, angles: np.ndarray, ranges: np.ndarray) -> float:
    """Return how far (m) from what is on the map a scan's hits are, on average, if it was taken from a pose."""
    clearance = costmap.static_grounds[0].clearance
    x, y = costmap.to_cells(pose.x, pose.y)
    far, turned = ranges / costmap.resolution, angles + pose.yaw
    columns, rows = np.floor(x + far * np.cos(turned)).astype(int), np.floor(y + far * np.sin(turned)).astype(int)
    height, width = clearance.shape
    inside = (rows >= 0) & (rows < height) & (columns >= 0) & (columns < width)
    found = np.full(len(ranges), APART)
    found[inside] = np.clip(clearance[rows[inside], columns[inside]] * costmap.resolution, 0.0, APART)
    return float(found.mean())
