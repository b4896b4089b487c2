"""Compares path lengths of this package with those of navfn's class NavFn on the shipped maps, without a master.

Needs g++ and a catkin workspace in which the navigation stack is built; only its library is called. With --write, the
lengths become the reference for test/unit/robot/navigation/test_navfn_lengths.py.

    ./dev exec python3 bench/navfn_lengths.py WORKSPACE/devel [--write]

Each map is used without and with inflation. Without it, navfn returns the shortest path that it knows. Inflation adds
costs to cells near walls, so that navfn makes detours.
"""

import argparse
import itertools
import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, PlanOutcome, Pose2D
from rosoclingo.robot.navigation.grid import load_map
from rosoclingo.robot.navigation.inflated_ways import navfn_lengths

ROOT = Path(__file__).resolve().parents[1]
LENGTHS = ROOT / "test" / "data" / "navfn_lengths.json"
INFLATIONS = ((0.0, 10.0), (0.55, 10.0), (0.8, 3.0))  # m, 1/m: no inflation, the default, a wide one
PAIRS = 60
CALLER = """
#include <navfn/navfn.h>
#include <cmath>
#include <cstdio>
#include <vector>

int main(int, char** names) {
  std::FILE* file = std::fopen(names[1], "rb");
  int size[3], pair[4];
  if (!file || std::fread(size, 4, 3, file) != 3) return 1;
  std::vector<unsigned char> costs(size[0] * size[1]);
  if (std::fread(costs.data(), 1, costs.size(), file) != costs.size()) return 1;
  navfn::NavFn planner(size[0], size[1]);
  planner.setNavArr(size[0], size[1]);
  while (std::fread(pair, 4, 4, file) == 4) {
    planner.setCostmap(costs.data(), true, false);
    planner.setStart(pair + 2);
    planner.setGoal(pair);
    planner.calcNavFnDijkstra(true);
    int count = planner.calcPath(size[0] * 4);
    float *x = planner.getPathX(), *y = planner.getPathY();
    double length = 0.0;
    for (int i = 1; i < count; i++) length += std::hypot(x[i] - x[i - 1], y[i] - y[i - 1]);
    std::printf("%.3f\\n", length);
  }
}
"""


def compiled(devel: Path, folder: Path) -> Path:
    """Compile a program that calls navfn's library; return its path."""
    source, caller = folder / "caller.cpp", folder / "caller"
    source.write_text(CALLER)
    packages = [one.resolve() for one in devel.parent.glob("src/*")]  # "**" does not follow links
    headers = [one for package in packages for one in package.glob("**/navfn/include")]
    where = [f"-I{one}" for one in (devel / "include", *headers)]
    library = [f"-L{devel / 'lib'}", "-lnavfn", f"-Wl,-rpath,{devel / 'lib'}"]
    subprocess.run(["g++", "-O2", "-o", str(caller), str(source), *where, *library], check=True)
    return caller


def costs_of(costmap: Costmap) -> np.ndarray:
    """Return the costs by the rule of costmap_2d (uint8; 254 lethal, 253 inscribed, 255 unknown)."""
    shown, limits = costmap.costs(), costmap.limits
    height, width = shown.shape
    span = int(np.ceil(max(limits.inflation_radius, limits.robot_radius) / costmap.resolution))
    lethal = np.pad(shown == 100, span)
    gaps = np.full(shown.shape, np.inf)  # from the centre of each cell to the centre of the nearest lethal cell
    for row in range(-span, span + 1):
        for column in range(-span, span + 1):
            there = lethal[span + row : span + row + height, span + column : span + column + width]
            gaps[there] = np.minimum(gaps[there], np.hypot(row, column) * costmap.resolution)
    near = 252 * np.exp(-limits.cost_scaling_factor * (gaps - limits.robot_radius))
    costs = np.where(gaps <= limits.inflation_radius, near, 0)
    costs = np.where(gaps <= limits.robot_radius, 253, np.where(shown < 0, 255, costs))
    return np.where(shown == 100, 254, costs).astype(np.uint8)


def ways_of(costmap: Costmap, costs: np.ndarray) -> np.ndarray:
    """Return paths between random cells: column, row, column, row, and the lengths (m) of planner and places."""
    random, planner, found = np.random.default_rng(1), GridPlanner(), []
    free = np.argwhere(costs < 253)
    while len(found) < PAIRS:
        ends = free[random.integers(len(free), size=2)]
        poses = [Pose2D(*costmap.grid.centre(*map(int, one)), 0.0) for one in ends]
        plan = planner.plan(costmap, *poses, 0.0)
        estimated = navfn_lengths(costmap, poses[0], poses[1:])[0]
        if plan.outcome is PlanOutcome.FOUND and plan.length > 2.0 and estimated is not None:
            found.append([*ends[0][::-1], *ends[1][::-1], plan.length, estimated])
    return np.array(found)


def lengths_of(caller: Path, costs: np.ndarray, cells: np.ndarray, resolution: float, file: Path) -> np.ndarray:
    """Return navfn's lengths (m) for the same paths."""
    size = np.array([*costs.shape[::-1], len(cells)], dtype=np.int32)
    file.write_bytes(size.tobytes() + costs.tobytes() + cells.astype(np.int32).tobytes())
    out = subprocess.run([str(caller), str(file)], check=True, capture_output=True, text=True).stdout
    return resolution * np.array([float(line) for line in out.split() if line[0].isdigit()])


def main() -> None:
    """Measure and print the lengths, and write them with ``--write``."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("devel", type=Path, help="the devel space of a workspace with the navigation stack")
    parser.add_argument("--write", action="store_true", help=f"write {LENGTHS.relative_to(ROOT)}")
    options = parser.parse_args()
    lines = []
    with tempfile.TemporaryDirectory() as folder:
        caller = compiled(options.devel.resolve(), Path(folder))
        for name, inflation in itertools.product(("office", "house"), INFLATIONS):
            costmap = Costmap(load_map(ROOT / "worlds" / f"{name}.yaml"), CostmapLimits(0.18, *inflation))
            costs = costs_of(costmap)
            ways = ways_of(costmap, costs)
            theirs = lengths_of(caller, costs, ways[:, :4], costmap.resolution, Path(folder) / "map.bin")
            for what, ours in (("move_base's planner", ways[:, 4]), ("places", ways[:, 5])):
                ratios = ours / theirs
                near = np.count_nonzero(abs(ratios - 1.0) <= 0.03)
                print(
                    f"{name}, inflation_radius {inflation[0]}, cost_scaling_factor {inflation[1]}: lengths of {what} "
                    f"over navfn's, {PAIRS} paths: {ratios.min():.3f} to {ratios.max():.3f}, "
                    f"median {np.median(ratios):.3f}; {near} within 3 %"
                )
            if inflation is not INFLATIONS[-1]:  # with wide inflation, paths of equal cost can differ in length
                pairs = zip(ways[:, :4].astype(int).tolist(), theirs)
                lines += [json.dumps([name, *inflation, *cells, round(its, 3)]) for cells, its in pairs]
    if options.write:
        LENGTHS.write_text("[\n" + ",\n".join(lines) + "\n]\n")


if __name__ == "__main__":
    main()
