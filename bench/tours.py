#!/usr/bin/env python3
"""Drives tours of random goals on random maps, without ROS: goals reached, collisions, and the time until an abort.

The maps are office floors (54 x 58.7 m, 0.1 m a cell) and small floors of rooms with narrow doors and clutter (10 x
10 m, 0.05 m a cell). There are also obstacles and robots that the map lacks. During some drives (--events in ten) a
door closes, or an obstacle appears in front of the robot, permanently or for a while. Unless --plain is given, other
properties vary too: the body of the robot, the noise of its laser, the resolution and roughness of the map.

How a goal must end depends on the obstacles at the end of the drive:
  reached     if a path leads to it for the robot's circumscribed circle and obstacles that are 8 cm larger
  impossible  if no path leads to it for the inscribed circle and obstacles that are 3 cm smaller
  either      otherwise
A goal that must be reached and is aborted counts as MISSED.

Run it in the built workspace: ./dev exec python3 bench/tours.py
With the nodes, or with Stage and move_base: bench/ros_tours.py
"""

import math
import time
from typing import Callable, Iterable, Iterator, NamedTuple, Tuple

import numpy as np
from figures import Figure, Option, main
from navigation_worlds import ERRATIC, LONG, Drive
from tour_floors import Floor, office_floor, rough, small_floor

from rosoclingo.robot.navigation import (
    Costmap,
    CostmapLimits,
    GridPlanner,
    NavigationOutcome,
    OccupancyGrid,
    PlanOutcome,
    Pose2D,
)
from rosoclingo.robot.navigation.compiled.outlines import crosses, segment_distance
from rosoclingo.robot.navigation.local_planner import inscribed_radius
from rosoclingo.robot.simulation import DoorSpec, LaserSpec, ObstacleSpec, RobotSpec, Simulation, WorldError, WorldSpec

SPARE, LACK = 0.08, -0.03  # m: growth of obstacles with which a path must be found, and with which it can be found
LIMIT = 3000.0  # simulated s, time limit of a goal
SETTLED = 90.0  # s without a change after which an abort is judged by the present obstacles
SPEED = 0.65  # m/s
BODIES = {"disc": (), "erratic": ERRATIC, "long": LONG}


class Variant(NamedTuple):
    """The parameters that vary from tour to tour; without a resolution (m), the map has its own."""

    resolution: float = 0.0
    footprint: Tuple[Tuple[float, float], ...] = ()
    noise: float = 0.01
    rough: bool = False

    @property
    def reach(self) -> float:
        """The radius (m) of the robot's circumscribed circle."""
        return max((math.hypot(*corner) for corner in self.footprint), default=0.18)

    def floor(self, kind: str, random, seed: int) -> Floor:
        if kind == "small":
            floor = small_floor(random, self.resolution or 0.05)
        else:
            floor = office_floor(seed, self.resolution or 0.1)
        return rough(floor, random) if self.rough else floor


def varied(kind: str, random) -> Variant:
    return Variant(
        resolution=float(random.choice((0.05, 0.1, 0.025) if kind == "small" else (0.1, 0.05))),
        footprint=((), (), ERRATIC, LONG)[random.integers(4)],
        noise=float(random.choice((0.0, 0.01, 0.03))),
        rough=bool(random.integers(2)),
    )


def leads_through(points: np.ndarray, door: DoorSpec) -> bool:
    """Return whether the path along ``points`` leads through a door."""
    return any(crosses(*a, *b, *door.start, *door.end) for a, b in zip(points, points[1:]))


