#!/usr/bin/env python3
"""Drives tours of random goals on random maps, without ROS: goals reached, collisions, and the time until an abort.

The maps are an office floor (54 x 58.7 m, 0.1 m a cell) and small floors of rooms with narrow doors and clutter (10 x
10 m, 0.05 m a cell). There are also obstacles and robots that the map lacks. During some drives (--events in ten) a
door closes, or an obstacle appears in front of the robot, permanently or for a while. Unless --plain is given, other
properties vary too: the body of the robot, the resolution, slant and roughness of the map, the control rate and the
delay of commands.

How a goal must end depends on the obstacles at the end of the drive:
  reached     if a path leads to it for the robot's circumscribed circle and obstacles that are 8 cm larger
  impossible  if no path leads to it for the inscribed circle and obstacles that are 3 cm smaller
  either      otherwise
A goal that must be reached and is aborted counts as MISSED.

Run it in the built workspace: ./dev exec python3 bench/tours.py
"""

import math
import statistics
import sys
import time
from pathlib import Path
from typing import Iterator, List, NamedTuple, Tuple

import numpy as np
from figures import Figure, Option, main, quantiles

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "test" / "unit")]
# ruff: noqa: E402

from navigation_worlds import ERRATIC, LONG, Drive
from tour_floors import Floor, office_floor, rough, small_floor, turned

from rosoclingo.robot.navigation import (
    Costmap,
    CostmapLimits,
    GridPlanner,
    NavigationOutcome,
    OccupancyGrid,
    PlanOutcome,
    Pose2D,
)
from rosoclingo.robot.navigation.local_planner import inscribed_radius
from rosoclingo.robot.simulation import LaserSpec, ObstacleSpec, RobotSpec, Simulation, WorldError, WorldSpec

SPARE, LACK = 0.08, -0.03  # m: growth of obstacles with which a path must be found, and with which it can be found
LIMIT = 3000.0  # simulated s, time limit of a goal
SETTLED = 90.0  # s without a change after which an abort is judged by the present obstacles
SPEED = 0.65  # m/s
BODIES = {"disc": (), "erratic": ERRATIC, "long": LONG}


class Variant(NamedTuple):
    """The parameters that vary from tour to tour; ``control`` and ``late`` are in steps of 0.05 s."""

    resolution: float = 0.0
    footprint: Tuple[Tuple[float, float], ...] = ()
    control: int = 2
    late: int = 0
    noise: float = 0.01
    slant: float = 0.0
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
        if self.slant:
            floor = turned(floor, self.slant)
        return rough(floor, random) if self.rough else floor


def varied(kind: str, random) -> Variant:
    return Variant(
        resolution=float(random.choice((0.05, 0.1, 0.025) if kind == "small" else (0.1, 0.05))),
        footprint=((), (), ERRATIC, LONG)[random.integers(4)],
        control=int(random.choice((1, 2, 4))),
        late=int(random.integers(3)),
        noise=float(random.choice((0.0, 0.01, 0.03))),
        slant=float(random.choice((0.0, random.uniform(-0.8, 0.8)))),
        rough=bool(random.integers(2)),
    )


