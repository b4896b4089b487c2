"""Other planners for comparison, in processes of their own: OR-Tools' routing solver, and Fast Downward.

Packages of PyPI provide them (the group bench of pyproject.toml). No module of Fast Downward (GPL) is imported. Plain
clingo is in ``incmode.py``.
"""

import json
import os
import re
import signal
import subprocess
import sys
import tempfile
from functools import lru_cache
from pathlib import Path
from typing import List, Optional, Sequence, Tuple

from deliveries import CAPACITY, Floor, Request
from figures import children_time
from planning_domains import Task

PYTHON = "ROSOCLINGO_BENCH_PYTHON"
"""Environment variable with the path of a Python that has the other planners, set by ./dev; by default this one."""

OR_TOOLS, FAST_DOWNWARD = "ortools", "up_fast_downward"

ALIASES = {"lama-first": "lama-first", "lama": "seq-sat-lama-2011"}
"""Configurations of Fast Downward: the first stops at its first plan, the second continues with shorter plans."""

#: ("pickup", request) or ("deliver", request).
Visit = Tuple[str, Request]


class RoutingError(Exception):
    """OR-Tools has found no route; the message contains the cause."""


def bench_python() -> str:
    """Return the path of the Python that has the other planners."""
    return os.environ.get(PYTHON) or sys.executable


@lru_cache(maxsize=None)
def folder_of(package: str) -> Optional[Path]:
    """Return the folder of a planner's package; without it print a note, and return None."""
    code = f"import importlib.util as u; print(u.find_spec({package!r}).submodule_search_locations[0])"
    try:
        done = subprocess.run([bench_python(), "-c", code], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError):
        print(f"{package} is not installed, so its columns are empty; ./dev bench installs it")
        return None
    return Path(done.stdout.strip())


def place_of(visit: Visit) -> int:
    """Return the office of a visit."""
    return visit[1].start if visit[0] == "pickup" else visit[1].end


def routes(
    floor: Floor,
    starts: Sequence[int],
    waiting: Sequence[Request],
    carried: Sequence[Request] = (),
    seconds: float = 5.0,
    durations: Tuple[int, int] = (1, 1),
) -> List[List[Visit]]:
    """Return the best route of each robot that OR-Tools finds in some seconds of processor time.

    Robots begin at the offices ``starts``; only one robot can have ``carried`` packages. The routes minimize the time
    until the last delivery, with the ``durations`` (s) of a drive to a neighbour and of handling a package. They ignore
    collisions. Raises RoutingError.
    """
    stops = [("pickup", one) for one in waiting] + [("deliver", one) for one in (*waiting, *carried)]
    places = [*starts, *map(place_of, stops)]
    distances = {place: floor.distances_from(place) for place in set(places)}
    drive, handle = durations
    handled = [0] * len(starts) + [handle] * len(stops)
    problem = {
        "times": [[drive * distances[a][b] + time for b in places] for a, time in zip(places, handled)],
        "robots": len(starts),
        "waiting": len(waiting),
        "carried": len(carried),
        "capacity": CAPACITY,
        "seconds": seconds,
    }
    command = [bench_python(), str(Path(__file__).resolve().with_name("or_tools.py"))]
    done = subprocess.run(command, input=json.dumps(problem), capture_output=True, text=True, check=False)
    if done.returncode != -signal.SIGPROF or not done.stdout:
        raise RoutingError(f"OR-Tools has found no route: {done.stderr.strip()}")
    return [[stops[number] for number in route] for route in json.loads(done.stdout.splitlines()[-1])]


def fast_downward(task: Task, alias: str, seconds: float) -> Tuple[float, Optional[int]]:
    """Return the processor time of a run in seconds, translation included, and the steps of its best plan.

    The search is limited to ``seconds`` of processor time, at least one. Without a plan, the steps are None.
    """
    driver = folder_of(FAST_DOWNWARD) / "downward" / "fast-downward.py"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "domain.pddl").write_text(task.domain)
        (folder / "problem.pddl").write_text(task.problem)
        limit = ["--search-time-limit", f"{max(1.0, seconds):g}s", "--plan-file", "plan"]
        command = [bench_python(), str(driver), "--alias", ALIASES[alias], *limit, "domain.pddl", "problem.pddl"]
        before = children_time()
        subprocess.run(command, cwd=name, capture_output=True, check=False)
        plans = sorted(folder.glob("plan*"), key=lambda path: int(path.suffix[1:] or 0))
        steps = len(re.findall(r"^\(", plans[-1].read_text(), re.MULTILINE)) if plans else None
        return children_time() - before, steps