class Tour:
    """A tour of one robot to several goals on one map.

    Attributes:
        changed: the simulated time (s) of the last change of a door or an obstacle during the present drive.
        event: this change, as text.

    """

    clock = staticmethod(time.process_time)
    """The clock (s) of the figure pace."""

    def __init__(self, floor: Floor, variant: Variant, random, things: int, events: float) -> None:
        self.grid, self.random, self.variant, self.events = floor.grid, random, variant, events
        room = max(0.3, variant.reach + 0.02)
        clearance = Costmap(self.grid, CostmapLimits(inflation_radius=0.6)).clearance * self.grid.resolution
        self.free = np.argwhere((clearance > room) & (self.grid.cells >= 0))
        start = self.somewhere()
        spots = [self.somewhere() for _ in range(things)]
        spots = [spot for spot in spots if start.distance(spot) > 0.8]
        standing = [] if events == 0.0 else spots[::4]
        standing = [spot for i, spot in enumerate(standing) if all(spot.distance(o) > 0.5 for o in standing[:i])]
        laser = LaserSpec(range=6.0, angle=270.0, beams=1081, noise=variant.noise)
        robots = [RobotSpec(pose=start, footprint=variant.footprint, max_speed=SPEED, lasers=(laser,))]
        robots += [RobotSpec(f"standing{i}", spot, lasers=()) for i, spot in enumerate(standing)]
        obstacles = [
            ObstacleSpec(str(i), spot[:2], radius=random.uniform(0.1, 0.3))
            for i, spot in enumerate(spots)
            if all(spot.distance(other) > 0.5 for other in standing)
        ]
        spec = WorldSpec(self.grid, (), tuple(floor.doors), tuple(obstacles), interval=0.05)
        robots = [robot for robot in robots if self.stands(spec, robot)]
        self.world = Simulation(spec._replace(robots=tuple(robots)))
        self.drive = Drive(self.world, control=2, scan=2)
        self.standing = [robot.pose for robot in self.world.robots.values()][1:]

    @staticmethod
    def stands(spec: WorldSpec, robot: RobotSpec) -> bool:
        try:
            Simulation(spec._replace(robots=(robot,)))
        except WorldError:
            return False
        return True

    @property
    def time(self) -> float:
        """The simulated time in seconds."""
        return self.world.time

    @property
    def collisions(self) -> int:
        """The number of collisions so far."""
        return len(self.drive.collisions)

    def somewhere(self) -> Pose2D:
        return Pose2D(*self.grid.centre(*self.free[self.random.integers(len(self.free))]), self.random.uniform(-3, 3))

    def with_things(self, more: float) -> OccupancyGrid:
        """Return the map with all present obstacles, enlarged by ``more`` (m)."""
        cells, scale = self.grid.cells.copy(), self.grid.resolution
        discs = [(*thing.at, thing.radius) for thing in self.world.obstacles.values()]
        discs += [(pose.x, pose.y, 0.18) for pose in self.standing]
        for door in self.world.doors.values():
            if not door.open:
                points = np.linspace(door.start, door.end, 2 + int(math.dist(door.start, door.end) / scale * 2))
                discs += [(*point, max(0.0, -more) + 0.75 * scale) for point in points]
        for x, y, radius in discs:
            reach = radius + more
            low, high = self.grid.cell(x - reach, y - reach), self.grid.cell(x + reach, y + reach)
            part = (slice(max(0, low[0]), high[0] + 1), slice(max(0, low[1]), high[1] + 1))
            rows, columns = np.mgrid[part[0], part[1]]
            near = np.hypot((columns + 0.5) * scale - x, (rows + 0.5) * scale - y) <= reach
            cells[part][near[: cells[part].shape[0], : cells[part].shape[1]]] = 100
        return OccupancyGrid(cells, scale)

    def plan(self, goal: Pose2D, more: float, radius: float):
        costmap = Costmap(self.with_things(more), CostmapLimits(robot_radius=radius))
        return GridPlanner().plan(costmap, self.drive.robot.pose, goal)

    def disturb(self, points: np.ndarray) -> Iterator[None]:
        """Close a door on the path or put an obstacle before the robot, and undo it later in some drives.

        It advances by one step of the simulation at a time.
        """
        world, random, robot, since = self.world, self.random, self.drive.robot, self.time
        duration = random.uniform(5.0, 60.0) if random.random() < 0.4 else math.inf
        distance = random.uniform(0.8, 6.0)
        doors = [door for door in world.doors.values() if door.open and leads_through(points, door)]
        door = doors[random.integers(len(doors))] if doors and random.random() < 0.6 else None
        wait = random.uniform(2.0, 20.0)
        if door:
            while not 0.5 < segment_distance(*robot.pose[:2], *door.start, *door.end) - self.variant.reach < distance:
                yield
            yield from self.change(f"{door.name} {distance:.1f} m ahead", lambda: world.set_door(door.name, False))
            undo = lambda: world.set_door(door.name, True)  # noqa: E731
        else:
            while self.time - since <= wait or robot.v <= 0.3:
                yield
            radius = random.uniform(0.1, 0.25)
            ahead = robot.pose.advance(self.variant.reach + radius + random.uniform(0.5, 1.2), 0.0, 1.0)
            thing = ObstacleSpec(f"sudden{world.steps}", ahead[:2], radius=radius)
            yield from self.change("an obstacle ahead", lambda: world.put_obstacle(thing))
            undo = lambda: world.remove_obstacle(thing.name)  # noqa: E731
        while self.time - self.changed <= duration:
            yield
        yield from self.change(self.event, undo)

    def change(self, event: str, work: Callable[[], None]) -> Iterator[None]:
        """Change a door or an obstacle; never go on if the robot is in the way."""
        self.event = event
        try:
            work()
        except WorldError:
            while True:
                yield
        self.changed = self.time

    def drive_to(self, goal: Pose2D, points: np.ndarray) -> Tuple[bool, str]:
        """Drive to a goal, with an event if there is a path; return whether the goal is reached, and why not."""
        event = self.disturb(points) if len(points) else iter(())
        result = self.drive.to(goal, LIMIT, lambda drive: next(event, None))
        return result.outcome is NavigationOutcome.REACHED, f"{result.outcome.name}: {result.message}"

    def go(self) -> str:
        """Drive to a random goal; return how it ended, as text."""
        goal, since = self.somewhere(), self.time
        self.changed, self.event = -math.inf, ""
        here = tuple(self.drive.robot.pose)
        way = self.plan(goal, SPARE, self.variant.reach)
        eventful = way.outcome is PlanOutcome.FOUND and self.random.random() < self.events if self.events else False
        try:
            reached, reason = self.drive_to(goal, way.points if eventful else ())
        except AssertionError:
            return f"NO END within {LIMIT} s: {here} -> {tuple(goal)}"
        if reached:
            return "reached"
        words = f"after {self.time - since:.0f} s, {self.event}: {here} -> {tuple(goal)}: {reason}"
        if self.time - self.changed < SETTLED:
            return f"either, {words}"
        if self.plan(goal, SPARE, self.variant.reach).outcome is PlanOutcome.FOUND:
            return f"MISSED, {words}"
        inner = inscribed_radius(0.18, self.variant.footprint)
        possible = self.plan(goal, LACK, inner).outcome is PlanOutcome.FOUND
        return f"{'either' if possible else 'impossible'}, {words}"