class Event:
    """An event during a drive: a door closes, or an obstacle appears in front of the robot."""

    def __init__(self, tour: "Tour", points: np.ndarray) -> None:
        self.tour, self.points, self.random = tour, points, tour.random
        self.since, self.undo, self.changed = tour.drive.world.time, None, -math.inf
        self.again = self.random.uniform(5.0, 60.0) if self.random.random() < 0.4 else math.inf
        self.distance = self.random.uniform(0.8, 6.0)
        doors = [door for door in tour.drive.world.doors.values() if door.open and crosses(points, door)]
        self.door = doors[self.random.integers(len(doors))].name if doors and self.random.random() < 0.6 else None
        self.wait = self.random.uniform(2.0, 20.0)
        self.happened = False

    def __call__(self, drive: Drive) -> None:
        world = drive.world
        if self.happened:
            if self.undo and world.time - self.changed > self.again:
                self.change(self.undo)
                self.undo = None
        elif self.door:
            away = gap_to(world.doors[self.door], drive.robot.pose) - self.tour.variant.reach
            if 0.5 < away < self.distance:
                self.happen(lambda: world.set_door(self.door, False), lambda: world.set_door(self.door, True))
        elif world.time - self.since > self.wait and drive.robot.v > 0.3:
            pose, radius = drive.robot.pose, self.random.uniform(0.1, 0.25)
            ahead = pose.advance(self.tour.variant.reach + radius + self.random.uniform(0.5, 1.2), 0.0, 1.0)
            thing = ObstacleSpec(f"sudden{world.steps}", ahead[:2], radius=radius)
            self.happen(lambda: world.put_obstacle(thing), lambda: world.remove_obstacle(thing.name))

    def happen(self, work, undo) -> None:
        self.happened = True
        if self.change(work):
            self.undo = undo

    def change(self, work) -> bool:
        try:
            work()
        except WorldError:  # the robot is in the way
            return False
        self.changed = self.tour.drive.world.time
        return True


