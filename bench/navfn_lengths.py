"""Measures ways by navfn's class NavFn, without a master, on the shipped maps beside those of this package's planner.

Needs g++ and a catkin workspace in which the navigation stack is built; only its library is called. With --write the
lengths become what test/unit/robot/navigation/test_navfn_lengths.py holds the planner to.

    ./dev exec python3 bench/navfn_lengths.py WORKSPACE/devel [--write]

Each map is looked at twice: with the costs that inflation gives to cells near walls, for which navfn makes detours, and
with only what a robot cannot enter, where navfn's way is the shortest that it knows.
"""

import argparse
import json
import statistics
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, PlanOutcome, Pose2D
from rosoclingo.robot.navigation.grid import load_map

ROOT = Path(__file__).resolve().parents[1]
LENGTHS = ROOT / "test" / "data" / "navfn_lengths.json"
LIMITS = CostmapLimits(robot_radius=0.18, inflation_radius=0.55, cost_scaling_factor=10.0)
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
    """Build what calls navfn's library."""
    source, caller = folder / "caller.cpp", folder / "caller"
    source.write_text(CALLER)
    packages = [one.resolve() for one in devel.parent.glob("src/*")]  # links are followed, unlike by "**"
    headers = [one for package in packages for one in package.glob("**/navfn/include")]
    where = [f"-I{one}" for one in (devel / "include", *headers)]
    library = [f"-L{devel / 'lib'}", "-lnavfn", f"-Wl,-rpath,{devel / 'lib'}"]
    subprocess.run(["g++", "-O2", "-o", str(caller), str(source), *where, *library], check=True)
    return caller


def costs_of(costmap: Costmap, plain: bool) -> np.ndarray:
    """Return the costs as costmap_2d holds them (uint8; 254 lethal, 253 inscribed, 255 unknown)."""
    shown = costmap.costs().astype(int)
    near = 0 if plain else 1 + np.round((shown - 1) * 251 / 97)
    rest = np.where(shown < 0, 255, np.where(shown == 0, 0, near))
    return np.where(shown == 100, 254, np.where(shown == 99, 253, rest)).astype(np.uint8)


def pairs_of(costmap: Costmap, costs: np.ndarray) -> list:
    """Return cells at random, two by two (column, row, column, row), with the length (m) of this package's way."""
    random, planner, grid, found = np.random.default_rng(1), GridPlanner(), costmap.grid, []
    free = np.argwhere(costs < 253)
    while len(found) < PAIRS:
        ends = free[random.integers(len(free), size=2)]
        poses = [Pose2D(*grid.centre(*map(int, one)), 0.0) for one in ends]
        plan = planner.plan(costmap, *poses, 0.0)
        if plan.outcome is PlanOutcome.FOUND and plan.length > 2.0:
            found.append(([int(number) for one in ends for number in one[::-1]], plan.length))
    return found


def main() -> None:
    """Measure and print, and write where that is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", maxsplit=1)[0])
    parser.add_argument("devel", type=Path, help="the devel space of a workspace with the navigation stack")
    parser.add_argument("--write", action="store_true", help=f"write {LENGTHS.relative_to(ROOT)}")
    options = parser.parse_args()
    kept = []
    with tempfile.TemporaryDirectory() as folder:
        caller = compiled(options.devel.resolve(), Path(folder))
        for name in ("office", "house"):
            costmap = Costmap(load_map(ROOT / "worlds" / f"{name}.yaml"), LIMITS)
            for plain in (True, False):
                costs = costs_of(costmap, plain)
                pairs = pairs_of(costmap, costs)
                told = Path(folder) / "map.bin"
                numbers = [[*costs.shape[::-1], len(pairs)], *(cells for cells, _ in pairs)]
                parts = [np.array(row, dtype=np.int32).tobytes() for row in numbers]
                told.write_bytes(b"".join([parts[0], costs.tobytes(), *parts[1:]]))
                out = subprocess.run([str(caller), str(told)], check=True, capture_output=True, text=True).stdout
                theirs = [float(line) * costmap.resolution for line in out.split() if line[0].isdigit()]
                ratios = [ours / its for (_, ours), its in zip(pairs, theirs)]
                near = sum(abs(ratio - 1.0) <= 0.03 for ratio in ratios)
                what = "what cannot be entered" if plain else "inflated costs"
                print(  # noqa: T201
                    f"{name}, {what}: ours over navfn's, {len(ratios)} ways: {min(ratios):.3f} to {max(ratios):.3f}, "
                    f"median {statistics.median(ratios):.3f}; {near} within 3 %"
                )
                if plain:
                    kept += [[name, *cells, round(its, 3)] for (cells, _), its in zip(pairs, theirs)]
    if options.write:
        rows = ",\n".join(json.dumps(row) for row in kept)
        LENGTHS.write_text(f"[\n{rows}\n]\n")


if __name__ == "__main__":
    main()
