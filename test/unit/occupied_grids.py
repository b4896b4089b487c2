"""Random occupied grids, and distances on them by brute force."""

import math

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from rosoclingo.robot.navigation.compiled.clearance import update_clearance
from rosoclingo.robot.navigation.compiled.places import Ground, update_places

GRIDS = arrays(np.uint8, st.tuples(st.integers(3, 20), st.integers(3, 20)), elements=st.sampled_from([0, 0, 0, 0, 1]))


def clearance_of(occupied, reach=50.0):
    out = np.full(occupied.shape, 7.0, dtype=np.float32)
    update_clearance(occupied, reach, 0, occupied.shape[0], 0, occupied.shape[1], out)
    return out


def ground_of(occupied, radius, reach=8.0, unknown=None):
    inland = clearance_of(np.zeros_like(occupied) if unknown is None else unknown, reach)
    ground = Ground(clearance_of(occupied, reach), occupied, inland, np.full(occupied.shape, 7, dtype=np.uint8), radius)
    update_places(ground, 0, occupied.shape[0], 0, occupied.shape[1])
    return ground


def distance(occupied, x, y):
    rows, columns = np.nonzero(occupied)
    if not len(rows):
        return math.inf
    dx = np.maximum(np.maximum(columns - x, x - columns - 1), 0)
    dy = np.maximum(np.maximum(rows - y, y - rows - 1), 0)
    return float(np.hypot(dx, dy).min())