def gap_to(door, pose: Pose2D) -> float:
    """Return the distance (m) from a pose to a door."""
    a, b, p = np.array(door.start), np.array(door.end), np.array(pose[:2])
    part = np.clip((p - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0)
    return float(np.hypot(*(a + part * (b - a) - p)))


def crosses(points: np.ndarray, door) -> bool:
    """Return whether the path along ``points`` leads through a door."""
    a, b = np.array(door.start), np.array(door.end)
    across = np.array([a[1] - b[1], b[0] - a[0]])
    side, along = (points - a) @ across, (points - a) @ (b - a) / ((b - a) @ (b - a))
    between = 0.5 * (along[:-1] + along[1:])
    return bool(np.any((side[:-1] * side[1:] < 0.0) & (between > 0.0) & (between < 1.0)))


class Tour:
    """A tour of one robot to several goals on one map."""

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
        world = Simulation(spec._replace(robots=tuple(robots)))
        self.drive = Timed(world, control=variant.control, scan=2, late=variant.late)
        self.standing = [robot.pose for robot in world.robots.values()][1:]
        self.aborts = []

    @staticmethod
    def stands(spec: WorldSpec, robot: RobotSpec) -> bool:
        try:
            Simulation(spec._replace(robots=(robot,)))
        except WorldError:
            return False
        return True

    def somewhere(self) -> Pose2D:
        return Pose2D(*self.grid.centre(*self.free[self.random.integers(len(self.free))]), self.random.uniform(-3, 3))

    def with_things(self, more: float) -> OccupancyGrid:
        """Return the map with all present obstacles, enlarged by ``more`` (m)."""
        world, cells, scale = self.drive.world, self.grid.cells.copy(), self.grid.resolution
        discs = [(*thing.at, thing.radius) for thing in world.obstacles.values()]
        discs += [(pose.x, pose.y, 0.18) for pose in self.standing]
        for door in world.doors.values():
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

    def go(self) -> str:
        """Drive to a random goal; return how it ended, as text."""
        goal, since = self.somewhere(), self.drive.world.time
        here = self.drive.robot.pose
        way = self.plan(goal, SPARE, self.variant.reach)
        eventful = way.outcome is PlanOutcome.FOUND and self.random.random() < self.events if self.events else False
        event = Event(self, way.points) if eventful else None
        try:
            result = self.drive.to(goal, LIMIT, event or (lambda drive: None))
        except AssertionError:
            return f"NO END within {LIMIT} s: {tuple(here)} -> {tuple(goal)}"
        took = self.drive.world.time - since
        if result.outcome is NavigationOutcome.REACHED:
            return "reached"
        self.aborts.append(took)
        what = "" if event is None or not event.happened else f" ({event.door or 'thing'} {event.distance:.1f} m ahead)"
        words = f"{result.outcome.name} after {took:.0f} s{what}: {tuple(here)} -> {tuple(goal)}: {result.message}"
        if event and self.drive.world.time - event.changed < SETTLED:
            return f"either, {words}"
        if self.plan(goal, SPARE, self.variant.reach).outcome is PlanOutcome.FOUND:
            return f"MISSED, {words}"
        inner = inscribed_radius(0.18, self.variant.footprint)
        possible = self.plan(goal, LACK, inner).outcome is PlanOutcome.FOUND
        return f"{'either' if possible else 'impossible'}, {words}"


class Timed(Drive):
    """A drive that records the processing time (s) of each tick."""

    def __init__(self, *arguments, **more) -> None:
        super().__init__(*arguments, **more)
        self.costs = []

    def tick(self, period):
        begin = time.perf_counter()
        tick = super().tick(period)
        self.costs.append(time.perf_counter() - begin)
        return tick


def far_apart(grid: OccupancyGrid, low: float = 60.0, high: float = 80.0) -> Iterator[List[Pose2D]]:
    """Yield pairs of poses with a path of ``low`` to ``high`` m between them."""
    costmap, planner, random = Costmap(grid, CostmapLimits()), GridPlanner(), np.random.default_rng(3)
    free = np.argwhere(costmap.clearance > 3.0)
    while True:
        ends = [Pose2D(*grid.centre(*free[random.integers(len(free))])) for _ in range(2)]
        if ends[0].distance(ends[1]) > 0.6 * low and low <= planner.plan(costmap, *ends).length <= high:
            yield ends


def plan_times(grid: OccupancyGrid, count: int) -> List[float]:
    """Return the ms that a new planner takes for each of ``count`` plans over 60 to 80 m."""
    costmap, planner, times = Costmap(grid, CostmapLimits()), GridPlanner(), []
    for _, ends in zip(range(count), far_apart(grid)):
        planner.plan(costmap, ends[0], ends[0])
        begin = time.perf_counter()
        planner.plan(costmap, *ends)
        times.append(1e3 * (time.perf_counter() - begin))
    return times


def measure(options) -> Iterator[Figure]:
    """Drive the tours and print the goals that were not reached; yield the figures."""
    ends, aborts, costs, collisions = [], [], [], 0
    kinds = ["small"] * options.small + ["office"] * options.offices
    for seed, kind in enumerate(kinds, options.seed):
        random = np.random.default_rng(seed)
        variant = Variant() if options.plain else varied(kind, random)
        if options.body != "varied":
            variant = variant._replace(footprint=BODIES[options.body])
        floor = variant.floor(kind, random, seed)
        tour = Tour(floor, variant, random, 6 if kind == "small" else 60, options.events / 10.0)
        for number in range(options.goals):
            text = tour.go()
            ends.append(text.split(",")[0].split(" within")[0])
            if text != "reached":
                print(f"{kind} {seed} {number} {tuple(variant)}: {text}", flush=True)
        for collision in tour.drive.collisions[:1]:
            print(f"{kind} {seed} {tuple(variant)}: COLLISION {collision}", flush=True)
        aborts, costs = aborts + tour.aborts, costs + tour.drive.costs
        collisions += len(tour.drive.collisions)
    for end in ("reached", "impossible", "either", "MISSED", "NO END"):
        yield Figure(end, ends.count(end), "goals", "higher" if end == "reached" else "lower")
    yield Figure("collisions", collisions, "")
    yield Figure("longest abort", max(aborts, default=0.0), "simulated s")
    yield from quantiles("control period", [1e6 * one for one in costs], "us")
    yield Figure("a plan over 60 to 80 m", statistics.median(plan_times(office_floor(3).grid, options.plans)), "ms")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        small=Option(20, "number of small floors", 3),
        offices=Option(2, "number of office floors", 0),
        goals=Option(5, "goals on each floor", 3),
        seed=Option(0, "seed of the first floor"),
        events=Option(4, "drives in ten with an event"),
        plain=Option(False, "use a disc, straight maps without roughness, and control at 10 Hz", True),
        body=Option("varied", "body of the robot on all floors", choices=["varied", *BODIES]),
        plans=Option(20, "plans over 60 to 80 m", 10),
    )