def drive_all(tours: Iterable[Tour], goals: int) -> Iterator[Figure]:
    """Drive some tours to ``goals`` goals each and print the goals that are not reached; yield the figures."""
    ends, longest, collisions, simulated, spent = [], 0.0, 0, 0.0, 0.0
    for place, tour in enumerate(tours):
        start, begin = tour.time, tour.clock()
        for number in range(goals):
            since, text = tour.time, tour.go()
            ends.append(text.split(",")[0].split(" within")[0])
            if text != "reached":
                longest = max(longest, tour.time - since)
                print(f"floor {place}, goal {number}, {tuple(tour.variant)}: {text}", flush=True)
        collisions += tour.collisions
        simulated += tour.time - start
        spent += tour.clock() - begin
    for end in ("reached", "impossible", "either", "MISSED", "NO END"):
        yield Figure(end, ends.count(end), "goals", "higher" if end == "reached" else "lower")
    yield Figure("collisions", collisions, "")
    yield Figure("longest abort", longest, "simulated s")
    yield Figure("pace", simulated / spent, "simulated s per s", "higher")


def tours_of(options) -> Iterator[Tour]:
    kinds = ["small"] * options.small + ["office"] * options.offices
    for seed, kind in enumerate(kinds, options.seed):
        random = np.random.default_rng(seed)
        variant = Variant() if options.plain else varied(kind, random)
        if options.body != "varied":
            variant = variant._replace(footprint=BODIES[options.body])
        yield Tour(
            variant.floor(kind, random, seed), variant, random, 6 if kind == "small" else 60, options.events / 10
        )


if __name__ == "__main__":
    main(
        __doc__,
        lambda options: drive_all(tours_of(options), options.goals),
        small=Option(20, "number of small floors", 3),
        offices=Option(2, "number of office floors", 0),
        goals=Option(5, "goals on each floor", 3),
        seed=Option(0, "seed of the first floor"),
        events=Option(4, "drives in ten with an event"),
        plain=Option(False, "use a disc, and straight maps without roughness", True),
        body=Option("varied", "body of the robot on all floors", choices=["varied", *BODIES]),
    )
