"""Landmarks of a map: what travel costs from a few cells to all others, which makes a search on that map shorter."""

from typing import NamedTuple, Optional

import numpy as np

from rosoclingo.robot.navigation.compiled.places import NOWHERE, Ground
from rosoclingo.robot.navigation.compiled.search import spread

__all__ = ["CostWeights", "Landmarks"]

COUNT = 24
POCKET = 0.02  # a landmark that reaches less of all open cells leads few searches
MOST_BYTES = 1 << 26  # a map so large that its landmarks would take more memory has fewer of them
PORTION = 30000  # cells that one call looks at: some milliseconds


class CostWeights(NamedTuple):
    """What travel costs: 1 a cell, up to ``weight`` more where things are nearer than ``comfort`` (cells)."""

    comfort: float
    weight: float


class Landmarks:
    """Cells far apart on one ground, found one after the other; ``costs`` are those of the ones that are done.

    ``costs``: float32 (n, cells), n from 0 on; infinite where a landmark does not reach.
    """

    def __init__(self, ground: Ground, weights: CostWeights) -> None:
        self.ground, self.weights = ground, weights
        cells = ground.places.size
        self._all = np.empty((min(COUNT, MOST_BYTES // (4 * cells)), cells), dtype=np.float32)
        self.costs = self._all[:0]
        self._nearest = np.where(ground.places.ravel() != NOWHERE, np.float32(np.inf), np.float32(-1.0))
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
        keys, items, size = spread(self.ground, *self.weights, costs, keys, items, size, PORTION)
        self._begun = (costs, keys, items, size)
        if size == 0:
            self._end(costs)

    def _end(self, costs: np.ndarray) -> None:
        """Take the landmark that is done, and begin with the next one."""
        reached = np.isfinite(costs)
        if np.count_nonzero(reached) < POCKET * self._open:
            self._nearest[reached] = -1.0
        else:
            self.costs = self._all[: len(self.costs) + 1]
            self._nearest = np.minimum(self._nearest, costs)
        self._begin()

    def _begin(self) -> None:
        """Begin with the open cell that is furthest from all landmarks, those of another part of the map first."""
        self._begun = None
        cell = int(self._nearest.argmax()) if self._nearest.size else 0
        if len(self.costs) == len(self._all) or self._nearest[cell] <= 0.0:
            return
        costs = self._all[len(self.costs)]
        costs.fill(np.inf)
        costs[cell] = 0.0
        self._begun = (costs, np.zeros(64, dtype=np.float32), np.full(64, cell, dtype=np.int32), 1)
