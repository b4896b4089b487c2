"""A robot that seems to touch an obstacle, by noise or lag, gets away and touches nothing else."""

import math

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from navigation_worlds import Drive, room, simulation
from occupied_grids import GRIDS, clearance_of

from rosoclingo.robot.navigation import Costmap, GridPlanner, NavigationOutcome, PlanOutcome, Pose2D
from rosoclingo.robot.navigation.body import Body
from rosoclingo.robot.navigation.compiled.footprints import NEAR, body_clearance

BODIES = [Body(2.3), Body(0.0, ((3.0, 2.0), (-3.0, 2.0), (-3.0, -2.0), (3.0, -2.0)))]


def distances(body, occupied, x, y, yaw):
    """Return the distances (cells) of a body's edge, by points 0.01 apart, or of a disc from squares of cells."""
    c, s = math.cos(yaw), math.sin(yaw)
    points = np.zeros((1, 2))
    if body.footprint:
        corners = np.array(body.footprint)
        parts = np.linspace(0.0, 1.0, 601)[:, None, None]
        points = (corners + parts * (np.roll(corners, -1, axis=0) - corners)).reshape(-1, 2)
    points = points @ np.array([[c, s], [-s, c]]) + (x, y)
    rows, columns = np.nonzero(occupied)
    dx = np.maximum(np.maximum(columns - points[:, :1], points[:, :1] - columns - 1), 0)
    dy = np.maximum(np.maximum(rows - points[:, 1:], points[:, 1:] - rows - 1), 0)
    return np.hypot(dx, dy).min(axis=0) - (0.0 if body.footprint else body.radius)


def edge_meets(body, occupied, x, y, yaw):
    """Return whether points of a footprint's edge, or of a disc, are in the squares of occupied cells."""
    c, s = math.cos(yaw), math.sin(yaw)
    if body.footprint:
        corners = np.array(body.footprint)
        parts = np.linspace(0.0, 1.0, 101)[:, None, None]
        points = (corners + parts * (np.roll(corners, -1, axis=0) - corners)).reshape(-1, 2)
    else:
        turns = np.linspace(0.0, 2.0 * math.pi, 401)
        points = (body.radius - 1e-9) * np.stack((np.cos(turns), np.sin(turns)), axis=1)
    points = points @ np.array([[c, s], [-s, c]]) + (x, y)
    rows, columns = np.nonzero(occupied)
    inside = (points[:, :1] > columns) & (points[:, :1] < columns + 1)
    return (inside & (points[:, 1:] > rows) & (points[:, 1:] < rows + 1)).any(axis=0)


def contains_square(body, occupied, x, y, yaw):
    """Return whether the middle of an occupied square is inside a footprint, which is a rectangle."""
    c, s = math.cos(yaw), math.sin(yaw)
    rows, columns = np.nonzero(occupied)
    middles = (np.column_stack((columns, rows)) + 0.5 - (x, y)) @ np.array([[c, -s], [s, c]])
    return bool(body.footprint) and bool((np.abs(middles) < np.max(body.footprint, axis=0)).all(axis=1).any())


@given(GRIDS, st.sampled_from(BODIES), st.tuples(st.floats(0.0, 20.0), st.floats(0.0, 20.0), st.floats(-4.0, 4.0)))
def test_touching_clearance_is_exact_near_obstacles(occupied, body, pose):
    height, width = occupied.shape
    pose = (min(pose[0], width - 0.1), min(pose[1], height - 0.1), pose[2])
    shape = (np.array(body.footprint, dtype=float).reshape(-1, 2), body.radius, body.outer)
    found = body_clearance(clearance_of(occupied, 9.0), occupied, shape, *pose, 9.0)
    gap = distances(body, occupied, *pose).min(initial=9.0)
    inside = contains_square(body, occupied, *pose)
    if found < 0.0:
        assert inside or gap < 1e-6
        return
    assert not inside
    assert not edge_meets(body, occupied, *pose).any()
    assert min(found, 9.0) <= gap + 1e-6
    if gap < NEAR:
        assert found > gap - 0.01


def test_touching_ghost_does_not_push_robot_into_wall():
    """A passage with 20 mm on either side, in which the laser wrongly sees a point at the robot's side."""
    walls = [(2.0, 0.0, 4.0, 1.8), (2.0, 2.2, 4.0, 4.0)]
    drive = Drive(simulation(room(6.0, 4.0, 0.1, walls), Pose2D(1.0, 2.0)))
    seen = []

    def haunt(drive):
        if not seen and drive.robot.pose.x > 3.0:
            pose = drive.robot.pose
            angles = np.full(12, 0.5 * math.pi - pose.yaw)
            seen.append(any(drive.costmap.observe(pose, angles, np.full(12, 0.12), 6.0) for _ in range(3)))
            drive.navigator.obstacles_changed()

    assert drive.to(Pose2D(5.0, 2.0), 300.0, haunt).outcome is NavigationOutcome.REACHED
    assert seen == [True]
    assert drive.collisions == []


def test_touching_paths_avoid_barred_cells_until_released():
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


def test_touching_marks_below_the_robot_are_forgotten():
    costmap = Costmap(room())
    for x in (3.0, 3.3):
        angles = np.linspace(-0.01, 0.01, 5)
        for _ in range(3):
            costmap.observe(Pose2D(x - 1.0, 3.0), angles, np.full(5, 1.0), 6.0)
    assert np.argwhere(costmap.marks[:, :64]).any()
    costmap.forget_under(3.0, 3.0)
    assert np.argwhere(costmap.marks)[:, 1].min() == 65
    assert costmap.has_marks
    costmap.forget_under(3.3, 3.0)
    assert not costmap.has_marks
    assert not costmap.occupied[60, 60:70].any()
