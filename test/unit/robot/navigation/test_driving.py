"""Navigation drives simulated robots: everything reached that can be, nothing touched, and an end with a reason."""

import math
from pathlib import Path

import numpy as np
import pytest
import yaml
from navigation_worlds import LONG, Drive, room, simulation

from rosoclingo.robot.navigation import (
    Costmap,
    CostmapLimits,
    GridPlanner,
    NavigationError,
    NavigationOutcome,
    Navigator,
    NavigatorLimits,
    NavigatorState,
    OccupancyGrid,
    PlanOutcome,
    Pose2D,
    RolloutFollower,
    Velocity,
    default_recoveries,
)
from rosoclingo.robot.simulation import DoorSpec, LaserSpec, ObstacleSpec, RobotSpec, Simulation, WorldSpec, load_world

ROOT = Path(__file__).resolve().parents[4]
START = Pose2D(1.0, 1.0)
WALL = (2.9, 0.0, 3.1, 4.0)  # between two halves of a room, with a way round it


@pytest.mark.slow
@pytest.mark.once
def test_the_labels_of_the_office():
    world = Simulation(load_world(ROOT / "worlds" / "office_world.yaml"))
    labels = yaml.safe_load((ROOT / "config" / "office_labels.yaml").read_text())
    drive = Drive(world)
    for name in ("office4", "office2"):
        goal = Pose2D(**labels[name])
        assert drive.to(goal).outcome is NavigationOutcome.REACHED
        assert drive.robot.pose.distance(goal) < 0.15
        assert abs(drive.robot.pose.yaw - goal.yaw) < 0.15
    assert drive.collisions == []


@pytest.mark.slow
@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(one, marks=[pytest.mark.slow, pytest.mark.once]) for one in range(1, 4))]
)
def test_tours_of_random_goals_among_unmapped_obstacles(seed):
    random = np.random.default_rng(seed)
    walls = [
        (x, y, x + random.uniform(0.2, 2.0), y + random.uniform(0.2, 2.0)) for x, y in random.uniform(1, 9, (6, 2))
    ]
    grid = room(10.0, 10.0, 0.05, walls)
    roomy = Costmap(grid, CostmapLimits(inflation_radius=0.6))
    free = np.argwhere(roomy.clearance * grid.resolution > 0.35)

    def somewhere():
        return Pose2D(*grid.centre(*free[random.integers(len(free))]), random.uniform(-3, 3))

    start = somewhere()
    obstacles = [ObstacleSpec(str(i), somewhere()[:2], radius=random.uniform(0.1, 0.3)) for i in range(6)]
    obstacles = [o for o in obstacles if math.hypot(o.at[0] - start.x, o.at[1] - start.y) > 0.8]
    drive = Drive(simulation(grid, start, obstacles=tuple(obstacles)))
    rows, columns = np.indices(grid.shape)
    x, y = (columns + 0.5) * grid.resolution, (rows + 0.5) * grid.resolution
    # With a little to spare: what noise makes bigger must still be passable.
    taken = np.any([np.hypot(x - o.at[0], y - o.at[1]) <= o.radius + 0.08 for o in obstacles], axis=0)
    known = Costmap(OccupancyGrid(np.where(taken, 100, grid.cells).astype(np.int8), grid.resolution))
    for _ in range(5):
        goal = somewhere()
        possible = GridPlanner().plan(known, drive.robot.pose, goal).outcome is PlanOutcome.FOUND
        result = drive.to(goal)
        if possible:
            assert result.outcome is NavigationOutcome.REACHED, result
        if result.outcome is NavigationOutcome.REACHED:
            assert drive.robot.pose.distance(goal) < 0.2
    assert drive.collisions == []


def test_a_goal_in_a_wall_ends_at_once():
    drive = Drive(simulation(room(walls=[WALL]), Pose2D(1.0, 1.0)))
    result = drive.to(Pose2D(3.0, 2.0))
    assert result.outcome is NavigationOutcome.NO_PLAN
    assert "in an obstacle of the map" in result.message
    assert drive.world.time < 1.0


def test_an_enclosed_goal_ends_at_once():
    drive = Drive(simulation(room(walls=[(2.9, 0.0, 3.1, 6.0)]), Pose2D(1.0, 1.0)))
    assert "no path leads to the goal on the map" in drive.to(Pose2D(5.0, 1.0)).message


def test_a_goal_off_the_map_ends_at_once():
    drive = Drive(simulation(room(), Pose2D(1.0, 1.0)))
    assert "outside of the map" in drive.to(Pose2D(50.0, 1.0)).message


