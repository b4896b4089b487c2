"""The documented parameters of move_base: changing any of them changes the behaviour."""

import math

import numpy as np
import pytest
from navigation_worlds import Drive, room, simulation

from rosoclingo.robot.navigation import (
    ClearCostmap,
    Costmap,
    CostmapLimits,
    GlobalPlan,
    GlobalPlanner,
    GridPlanner,
    LocalPlanner,
    NavigationOutcome,
    Navigator,
    NavigatorLimits,
    OccupancyGrid,
    PlanOutcome,
    Pose2D,
    RolloutFollower,
    RotateRecovery,
    Velocity,
)
from rosoclingo.robot.navigation.local_planner import FollowOutcome, VelocityCommand

START, GOAL = Pose2D(1.0, 1.0), Pose2D(5.0, 1.0)


class Counting(GlobalPlanner):
    """A plugin with a fixed answer, which counts its calls."""

    def __init__(self, outcome=PlanOutcome.FOUND):
        super().__init__()
        self.outcome, self.asked = outcome, []

    def plan(self, costmap, start, goal, tolerance=None):
        self.asked.append((start, goal))
        found = self.outcome is PlanOutcome.FOUND
        return GlobalPlan(self.outcome, np.array([start[:2], goal[:2]]) if found else np.empty((0, 2)))


class Stubborn(LocalPlanner):
    """A plugin with a fixed answer."""

    def __init__(self, outcome):
        super().__init__()
        self.outcome = outcome

    def set_plan(self, points, goal):
        pass

    def compute(self, costmap, pose, velocity, period):
        return VelocityCommand(self.outcome)

    def length_left(self, pose):
        return 4.0


class Shouting(ClearCostmap):
    """A recovery that records when it was started."""

    def __init__(self):
        super().__init__("shout", {})
        self.started = []

    def start(self, now, pose):
        self.started.append(now)


def run(planner, follower, seconds, changing=False, recoveries=(), **limits):
    """Tick ten times a second; return time (s) and result of the end, (None, None) without one."""
    navigator = Navigator(Costmap(room()), planner, follower, list(recoveries), NavigatorLimits(**limits))
    navigator.set_goal(0.0, GOAL)
    for i in range(1, round(10 * seconds) + 1):
        if changing:
            navigator.obstacles_changed()
        result = navigator.tick(i / 10, START, Velocity(), 0.1).result
        if result:
            return i / 10, result
    return None, None


DRIVING, BLOCKED = Stubborn(FollowOutcome.DRIVING), Stubborn(FollowOutcome.BLOCKED)


@pytest.mark.parametrize(
    ("finds", "follower", "limits", "least", "outcome", "words"),
    [
        (False, DRIVING, {"planner_patience": 2.0}, 2.0, NavigationOutcome.NO_PLAN, ""),
        (True, BLOCKED, {"controller_patience": 3.0}, 3.0, NavigationOutcome.NO_CONTROL, ""),
        # the rest of the path is 4 m
        (True, DRIVING, {"progress_timeout": 3.0}, 7.0, NavigationOutcome.NO_PROGRESS, "has not become shorter"),
        (True, DRIVING, {"progress_timeout": 0.0}, None, None, ""),
        (True, DRIVING, {"oscillation_timeout": 5.0}, 5.0, NavigationOutcome.OSCILLATING, "moved less than 0.5 m"),
    ],
)
def test_parameter_patience_limits_duration_of_a_goal(finds, follower, limits, least, outcome, words):
    """A goal ends this long (s) after its start."""
    planner = Counting(PlanOutcome.FOUND if finds else PlanOutcome.BLOCKED)
    end, result = run(planner, follower, 60, **limits)
    assert end is least is None or least < end < least + 0.5
    assert (result and result.outcome) is outcome
    assert result is None or words in result.message


@pytest.mark.parametrize("retries", [0, 3])
def test_parameter_max_planning_retries_ends_goal(retries):
    planner = Counting(PlanOutcome.BLOCKED)
    run(planner, DRIVING, 60, max_planning_retries=retries, planner_patience=50.0)
    assert len(planner.asked) == retries + 1


@pytest.mark.parametrize(("frequency", "least", "most"), [(0.0, 1, 1), (1.0, 9, 11), (2.0, 18, 21)])
def test_parameter_planner_frequency_sets_replanning(frequency, least, most):
    planner = Counting()
    assert run(planner, DRIVING, 10, True, planner_frequency=frequency) == (None, None)
    assert least <= len(planner.asked) <= most


