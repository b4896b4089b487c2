"""Plans deliveries with the routing solver of OR-Tools, in a separate process with the Python that has it."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import List, Sequence, Tuple

from deliveries import CAPACITY, Floor, Request

PYTHON = "ROSOCLINGO_BENCH_PYTHON"
"""Environment variable with the path of a Python that has the group bench of pyproject.toml, set by ./dev."""

HOW = "OR-Tools is not installed, so its columns are left out; ./dev bench many_goals fleet installs it"

SOLVER = Path(__file__).resolve().parent / "or_tools.py"

Visit = Tuple[str, Request]


class RoutingError(Exception):
    """OR-Tools has found no route; the message contains the cause."""


def bench_python() -> str:
    """Return the path of the Python that has the other planners, by default of this one."""
    return os.environ.get(PYTHON) or sys.executable


def is_there() -> bool:
    """Return whether OR-Tools is installed."""
    try:
        return not subprocess.run([bench_python(), "-c", "import ortools"], capture_output=True, check=False).returncode
    except OSError:
        return False


def routes(
    floor: Floor, office: int, waiting: Sequence[Request], carried: Sequence[Request], seconds: Sequence[float]
) -> List[List[Visit]]:
    """Return the best route from ``office`` after each time in ``seconds``, the first one if there was none yet.

    The times are processor time. A visit is ("pickup", request) or ("deliver", request). Raises RoutingError.
    """
    stops = [("pickup", one) for one in waiting] + [("deliver", one) for one in (*waiting, *carried)]
    places = [office, *(one.start if what == "pickup" else one.end for what, one in stops)]
    distances = {place: floor.distances_from(place) for place in set(places)}
    problem = {
        "distances": [[distances[a][b] for b in places] for a in places],
        "waiting": len(waiting),
        "carried": len(carried),
        "capacity": CAPACITY,
        "seconds": max(seconds),
    }
    command = [bench_python(), str(SOLVER)]
    done = subprocess.run(command, input=json.dumps(problem), capture_output=True, text=True, check=False)
    found = [json.loads(line) for line in done.stdout.splitlines()]
    if done.returncode != -signal.SIGPROF or not found:
        raise RoutingError(f"OR-Tools has found no route: {done.stderr.strip()}")
    orders = [([order for used, order in found if used <= limit] or [found[0][1]])[-1] for limit in seconds]
    return [[stops[stop - 1] for stop in order] for order in orders]