@pytest.mark.slow
def test_a_goal_that_something_unmapped_stands_on():
    crate = ObstacleSpec("crate", (5.0, 1.0), radius=0.3)
    drive = Drive(simulation(room(), Pose2D(1.0, 1.0), obstacles=(crate,)))
    result = drive.to(Pose2D(4.8, 1.0))
    assert result.outcome is NavigationOutcome.NO_PLAN
    assert "something that is not on the map" in result.message
    assert drive.recoveries == ["conservative_reset", "rotate_recovery", "aggressive_reset", "rotate_recovery"]
    assert drive.collisions == []


def door_world(*more):
    """Two halves with a door between them at the bottom and, for some tests, a way round at the top."""
    door = DoorSpec("door", (3.0, 0.0), (3.0, 2.0), open=True)
    walls = [(2.9, 2.0, 3.1, 5.0), *more]
    return simulation(room(walls=walls), Pose2D(1.0, 1.0), doors=(door,))


@pytest.mark.slow
def test_a_door_that_closes_on_the_way_is_gone_round():
    drive = Drive(door_world())

    def close(drive):
        if drive.robot.pose.x > 1.8 and drive.world.doors["door"].open:
            drive.world.set_door("door", False)

    assert drive.to(Pose2D(5.0, 1.0), each=close).outcome is NavigationOutcome.REACHED
    assert not drive.world.doors["door"].open
    assert drive.collisions == []


@pytest.mark.slow
@pytest.mark.once
def test_a_door_closed_for_good_ends_with_the_reason():
    drive = Drive(door_world((2.9, 4.9, 3.1, 6.0)))
    drive.world.set_door("door", False)
    result = drive.to(Pose2D(5.0, 1.0), limit=300.0)
    assert result.outcome is NavigationOutcome.NO_PLAN
    assert "blocked by something that is not on the map" in result.message
    assert drive.collisions == []


@pytest.mark.slow
def test_a_door_that_opens_again_lets_the_robot_through():
    drive = Drive(door_world((2.9, 4.9, 3.1, 6.0)))
    drive.world.set_door("door", False)

    def reopen(drive):
        if drive.recoveries:
            drive.world.set_door("door", True)

    assert drive.to(Pose2D(5.0, 1.0), each=reopen).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []


def test_a_robot_that_is_carried_away_drives_on_from_there():
    drive = Drive(simulation(room(walls=[WALL]), Pose2D(1.0, 1.0)))

    def carry(drive):
        if drive.robot.pose.x > 2.0 and drive.robot.pose.y < 3.0 and not carried:
            carried.append(True)
            drive.world.place("robot_0", Pose2D(1.0, 5.0, 0.0))

    carried = []
    assert drive.to(Pose2D(5.0, 1.0), each=carry).outcome is NavigationOutcome.REACHED
    assert carried


@pytest.mark.slow
def test_a_rectangular_robot():
    world = simulation(
        room(8.0, 8.0, 0.05, walls=[(3.9, 0.0, 4.1, 3.4), (3.9, 4.6, 4.1, 8.0)]),
        Pose2D(1.5, 1.5),
        footprint=((0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2)),
    )
    drive = Drive(world)
    for goal in (Pose2D(6.5, 6.5, 0.0), Pose2D(1.5, 6.5, 1.5), Pose2D(6.0, 2.0, -1.5)):
        assert drive.to(goal).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []


@pytest.mark.mostly_slow
@pytest.mark.parametrize("footprint", [(), LONG])
def test_past_a_patch_that_the_map_does_not_know(footprint):
    """The way keeps off it, as the planner of move_base does; the robot's sides may be over it."""
    grid = room(6.0, 6.0)
    rows, columns = np.indices(grid.shape)
    grid.cells[np.hypot(rows - 60, columns - 60) < 30] = -1
    drive = Drive(simulation(grid, Pose2D(0.6, 2.9), footprint=footprint))
    for goal in (Pose2D(5.4, 3.1, 1.5), Pose2D(3.1, 0.6, 0.0), Pose2D(2.9, 5.4, 0.0)):
        assert drive.to(goal, limit=120.0).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []


@pytest.mark.slow
def test_the_robot_gives_up_when_it_cannot_move():
    """Its wheels do not turn: no progress, recovery, and an end in bounded time."""
    drive = Drive(
        simulation(room(), Pose2D(1.0, 1.0), max_speed=0.0, max_turn=0.0), NavigatorLimits(progress_timeout=5.0)
    )
    result = drive.to(Pose2D(5.0, 1.0), limit=300.0)
    assert result.outcome is NavigationOutcome.NO_PROGRESS
    assert "has not become shorter" in result.message


def test_oscillation_is_told():
    limits = NavigatorLimits(oscillation_timeout=5.0, recovery_behavior_enabled=False)
    drive = Drive(simulation(room(), Pose2D(1.0, 1.0), max_speed=0.0), limits)
    result = drive.to(Pose2D(5.0, 1.0))
    assert result.outcome is NavigationOutcome.OSCILLATING
    assert "moved less than 0.5 m" in result.message


