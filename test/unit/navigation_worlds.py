"""Maps and drives that the tests of navigation and simulation share."""

import numpy as np

from rosoclingo.navigation import (
    Costmap,
    CostmapLimits,
    GridPlanner,
    Navigator,
    OccupancyGrid,
    RolloutFollower,
    Velocity,
    default_recoveries,
)
from rosoclingo.simulation import LaserSpec, RobotSpec, Simulation, WorldSpec

LASER = LaserSpec(range=6.0, noise=0.01)


def grid_of(rows, resolution=0.1):
    """A grid drawn by lines of text, the first one on top: '#' occupied, '?' unknown, else free."""
    cells = {"#": 100, "?": -1}
    return OccupancyGrid(np.array([[cells.get(c, 0) for c in row] for row in rows[::-1]], dtype=np.int8), resolution)


def room(width=6.0, height=6.0, resolution=0.05, walls=()):
    """A room with walls around it; ``walls``: (x0, y0, x1, y1) in m, filled."""
    cells = np.zeros((round(height / resolution), round(width / resolution)), dtype=np.int8)
    cells[:2] = cells[-2:] = 100
    cells[:, :2] = cells[:, -2:] = 100
    for x0, y0, x1, y1 in walls:
        cells[round(y0 / resolution) : round(y1 / resolution), round(x0 / resolution) : round(x1 / resolution)] = 100
    return OccupancyGrid(cells, resolution)


def simulation(grid, pose, doors=(), obstacles=(), laser=LASER, **robot):
    return Simulation(WorldSpec(grid, (RobotSpec(pose=pose, laser=laser, **robot),), doors, obstacles))


class Drive:
    """A navigator that drives a simulated robot whose pose it knows."""

    def __init__(self, world, limits=None, **costmap):
        self.world = world
        self.robot = next(iter(world.robots.values()))
        self.costmap = Costmap(world.spec.grid, CostmapLimits(robot_radius=self.robot.spec.radius, **costmap))
        follower = RolloutFollower(radius=self.robot.spec.radius, footprint=self.robot.spec.footprint)
        self.navigator = Navigator(self.costmap, GridPlanner(), follower, default_recoveries(), limits)
        self.collisions = []
        self.recoveries = []
        self.navigator.on_recovery = lambda behavior, *rest: self.recoveries.append(behavior.name)

    def to(self, goal, limit=2000.0, each=lambda drive: None):
        """Drive to a pose; return the result. Fails where there is none in ``limit`` simulated s."""
        self.navigator.set_goal(self.world.time, goal)
        end = self.world.time + limit
        while self.world.time < end:
            each(self)
            laser = self.robot.laser
            ranges = self.world.scan(self.robot.spec.name).astype(np.float64)
            if self.costmap.observe(self.robot.pose.compose(laser.spec.pose), laser.angles, ranges, laser.spec.range):
                self.navigator.obstacles_changed()
            velocity = Velocity(self.robot.v, self.robot.w)
            tick = self.navigator.tick(self.world.time, self.robot.pose, velocity, self.world.spec.interval)
            self.world.command(self.robot.spec.name, *tick.velocity)
            self.collisions += self.world.step()
            if tick.result:
                return tick.result
        raise AssertionError(f"no end within {limit} s")
