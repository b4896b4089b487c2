"""Random occupied grids, and distances on them by brute force."""

import math

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rosoclingo.robot.navigation.compiled.clearance import update_clearance, update_open

GRIDS = arrays(np.uint8, st.tuples(st.integers(3, 20), st.integers(3, 20)), elements=st.sampled_from([0, 0, 0, 0, 1]))


def clearance_of(occupied, reach=50.0):
    out = np.full(occupied.shape, 7.0, dtype=np.float32)
    update_clearance(occupied, reach, 0, occupied.shape[0], 0, occupied.shape[1], out)
    return out


def open_cells(occupied, radius, reach=8.0):
    """Return the cells in which a disc fits."""
    out = np.full(occupied.shape, 7, dtype=np.uint8)
    closed = np.zeros(occupied.shape, dtype=bool)
    update_open(
        clearance_of(occupied, reach), occupied, closed, radius, 0, occupied.shape[0], 0, occupied.shape[1], out
    )
    return out


def distance(occupied, x, y):
    rows, columns = np.nonzero(occupied)
    if not len(rows):
        return math.inf
    dx = np.maximum(np.maximum(columns - x, x - columns - 1), 0)
    dy = np.maximum(np.maximum(rows - y, y - rows - 1), 0)
    return float(np.hypot(dx, dy).min())