@pytest.mark.parametrize("enabled", [True, False])
def test_parameter_recovery_follows_patience_and_renews_it(enabled):
    shout = Shouting()
    limits = {"planner_patience": 1.0, "recoveries": [shout, shout], "recovery_behavior_enabled": enabled}
    end, _ = run(Counting(PlanOutcome.BLOCKED), DRIVING, 60, **limits)
    assert len(shout.started) == 2 * enabled
    if enabled:
        assert shout.started[1] - shout.started[0] > 1.0
        assert end - shout.started[1] > 1.0


@pytest.mark.parametrize(("distance", "ends"), [(0.3, False), (0.7, True)])
def test_parameter_oscillation_distance_resets_the_timeout(distance, ends):
    """To and fro by half a metre."""
    limits = NavigatorLimits(oscillation_timeout=3.0, oscillation_distance=distance, progress_timeout=0.0)
    navigator = Navigator(Costmap(room()), Counting(), DRIVING, [], limits)
    navigator.set_goal(0.0, GOAL)
    results = []
    for i in range(1, 100):
        pose = Pose2D(1.0 + 0.5 * (i // 10 % 2), 1.0)
        results.append(navigator.tick(i / 10, pose, Velocity(), 0.1).result)
        if results[-1]:
            break
    assert bool(results[-1]) == ends


def path(costmap=None, goal=GOAL, start=START, **parameters):
    return GridPlanner(parameters).plan(costmap or Costmap(room()), start, goal)


def test_parameter_default_tolerance_moves_the_goal():
    walled = Costmap(room(walls=[(4.8, 0.8, 5.2, 1.2)]))
    assert path(walled).outcome is PlanOutcome.GOAL_IN_OBSTACLE
    plan = path(walled, default_tolerance=0.6)
    assert plan.outcome is PlanOutcome.FOUND
    assert 0.3 < math.hypot(*(plan.points[-1] - GOAL[:2])) <= 0.6


def test_parameter_escape_distance_limits_the_manoeuvre():
    wall_end = Pose2D(1.0, 0.2)  # the wall ends at 0.1 m, the radius is 0.18 m
    assert path(start=wall_end, escape_distance=0.5).outcome is PlanOutcome.FOUND
    assert path(start=wall_end, escape_distance=0.0).outcome is PlanOutcome.START_BLOCKED


@pytest.mark.parametrize("spacing", [0.1, 0.4])
def test_parameter_spacing_sets_distance_of_poses(spacing):
    gaps = np.hypot(*np.diff(path(spacing=spacing).points, axis=0).T)
    assert spacing * 0.8 < gaps.max() <= spacing + 1e-9


def test_parameter_comfort_widens_corners():
    """Round a corner: closer to it if comfort costs nothing, and if a small clearance is comfortable."""
    corner = room(walls=[(2.0, 0.0, 4.0, 3.0)])

    def clear(**parameters):
        costmap = Costmap(corner, CostmapLimits(inflation_radius=1.0))
        plan = path(costmap, Pose2D(5.0, 2.0), Pose2D(1.0, 2.0), **parameters)
        return min(costmap.clearance[costmap.grid.cell(x, y)] * costmap.resolution for x, y in plan.points)

    assert clear(comfort_weight=0.0) < 0.3
    assert clear(comfort_weight=3.0, comfort_distance=0.5) > 0.5
    assert clear(comfort_weight=3.0, comfort_distance=0.02) < 0.3


def observed(ranges, times=6, yaw=0.0, costmap=None, **limits):
    """A costmap after beams straight ahead from (1, 1) that end at some ranges, one after the other."""
    costmap = costmap or Costmap(room(), CostmapLimits(**limits))
    for distance in ranges:
        for _ in range(times):
            costmap.observe(Pose2D(1.0, 1.0, yaw), np.zeros(1), np.array([distance]), 8.0)
    return costmap


@pytest.mark.parametrize(
    ("distance", "limits", "marked"),
    [
        (2.0, {"obstacle_range": 2.5}, True),
        (2.0, {"obstacle_range": 1.5}, False),
        (4.82, {"static_tolerance": 0.1}, False),  # the wall is 4.9 m away
        (4.82, {"static_tolerance": 0.0}, True),
    ],
)
def test_parameter_obstacle_range_limits_marking(distance, limits, marked):
    assert observed([distance], **limits).has_marks is marked


@pytest.mark.parametrize(("limit", "left"), [(3.0, False), (1.5, True)])
def test_parameter_raytrace_range_limits_clearing(limit, left):
    """Hits are marked beyond the range, too; beams clear only within the range."""
    costmap = observed([2.0], 30, raytrace_range=limit)
    assert np.argwhere(costmap.marks).tolist() == [[20, 60]]
    assert bool(observed([7.9], 30, costmap=costmap).marks[20, 60]) is left


@pytest.mark.parametrize(("threshold", "outcome"), [(100, PlanOutcome.FOUND), (65, PlanOutcome.NO_PATH)])
def test_parameter_lethal_cost_threshold_blocks_cells(threshold, outcome):
    grid = room()
    grid.cells[:, 60] = np.maximum(grid.cells[:, 60], 70)
    assert path(Costmap(grid, CostmapLimits(lethal_threshold=threshold))).outcome is outcome


def test_parameter_inflation_sets_costs():
    cells = np.zeros((21, 21), dtype=np.int8)
    cells[10, 10] = 100
    limits = {"robot_radius": 0.1, "inflation_radius": 0.4}
    soft, hard = (
        Costmap(OccupancyGrid(cells, 0.05), CostmapLimits(**limits, cost_scaling_factor=factor)).costs()[10]
        for factor in (3.0, 20.0)
    )
    assert soft[10] == hard[10] == 100
    assert soft[11] == hard[11] == 99  # within the robot's radius
    assert soft[14] == int(98 * math.exp(-3.0 * (0.175 - 0.1)))
    assert hard[14] == int(98 * math.exp(-20.0 * (0.175 - 0.1)))
    assert soft[17] > 0 == soft[19]  # 0.325 m and 0.425 m away


def test_parameter_reset_distance_limits_cleared_area():
    far = observed([2.0])
    ClearCostmap("reset", {"reset_distance": 5.0}).step(0.0, START, far, RolloutFollower())
    assert far.has_marks
    ClearCostmap("reset", {"reset_distance": 3.0}).step(0.0, START, far, RolloutFollower())
    assert not far.has_marks


def test_parameter_turning_adds_a_recovery():
    turn = RotateRecovery("turn", {"max_vel_theta": 0.5, "patience": 3.0})
    turn.start(0.0, START)
    costmap = Costmap(room())
    steps = [turn.step(i / 10, START, costmap, RolloutFollower()) for i in range(40)]
    assert steps[0].velocity == Velocity(0.0, 0.5)
    assert [step.done for step in steps].index(True) == 31


def drive(goal=GOAL, **parameters):
    """Drive there; return the speeds (n, 2), and the robot's final distance from the goal (m, rad)."""
    driver = Drive(simulation(room(), START, max_turn=9.0, acceleration=9.0, turn_acceleration=90.0))
    driver.navigator.follower = RolloutFollower(parameters)
    speeds = []
    assert driver.to(goal, each=lambda d: speeds.append((d.robot.v, d.robot.w))).outcome is NavigationOutcome.REACHED
    pose = driver.robot.pose
    return np.array(speeds), pose.distance(goal), abs(math.remainder(pose.yaw - goal.yaw, 2 * math.pi))


@pytest.mark.parametrize(
    ("key", "axis", "most", "goal"),
    [("max_vel_x", 0, 0.3, GOAL), ("max_vel_theta", 1, 0.5, Pose2D(1.0, 3.0, 3.0))],
)
def test_parameter_speeds_are_limits(key, axis, most, goal):
    fastest = np.abs(drive(goal, **{key: most})[0][:, axis]).max()
    assert most * (1.0 - 0.2 * axis) - 1e-9 <= fastest <= most + 1e-9


@pytest.mark.parametrize(("key", "axis", "most"), [("acc_lim_x", 0, 0.5), ("acc_lim_theta", 1, 2.0)])
def test_parameter_accelerations_limit_speed_gain(key, axis, most):
    """They do not limit braking."""
    speeds = np.abs(drive(Pose2D(4.0, 3.0, 3.0), **{key: most})[0][:, axis])
    assert most * 0.08 < np.diff(speeds).max() <= most * 0.1 + 1e-6


@pytest.mark.slow
def test_parameter_goal_tolerances_end_the_drive():
    assert drive(xy_goal_tolerance=0.05)[1] <= 0.05
    assert 0.1 < drive(xy_goal_tolerance=0.5)[1] <= 0.5
    assert drive(Pose2D(5.0, 1.0, 2.0), yaw_goal_tolerance=0.05)[2] <= 0.05
    assert 0.2 < drive(Pose2D(5.0, 1.0, 2.0), yaw_goal_tolerance=1.0)[2] <= 1.0
