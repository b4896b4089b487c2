#!/usr/bin/env python3
"""Drives tours of random goals on random maps, without ROS: who is reached, what is touched, how long an abort takes.

Maps: an office floor of 54 x 58.7 m at 0.1 m a cell, and small floors of rooms with narrow doors and clutter at 0.05 m;
in each some doors of the map are closed and some things stand about that the map lacks. A goal counts as reachable when
a plan on the map with these things on it (8 cm bigger) leads there.
Run it in the built workspace: ./dev exec python3 bench/tours.py
"""

import argparse
import sys
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "src"), str(ROOT / "test" / "unit")]
# ruff: noqa: E402

from navigation_worlds import Drive, room, simulation
from planner import office

from rosoclingo.navigation import Costmap, CostmapLimits, GridPlanner, OccupancyGrid, Outcome, PlanOutcome, Pose2D
from rosoclingo.simulation import ObstacleSpec

SPARE = 0.08  # m: what noise makes bigger must still be passable
LIMIT = 3000.0  # simulated s that a goal may take


def small_floor(random) -> OccupancyGrid:
    """Rooms of 10 x 10 m with doors of 0.6 to 1.0 m and clutter."""
    walls = []
    for at in (3.3, 6.6):
        start = 0.0
        for door in sorted(random.uniform(0.5, 9.0, 3)):
            walls += [(at, start, at + 0.1, door)]
            start = door + random.uniform(0.6, 1.0)
        walls += [(at, start, at + 0.1, 10.0)]
    for x, y in random.uniform(0.5, 9.0, (7, 2)):
        walls += [(x, y, x + random.uniform(0.1, 0.9), y + random.uniform(0.1, 0.9))]
    return room(10.0, 10.0, 0.05, walls)


class Tour:
    """One map, one robot, and goals one after the other."""

    def __init__(self, grid: OccupancyGrid, random, things: int) -> None:
        self.grid, self.random = grid, random
        self.free = np.argwhere(Costmap(grid, CostmapLimits(inflation_radius=0.6)).clearance * grid.resolution > 0.3)
        start = self.somewhere()
        spots = [self.somewhere() for _ in range(things)]
        self.things = [
            ObstacleSpec(str(i), spot[:2], radius=random.uniform(0.1, 0.3))
            for i, spot in enumerate(spots)
            if start.distance(spot) > 0.8
        ]
        self.drive = Drive(simulation(grid, start, obstacles=tuple(self.things)))
        self.known = Costmap(self.with_things())

    def somewhere(self) -> Pose2D:
        return Pose2D(*self.grid.centre(*self.free[self.random.integers(len(self.free))]), self.random.uniform(-3, 3))

    def with_things(self) -> OccupancyGrid:
        rows, columns = np.indices(self.grid.shape)
        x, y = (columns + 0.5) * self.grid.resolution, (rows + 0.5) * self.grid.resolution
        cells = self.grid.cells.copy()
        for thing in self.things:
            cells[np.hypot(x - thing.at[0], y - thing.at[1]) <= thing.radius + SPARE] = 100
        return OccupancyGrid(cells, self.grid.resolution)

    def go(self) -> str:
        """Drive to a random goal; return what came of it."""
        goal, since = self.somewhere(), self.drive.world.time
        here = self.drive.robot.pose
        plan = GridPlanner().plan(self.known, here, goal)
        possible = plan.outcome is PlanOutcome.FOUND
        try:
            result = self.drive.to(goal, LIMIT)
        except AssertionError:
            return f"NO END within {LIMIT} s: {tuple(here)} -> {tuple(goal)}"
        took = self.drive.world.time - since
        if result.outcome is Outcome.REACHED:
            return "reached"
        words = f"{result.outcome.name} after {took:.0f} s: {tuple(here)} -> {tuple(goal)}: {result.message}"
        return f"MISSED, {words}" if possible else f"told, {words}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--small", type=int, default=20, help="small floors")
    parser.add_argument("--offices", type=int, default=2, help="office floors")
    parser.add_argument("--goals", type=int, default=5, help="goals on each")
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    counts, begin, collisions, simulated = {"reached": 0, "told": 0, "MISSED": 0, "NO END": 0}, time.time(), 0, 0.0
    kinds = ["small"] * arguments.small + ["office"] * arguments.offices
    for seed, kind in enumerate(kinds, arguments.seed):
        random = np.random.default_rng(seed)
        grid = small_floor(random) if kind == "small" else office(587, 540, seed)
        tour = Tour(grid, random, 6 if kind == "small" else 60)
        for _ in range(arguments.goals):
            text = tour.go()
            counts[text.split(",")[0].split(" within")[0]] += 1
            if text != "reached":
                print(f"{kind} {seed}: {text}", flush=True)
        for collision in tour.drive.collisions:
            print(f"{kind} {seed}: COLLISION {collision}", flush=True)
        collisions += len(tour.drive.collisions)
        simulated += tour.drive.world.time
    print(", ".join(f"{name} {count}" for name, count in counts.items()), f"collisions {collisions}", sep=", ")
    print(f"{simulated:.0f} simulated s in {time.time() - begin:.0f} s")


if __name__ == "__main__":
    main()
