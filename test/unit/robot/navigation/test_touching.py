"""A robot that seems to touch something, by noise or lag, gets away from it, and touches nothing else by that."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from navigation_worlds import Drive, room, simulation
from occupied_grids import GRIDS, clearance_of

from rosoclingo.robot.navigation import Costmap, GridPlanner, Outcome, PlanOutcome, Pose2D
from rosoclingo.robot.navigation.body import Body
from rosoclingo.robot.navigation.compiled.footprints import around, body_clearance

BODIES = [Body(2.3), Body(0.0, ((3.0, 2.0), (-3.0, 2.0), (-3.0, -2.0), (3.0, -2.0)))]


def distances(body, occupied, x, y, yaw, graze=0.0):
    """How far a body (cells) is from the squares of all occupied cells; less than 0 where its edge is in one.

    ``graze``: how deep it has to be.
    """
    c, s = math.cos(yaw), math.sin(yaw)
    rows, columns = np.nonzero(occupied)
    if not body.footprint:
        found = gaps(np.array([[x, y]]), rows, columns).min(axis=0) - body.radius
        return np.where(found > -graze, np.maximum(found, 0.0), found)
    corners = np.array(body.footprint) @ np.array([[c, s], [-s, c]]) + (x, y)
    edges = list(zip(corners, np.roll(corners, -1, axis=0)))
    found = np.minimum.reduce([edge_gaps(a, b, rows, columns) for a, b in edges])
    # In a square it is as deep as the deepest of the pieces of its edge.
    meets = [any(edge_meets(a, b, row, column, graze) for a, b in edges) for row, column in zip(rows, columns)]
    pieces = body.pieces(1.0)[1:]
    middles = pieces[:, :2] @ np.array([[c, s], [-s, c]]) + (x, y)
    depths = (gaps(middles, rows, columns) - pieces[:, 2:3]).min(axis=0)
    return np.where(np.array(meets, dtype=bool), depths, found)


def gaps(points, rows, columns):
    """The distances (points, squares) of points (x, y) from the squares of cells."""
    x, y = points[:, :1], points[:, 1:2]
    dx = np.maximum(np.maximum(columns - x, x - columns - 1), 0)
    dy = np.maximum(np.maximum(rows - y, y - rows - 1), 0)
    return np.hypot(dx, dy)


def edge_gaps(a, b, rows, columns):
    """The distances of an edge that meets none of the squares from them: ends from squares, corners from the edge."""
    found = gaps(np.array([a, b]), rows, columns).min(axis=0)
    for right, up in ((0, 0), (0, 1), (1, 0), (1, 1)):
        corners = np.stack([columns + right, rows + up], axis=1)
        part = np.clip((corners - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
        found = np.minimum(found, np.hypot(*(a + part[:, None] * (b - a) - corners).T))
    return found


def edge_meets(a, b, row, column, graze):
    """Whether an edge has a part in a square, the square on both sides of it and it on both of each of its sides'."""
    low, high = np.minimum(a, b) + graze, np.maximum(a, b) - graze
    if high[0] <= column or low[0] >= column + 1 or high[1] <= row or low[1] >= row + 1:
        return False
    along = (b - a) / np.hypot(*(b - a))
    sides = [along[0] * (row + j - a[1]) - along[1] * (column + i - a[0]) for i in (0, 1) for j in (0, 1)]
    return min(sides) < -graze and max(sides) > graze


@given(
    GRIDS,
    st.sampled_from(BODIES),
    st.tuples(st.floats(0.0, 20.0), st.floats(0.0, 20.0), st.floats(-4.0, 4.0)),
    st.tuples(st.floats(-1.0, 1.0), st.floats(-1.0, 1.0), st.floats(-0.5, 0.5)),
)
def test_what_is_allowed_goes_no_deeper_and_touches_nothing_else(occupied, body, pose, step):
    height, width = occupied.shape
    pose = (min(pose[0], width - 0.1), min(pose[1], height - 0.1), pose[2])
    there = tuple(a + b for a, b in zip(pose, step))
    near = around(clearance_of(occupied, 9.0), occupied, body.pieces(1.0), *pose)
    before, after = (distances(body, occupied, *at, graze=1e-6) for at in (pose, there))
    inside = (before >= 0.0) & (near.occupied[np.nonzero(occupied)] == 0)  # the body's edge is to pass them freely
    if body_clearance(near, body.pieces(1.0), *there, 0.0) >= 0.0:
        assert (after >= np.minimum(before, 0.0) - 1e-6)[~inside].all()
    touched = len(near.touched)
    assert (before < 0.0).sum() <= touched <= (distances(body, occupied, *pose, graze=-1e-6) < 0.0).sum()
    if body.footprint:
        assert not inside.any() or np.hypot(*(np.argwhere(occupied)[inside] - (pose[1], pose[0])).T).max() < 4.0
    else:
        assert not inside.any()


def test_where_nothing_is_touched_the_body_is_tried_against_the_map_itself():
    occupied = np.zeros((20, 20), dtype=np.uint8)
    occupied[3, 3] = 1
    near = around(clearance_of(occupied), occupied, BODIES[0].pieces(1.0), 12.0, 12.0, 0.0)
    assert near.occupied is occupied
    assert not len(near.touched)


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_a_ghost_beside_it_does_not_push_the_robot_into_a_wall(side):
    """A passage with 20 mm on either side; in it the laser is made to see something at one of the robot's sides."""
    walls = [(2.0, 0.0, 4.0, 1.8), (2.0, 2.2, 4.0, 4.0)]
    drive = Drive(simulation(room(6.0, 4.0, 0.1, walls), Pose2D(1.0, 2.0)))
    seen = []

    def haunt(drive):
        if not seen and drive.robot.pose.x > 3.0:
            pose = drive.robot.pose
            angles = np.full(12, side * 0.5 * math.pi - pose.yaw)
            seen.append(any(drive.costmap.observe(pose, angles, np.full(12, 0.12), 6.0) for _ in range(3)))
            drive.navigator.obstacles_changed()

    assert drive.to(Pose2D(5.0, 2.0), 300.0, haunt).outcome is Outcome.REACHED
    assert seen == [True]
    assert drive.collisions == []


def test_ways_keep_off_what_is_barred_until_it_is_not():
    walls = [(2.9, 0.0, 3.1, 2.0), (2.9, 2.5, 3.1, 5.0)]
    costmap, ends = Costmap(room(6.0, 6.0, 0.05, walls)), (Pose2D(1.0, 2.2), Pose2D(5.0, 2.2))
    assert GridPlanner().plan(costmap, *ends).length < 4.5
    costmap.bar(3.0, 2.25)
    around_it = GridPlanner().plan(costmap, *ends)
    assert around_it.outcome is PlanOutcome.FOUND
    assert around_it.length > 6.0
    assert costmap.unbar()
    assert not costmap.unbar()
    assert GridPlanner().plan(costmap, *ends).length < 4.5
