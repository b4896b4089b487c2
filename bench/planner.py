#!/usr/bin/env python3
"""Times planning on office-like maps of growing size: median and worst ms of reachable pairs, by map and length."""

import argparse
import statistics
import sys
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "src"))

from rosoclingo.navigation import Costmap, CostmapLimits, GridPlanner, OccupancyGrid, PlanOutcome, Pose2D


def office(height: int, width: int, seed: int, room: int = 60) -> OccupancyGrid:
    """Return a floor of rooms (6 m) with doors of 1.1 m and furniture, at 0.1 m a cell."""
    random = np.random.default_rng(seed)
    cells = np.zeros((height, width), dtype=np.int8)
    cells[:2] = cells[-2:] = 100
    cells[:, :2] = cells[:, -2:] = 100
    for a, size, other in ((0, height, width), (1, width, height)):
        turned = cells if a == 0 else cells.T
        for wall in range(room, size - room // 2, room):
            turned[wall : wall + 2] = 100
            for part in range(0, other, room):
                if random.random() < 0.9:
                    door = part + random.integers(8, room - 20)
                    turned[wall : wall + 2, door : door + 11] = 0
    for row, column in zip(random.integers(5, height - 15, 250), random.integers(5, width - 15, 250)):
        cells[row : row + random.integers(3, 9), column : column + random.integers(3, 9)] = 100
    return OccupancyGrid(cells, 0.1)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--plans", type=int, default=60, help="plans a map")
    parser.add_argument("--seed", type=int, default=3)
    arguments = parser.parse_args()
    planner = GridPlanner()
    print("cells      costmap ms   length m  plans  median ms  worst ms")
    for height, width in ((150, 150), (300, 300), (587, 540), (1000, 1000)):
        grid = office(height, width, arguments.seed)
        Costmap(grid, CostmapLimits())
        start = time.perf_counter()
        costmap = Costmap(grid, CostmapLimits())
        made = time.perf_counter() - start
        times = {}
        random = np.random.default_rng(arguments.seed)
        free = np.argwhere(costmap.clearance > 3.0)
        for _ in range(arguments.plans):
            ends = [Pose2D(*grid.centre(*free[random.integers(len(free))])) for _ in range(2)]
            planner.plan(costmap, ends[0], ends[0])
            start = time.perf_counter()
            plan = planner.plan(costmap, *ends)
            if plan.outcome is PlanOutcome.FOUND:
                times.setdefault(20 * int(plan.length // 20), []).append(time.perf_counter() - start)
        for length, values in sorted(times.items()):
            row = (width, height, 1e3 * made, length, length + 20, len(values))
            median, worst = 1e3 * statistics.median(values), 1e3 * max(values)
            print("{:4}x{:<4} {:10.1f}  {:4}-{:<4} {:6}".format(*row), f" {median:9.1f} {worst:9.1f}")


if __name__ == "__main__":
    main()
