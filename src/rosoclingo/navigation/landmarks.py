"""Landmarks of a map: what travel costs from a few cells to all others, which makes a search on that map shorter."""

from typing import NamedTuple, Optional

import numpy as np

from rosoclingo.navigation.compiled_search import spread

__all__ = ["Landmarks", "Tariff"]

COUNT = 6
POCKET = 0.02  # a landmark that reaches less of all open cells leads few searches
MOST_BYTES = 1 << 26  # a map so large that its landmarks would take more memory has fewer of them
PORTION = 60000  # cells that one call looks at: some milliseconds


class Tariff(NamedTuple):
    """What travel costs: cells less clear than ``least`` are closed, those up to ``comfort`` (cells) dearer."""

    least: float
    comfort: float
    weight: float


class Landmarks:
    """Cells far apart on one clearance field, found one after the other; ``costs`` are those of the ones that are done.

    ``costs``: float32 (cells, n), n from 0 on; infinite where a landmark does not reach.
    """

    def __init__(self, clearance: np.ndarray, tariff: Tariff) -> None:
        self.clearance, self.tariff = clearance, tariff
        self.costs = np.empty((clearance.size, 0), dtype=np.float32)
        self._count = min(COUNT, MOST_BYTES // (4 * clearance.size))
        self._nearest = np.where(clearance.ravel() >= tariff.least, np.float32(np.inf), np.float32(-1.0))
        self._open = np.count_nonzero(self._nearest > 0.0)
        self._begun: Optional[tuple] = None
        self._begin()

    @property
    def done(self) -> bool:
        """Whether all landmarks are there."""
        return self._begun is None

    def go_on(self) -> None:
        """Do a small part of what is left to do."""
        if self._begun is None:
            return
        costs, keys, items, size = self._begun
        keys, items, size = spread(self.clearance, *self.tariff, costs, keys, items, size, PORTION)
        self._begun = (costs, keys, items, size)
        if size == 0:
            self._end(costs)

    def _end(self, costs: np.ndarray) -> None:
        """Take the landmark that is done, and begin with the next one."""
        reached = np.isfinite(costs)
        if np.count_nonzero(reached) < POCKET * self._open:
            self._nearest[reached] = -1.0
        else:
            self.costs = np.concatenate([self.costs, costs[:, None]], axis=1)
            self._nearest = np.minimum(self._nearest, costs)
        self._begin()

    def _begin(self) -> None:
        """Begin with the open cell that is furthest from all landmarks, those of another part of the map first."""
        self._begun = None
        cell = int(self._nearest.argmax()) if self._nearest.size else 0
        if self.costs.shape[1] >= self._count or self._nearest[cell] <= 0.0:
            return
        costs = np.full(self.clearance.size, np.inf, dtype=np.float32)
        costs[cell] = 0.0
        self._begun = (costs, np.zeros(64, dtype=np.float32), np.full(64, cell, dtype=np.int32), 1)