class Fixed:
    """A navigator in a room with its costmap, for calls without a simulation."""

    def __init__(self, limits=None):
        self.costmap = Costmap(room())
        self.navigator = Navigator(self.costmap, GridPlanner(), RolloutFollower(), default_recoveries(), limits)

    def tick(self, now, pose=START):
        return self.navigator.tick(now, pose, Velocity(), 0.1)


def test_a_tick_without_a_goal_is_an_error():
    with pytest.raises(NavigationError):
        Fixed().tick(0.0)


def test_blindness_stops_the_robot_and_ends_the_goal_after_patience():
    fixed = Fixed(NavigatorLimits(controller_patience=3.0))
    fixed.navigator.set_goal(0.0, Pose2D(5.0, 1.0))
    assert fixed.tick(0.1).velocity != Velocity()
    for now in (1.0, 2.0, 4.0):
        tick = fixed.navigator.blind(now, NavigationOutcome.LASER_LOST, "no scan")
        assert tick == (Velocity(), None)
    assert fixed.navigator.blind(4.1, NavigationOutcome.LASER_LOST, "no scan").result == (
        NavigationOutcome.LASER_LOST,
        "no scan",
    )
    assert fixed.navigator.state is NavigatorState.IDLE


def test_sight_again_renews_patience():
    fixed = Fixed(NavigatorLimits(controller_patience=3.0))
    fixed.navigator.set_goal(0.0, Pose2D(5.0, 1.0))
    fixed.navigator.blind(1.0, NavigationOutcome.LASER_LOST, "no scan")
    fixed.tick(3.0)
    assert fixed.navigator.blind(5.0, NavigationOutcome.LASER_LOST, "no scan").result is None


def test_time_that_goes_back_costs_no_patience():
    fixed = Fixed()
    fixed.navigator.set_goal(100.0, Pose2D(5.0, 1.0))
    fixed.tick(100.1)
    told = []
    fixed.navigator.on_log = told.append
    assert fixed.tick(1.0).result is None
    assert fixed.navigator.active
    assert "Time went back" in told[0]


def test_cancelling_and_a_new_goal():
    fixed = Fixed()
    fixed.navigator.cancel()
    fixed.navigator.set_goal(0.0, Pose2D(5.0, 1.0))
    fixed.tick(0.1)
    assert fixed.navigator.state is NavigatorState.CONTROLLING
    fixed.navigator.set_goal(0.2, Pose2D(1.0, 5.0))
    assert fixed.navigator.state is NavigatorState.PLANNING
    fixed.navigator.cancel()
    assert not fixed.navigator.active


@pytest.mark.slow
def test_two_robots_pass_each_other_in_a_corridor():
    grid = room(10.0, 2.0)
    laser = LaserSpec(range=6.0, noise=0.01)
    robots = (
        RobotSpec("a", Pose2D(1.0, 1.0, 0.0), lasers=(laser,)),
        RobotSpec("b", Pose2D(9.0, 1.0, math.pi), lasers=(laser,)),
    )
    world = Simulation(WorldSpec(grid, robots))
    goals = {"a": Pose2D(9.0, 1.0, 0.0), "b": Pose2D(1.0, 1.0, math.pi)}
    navigators = {}
    for name, goal in goals.items():
        navigators[name] = Navigator(Costmap(grid), GridPlanner(), RolloutFollower(), default_recoveries())
        navigators[name].set_goal(0.0, goal)
    results, collisions = {}, []
    while len(results) < 2 and world.time < 300.0:
        for name, navigator in navigators.items():
            robot = world.robots[name]
            ranges = world.scan(name).astype(np.float64)
            if navigator.costmap.observe(robot.pose.compose(laser.pose), robot.lasers[0].angles, ranges, laser.range):
                navigator.obstacles_changed()
            if navigator.active:
                tick = navigator.tick(world.time, robot.pose, Velocity(robot.v, robot.w), 0.1)
                world.command(name, *tick.velocity)
                if tick.result:
                    results[name] = tick.result.outcome
        collisions += world.step()
    assert results == {"a": NavigationOutcome.REACHED, "b": NavigationOutcome.REACHED}
    assert collisions == []


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("seed", range(3))
def test_a_tight_door_is_not_touched(seed):
    """Four and a half centimetres on either side, entered from anywhere, to and fro."""
    random = np.random.default_rng(seed)
    gap = 2.0 + 0.05 * random.integers(0, 20)
    drive = Drive(simulation(room(6.0, 5.0, walls=[(2.9, 0.0, 3.1, gap), (2.9, gap + 0.45, 3.1, 5.0)]), START))
    for i in range(4):
        goal = Pose2D((4.8, 1.2)[i % 2], random.uniform(0.6, 4.4), random.uniform(-3.0, 3.0))
        assert drive.to(goal).outcome is NavigationOutcome.REACHED
    assert drive.collisions == []
