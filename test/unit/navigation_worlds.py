"""Maps and drives that the tests of navigation and simulation share."""

import numpy as np

from rosoclingo.robot.navigation import (
    Costmap,
    CostmapLimits,
    GridPlanner,
    Navigator,
    OccupancyGrid,
    RolloutFollower,
    Velocity,
    default_recoveries,
)
from rosoclingo.robot.navigation.local_planner import inscribed_radius, path_radii
from rosoclingo.robot.simulation import LaserSpec, RobotSpec, Simulation, WorldSpec

# Footprints (m): an Erratic's, whose origin is off-centre, and one that is longer than wide.
ERRATIC = ((-0.225, -0.175), (-0.225, 0.175), (0.125, 0.175), (0.125, -0.175))
LONG = ((0.3, 0.2), (-0.3, 0.2), (-0.3, -0.2), (0.3, -0.2))
LASER = LaserSpec(range=6.0, noise=0.01)


def grid_of(rows, resolution=0.1):
    """Return a grid drawn by lines of text, the first one on top: '#' occupied, '?' unknown, else free."""
    cells = {"#": 100, "?": -1}
    return OccupancyGrid(np.array([[cells.get(c, 0) for c in row] for row in rows[::-1]], dtype=np.int8), resolution)


def room(width=6.0, height=6.0, resolution=0.05, walls=()):
    """Return a room with walls around it; ``walls``: (x0, y0, x1, y1) in m, filled."""
    cells = np.zeros((round(height / resolution), round(width / resolution)), dtype=np.int8)
    cells[:2] = cells[-2:] = 100
    cells[:, :2] = cells[:, -2:] = 100
    for wall in walls:
        x0, y0, x1, y1 = np.rint(np.divide(wall, resolution)).astype(int)
        cells[y0:y1, x0:x1] = 100
    return OccupancyGrid(cells, resolution)


def simulation(grid, pose, doors=(), obstacles=(), laser=LASER, **robot):
    return Simulation(
        WorldSpec(grid, (RobotSpec(pose=pose, lasers=(laser,) if laser else (), **robot),), doors, obstacles)
    )


class Drive:
    """A navigator that drives a simulated robot whose pose it knows.

    It ticks every ``control`` steps of the world, receives a scan every ``scan`` steps, and its commands are ``late``
    steps. It drives the robot of this ``name``, by default the first one.
    """

    def __init__(self, world, limits=None, control=1, scan=1, late=0, name=None, **costmap):
        self.world = world
        self.robot = next(iter(world.robots.values())) if name is None else world.robots[name]
        spec = self.robot.spec
        radius = inscribed_radius(spec.radius, spec.footprint)
        ways = path_radii(radius, spec.footprint)
        self.costmap = Costmap(world.spec.grid, CostmapLimits(robot_radius=radius, path_radii=ways, **costmap))
        follower = RolloutFollower(radius=radius, footprint=spec.footprint)
        self.navigator = Navigator(self.costmap, GridPlanner(), follower, default_recoveries(), limits)
        self.collisions = []
        self.recoveries = []
        self.navigator.on_recovery = lambda behavior, *rest: self.recoveries.append(behavior.name)
        self._rhythm, self._under_way = (control, scan, late), []

    def to(self, goal, limit=2000.0, each=lambda drive: None):
        """Drive to a pose; return the result. Fail without one in ``limit`` simulated s."""
        self.navigator.set_goal(self.world.time, goal)
        end = self.world.time + limit
        while self.world.time < end:
            each(self)
            result = self.step()
            if result:
                return result
        raise AssertionError(f"no end within {limit} s")

    def step(self):
        """Advance by one step of the world; return the result if the goal ends."""
        result = self.command()
        self.collisions += self.world.step()
        return result

    def command(self):
        """Perceive, find the next command, and send those that are due; return the result if the goal ends."""
        number, name, result = self.world.steps, self.robot.spec.name, None
        control, scan, late = self._rhythm
        if number % scan == 0:
            self.look()
        if number % control == 0 and self.navigator.active:
            tick = self.tick(control * self.world.spec.interval)
            self._under_way.append((number + late, tick.velocity))
            result = tick.result
        while self._under_way and self._under_way[0][0] <= number:
            self.world.command(name, *self._under_way.pop(0)[1])
        return result

    def look(self):
        """Take a scan."""
        laser = self.robot.lasers[0]
        ranges = self.world.scan(self.robot.spec.name).astype(np.float64)
        if self.costmap.observe(self.robot.pose.compose(laser.spec.pose), laser.angles, ranges, laser.spec.range):
            self.navigator.obstacles_changed()

    def tick(self, period):
        """Let the navigator find the next command."""
        velocity = Velocity(self.robot.v, self.robot.w)
        return self.navigator.tick(self.world.time, self.robot.pose, velocity, period)
