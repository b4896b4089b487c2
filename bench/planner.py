#!/usr/bin/env python3
"""Measures path planning on office-like maps of growing size: median and worst ms, by map and path length.

At the end, it measures the same as a service: make_plan of move_base over 60 to 80 m, on a map of 540 x 587 cells, with
20 calls for each pair of poses.

Run it in the built workspace: ./dev exec python3 bench/planner.py
"""

import argparse
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from figures import Figure, parse, write
from ros_system import System, write_map

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "src"))

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, OccupancyGrid, PlanOutcome, Pose2D

MAPS = ((150, 150), (300, 300), (587, 540), (1000, 1000))  # cells


def office(height: int, width: int, seed: int, room: int = 60) -> OccupancyGrid:
    """Return a floor of rooms (6 m) with doors (1.1 m) and furniture, at 0.1 m a cell."""
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


def far_apart(grid: OccupancyGrid, seed: int, low: float = 60.0, high: float = 80.0):
    """Yield pairs of poses with a path of ``low`` to ``high`` m between them."""
    costmap, planner, random = Costmap(grid, CostmapLimits()), GridPlanner(), np.random.default_rng(seed)
    free = np.argwhere(costmap.clearance > 3.0)
    while True:
        ends = [Pose2D(*grid.centre(*free[random.integers(len(free))])) for _ in range(2)]
        if ends[0].distance(ends[1]) > 0.6 * low and low <= planner.plan(costmap, *ends).length <= high:
            yield ends


def call_service(grid: OccupancyGrid, seed: int, pairs: int) -> list:
    """Print the duration of make_plan, with the call, in a running system; return the figures."""
    import rospy
    from nav_msgs.srv import GetPlan, GetPlanRequest

    rospy.init_node("planner_bench")
    rospy.wait_for_service("move_base/make_plan", 60.0)
    found = []
    make_plan = rospy.ServiceProxy("move_base/make_plan", GetPlan)
    for _, ends in zip(range(pairs), far_apart(grid, seed)):
        request = GetPlanRequest()
        for stamped, end in zip((request.start, request.goal), ends):
            stamped.header.frame_id, stamped.pose.orientation.w = "map", 1.0
            stamped.pose.position.x, stamped.pose.position.y = end[:2]
        deadline = time.monotonic() + 60.0
        while not make_plan(request).plan.poses:  # until there is a map
            if time.monotonic() > deadline:
                sys.exit("make_plan found no path within 60 s")
            time.sleep(0.2)
        times = []
        for _ in range(20):
            start = time.perf_counter()
            poses = make_plan(request).plan.poses
            times.append(1e3 * (time.perf_counter() - start))
        points = np.array([(pose.pose.position.x, pose.pose.position.y) for pose in poses])
        length = float(np.hypot(*np.diff(points, axis=0).T).sum())
        print(f"make_plan {length:5.1f} m: median {statistics.median(times):5.1f} ms, worst {max(times):5.1f} ms")
        found.append(Figure(f"make_plan over {length:.0f} m", statistics.median(times), "ms"))
    return found


def serve(seed: int, pairs: int) -> list:
    """Start simulator, map server and move_base, and call make_plan; return the figures."""
    grid = office(587, 540, seed)
    with tempfile.TemporaryDirectory() as name:
        folder, system = Path(name), System()
        try:
            map_file, home = write_map(folder, grid), next(far_apart(grid, seed))[0]
            world = f"map: map.yaml\nrobots: [{{pose: [{home.x}, {home.y}, 0]}}]\n"
            (folder / "world.yaml").write_text(world)
            system.launch("simulation.launch", f"world:={folder}/world.yaml")
            system.launch("navigation.launch", f"map:={map_file}")
            return call_service(grid, seed, pairs)
        finally:
            system.stop()


def measure(height: int, width: int, seed: int, plans: int) -> list:
    """Print the duration of planning on one map, by path length; return the figures."""
    planner, grid = GridPlanner(), office(height, width, seed)
    Costmap(grid, CostmapLimits())
    start = time.perf_counter()
    costmap = Costmap(grid, CostmapLimits())
    made = 1e3 * (time.perf_counter() - start)
    times = {}
    random = np.random.default_rng(seed)
    free = np.argwhere(costmap.clearance > 3.0)
    for _ in range(plans):
        ends = [Pose2D(*grid.centre(*free[random.integers(len(free))])) for _ in range(2)]
        planner.plan(costmap, ends[0], ends[0])
        start = time.perf_counter()
        plan = planner.plan(costmap, *ends)
        if plan.outcome is PlanOutcome.FOUND:
            times.setdefault(20 * int(plan.length // 20), []).append(1e3 * (time.perf_counter() - start))
    for length, values in sorted(times.items()):
        row = (width, height, made, length, length + 20, len(values))
        print(
            "{:4}x{:<4} {:10.1f}  {:4}-{:<4} {:6}".format(*row), f" {statistics.median(values):9.1f} {max(values):9.1f}"
        )
    every = [value for values in times.values() for value in values]
    what = f"{width}x{height} cells, "
    return [Figure(what + "costmap", made, "ms"), Figure(what + "a plan", statistics.median(every), "ms")]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--maps", type=int, default=len(MAPS), help="number of maps, the smallest first (default: %(default)s)"
    )
    parser.add_argument("--plans", type=int, default=60, help="plans on each map (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=3, help="seed of maps and pairs (default: %(default)s)")
    parser.add_argument(
        "--pairs", type=int, default=3, help="pairs for make_plan; 0 needs no ROS (default: %(default)s)"
    )
    arguments = parse(parser, maps=3, plans=30, pairs=1)
    print("cells      costmap ms   length m  plans  median ms  worst ms")
    found = [one for size in MAPS[: arguments.maps] for one in measure(*size, arguments.seed, arguments.plans)]
    if arguments.pairs:
        found += serve(arguments.seed, arguments.pairs)
    print("load of the machine (1, 5, 15 min):", *(f"{load:.1f}" for load in os.getloadavg()))
    write(arguments.json, found)


if __name__ == "__main__":
    main()
