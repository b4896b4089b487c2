"""Plans deliveries with the routing solver of OR-Tools: one vehicle, pickup and delivery, guided local search.

`routes` starts a separate process, with the Python that has OR-Tools (the group bench of pyproject.toml), and exchanges
JSON with it. Its time limit is processor time, like that of rosoclingo's solver, so that other programs do not affect
the plans.
"""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from deliveries import CAPACITY, Floor, Request, World

PYTHON = "ROSOCLINGO_BENCH_PYTHON"
"""Environment variable with the path of a Python that has OR-Tools, set by ./dev; the default is this Python."""

HOW = "OR-Tools is not installed: ./dev bench many_goals installs it, --without-or-tools leaves it out"

Visit = Tuple[str, Request]


class RoutingError(Exception):
    """OR-Tools has found no route; the message contains the cause."""


class Route(NamedTuple):
    """The visits in order, and the processor time (s) after which the route was found."""

    seconds: float
    visits: List[Visit]


def bench_python() -> str:
    """Return the path of the Python that has the other planners."""
    return os.environ.get(PYTHON) or sys.executable


def is_there() -> bool:
    """Return whether OR-Tools is installed."""
    try:
        found = subprocess.run([bench_python(), "-c", "import ortools"], capture_output=True, check=False)
    except OSError:
        return False
    return found.returncode == 0


def routes(floor: Floor, world: World, seconds: Sequence[float]) -> List[Route]:
    """Return the best routes for all requests of a world after each time in ``seconds``; raises RoutingError."""
    waiting, carried = list(world.waiting.values()), list(world.carried.values())
    stops: List[Visit] = [("pickup", one) for one in waiting] + [("deliver", one) for one in [*waiting, *carried]]
    places = [world.office, *(one.start if what == "pickup" else one.end for what, one in stops)]
    distances = floor.distances()
    problem = {
        "distances": [[distances[a, b] for b in places] for a in places],
        "waiting": len(waiting),
        "carried": len(carried),
        "capacity": CAPACITY,
        "seconds": max(seconds),
    }
    command = [bench_python(), str(Path(__file__).resolve())]
    done = subprocess.run(command, input=json.dumps(problem), capture_output=True, text=True, check=False)
    found = [json.loads(line) for line in done.stdout.splitlines()]
    if done.returncode != -signal.SIGPROF or not found:
        raise RoutingError(f"OR-Tools has found no route: {done.stderr.strip()}")
    return [_best(stops, found, limit) for limit in seconds]


def _best(stops: Sequence[Visit], found: Sequence[Tuple[float, List[int]]], limit: float) -> Route:
    """Return the last, and so the best, route found within ``limit``; the first route if there was none yet."""
    used, order = ([one for one in found if one[0] <= limit] or found[:1])[-1]
    return Route(used, [stops[stop - 1] for stop in order])


# ---- In the process with OR-Tools ------------------------------------------------------------------------------------


class Search:
    """One search for a route.

    Node 0 is the place of the vehicle. Pickups follow, then their deliveries, then deliveries of carried packages.
    """

    def __init__(self, problem: Dict) -> None:
        from ortools.constraint_solver import pywrapcp

        self._problem = problem
        self._nodes = len(problem["distances"])
        self._end = self._nodes  # a node at distance 0 from all others, so that the vehicle need not return
        self._manager = pywrapcp.RoutingIndexManager(self._nodes + 1, 1, [0], [self._end])
        self._routing = pywrapcp.RoutingModel(self._manager)
        self._demand()
        self._order()
        self._cost: Optional[int] = None  # the cost of the best route so far
        self._begin = 0.0

    def run(self, seconds: float) -> None:
        """Search for better and better routes and write them; SIGPROF ends this process after ``seconds``.

        SIGPROF measures processor time. The routing solver only supports limits of wall time, and reading a clock in
        Python slows it down. Insertion finds better routes, but inserts pairs first, which fails if the vehicle is full
        at the start.
        """
        from ortools.constraint_solver import pywrapcp, routing_enums_pb2

        parameters = pywrapcp.DefaultRoutingSearchParameters()
        strategies = routing_enums_pb2.FirstSolutionStrategy
        parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
        parameters.time_limit.FromSeconds(24 * 3600)  # guided local search never ends by itself
        self._routing.AddAtSolutionCallback(self._found)
        self._begin = time.process_time()
        signal.setitimer(signal.ITIMER_PROF, seconds)
        for strategy in (strategies.PARALLEL_CHEAPEST_INSERTION, strategies.PATH_CHEAPEST_ARC):
            parameters.first_solution_strategy = strategy
            self._routing.SolveWithParameters(parameters)  # returns only if it finds no route

    def _found(self) -> None:
        """Write the present route if it is better than all earlier ones."""
        cost = self._routing.CostVar().Max()
        if self._cost is None or cost < self._cost:
            self._cost = cost
            print(json.dumps([time.process_time() - self._begin, self._route()]), flush=True)

    def _route(self) -> List[int]:
        index, route = self._routing.Start(0), []
        while not self._routing.IsEnd(index):
            index = self._routing.NextVar(index).Value()
            route.append(self._manager.IndexToNode(index))
        return route[:-1]

    def _demand(self) -> None:
        distances = [[*row, 0] for row in self._problem["distances"]] + [[0] * (self._nodes + 1)]
        matrix = self._routing.RegisterTransitMatrix(distances)
        self._routing.SetArcCostEvaluatorOfAllVehicles(matrix)
        waiting, carried = self._problem["waiting"], self._problem["carried"]
        loads = [carried, *[1] * waiting, *[-1] * (waiting + carried), 0]
        load = self._routing.RegisterUnaryTransitVector(loads)
        self._routing.AddDimension(load, 0, self._problem["capacity"], True, "load")

    def _order(self) -> None:
        """Require pickups before their deliveries, by a dimension "order": distances between them can be 0."""
        one = self._routing.RegisterUnaryTransitVector([1] * (self._nodes + 1))
        self._routing.AddDimension(one, 0, self._nodes + 1, True, "order")
        order, waiting = self._routing.GetDimensionOrDie("order"), self._problem["waiting"]
        for number in range(1, waiting + 1):
            pickup, delivery = (self._manager.NodeToIndex(node) for node in (number, waiting + number))
            self._routing.AddPickupAndDelivery(pickup, delivery)
            self._routing.solver().Add(order.CumulVar(pickup) <= order.CumulVar(delivery))


def main() -> None:
    problem = json.load(sys.stdin)
    Search(problem).run(problem["seconds"])


if __name__ == "__main__":
    main()
