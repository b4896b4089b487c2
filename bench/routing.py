"""OR-Tools' routing solver on deliveries: one vehicle, pickup and delivery, guided local search.

A process of its own, with the Python that has OR-Tools (the group bench of pyproject.toml): `routes` starts it, reads
and writes JSON. Its time is processor time, as that of rosoclingo's solver is, so that other programs change neither's
plans.
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
"""Environment variable with the path of a Python that has OR-Tools; ./dev sets it. Without, it is this one."""

HOW = "OR-Tools is not there: ./dev bench many_goals installs it (once), or leave it out with --without-or-tools"

Visit = Tuple[str, Request]


class RoutingError(Exception):
    """There is no route; the message is why."""


class Route(NamedTuple):
    """The visits in their order, and the seconds of processor time after which they were known."""

    seconds: float
    visits: List[Visit]


def bench_python() -> str:
    """Return the path of the Python that has what benches compare with."""
    return os.environ.get(PYTHON) or sys.executable


def is_there() -> bool:
    """Whether OR-Tools can be asked."""
    try:
        found = subprocess.run([bench_python(), "-c", "import ortools"], capture_output=True, check=False)
    except OSError:
        return False
    return found.returncode == 0


def routes(floor: Floor, world: World, seconds: Sequence[float]) -> List[Route]:
    """The best routes that meet all of a world's requests after each of some ``seconds``; raises RoutingError."""
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
    """The last, and so the best, route that was found in time; the first one where there was none yet."""
    used, order = ([one for one in found if one[0] <= limit] or found[:1])[-1]
    return Route(used, [stops[stop - 1] for stop in order])


# ---- In the process that has OR-Tools --------------------------------------------------------------------------------


class Search:
    """One search: node 0 is where the vehicle is; then pickups, their deliveries, deliveries of what it carries."""

    def __init__(self, problem: Dict) -> None:
        from ortools.constraint_solver import pywrapcp

        self._problem = problem
        self._nodes = len(problem["distances"])
        self._end = self._nodes  # a node of its own, from which nothing is far: the vehicle need not come back
        self._manager = pywrapcp.RoutingIndexManager(self._nodes + 1, 1, [0], [self._end])
        self._routing = pywrapcp.RoutingModel(self._manager)
        self._demand()
        self._order()
        self._cost: Optional[int] = None  # of the best route yet
        self._begin = 0.0

    def run(self, seconds: float) -> None:
        """Search and write better and better routes; with so much processor time used, SIGPROF ends this process.

        The routing solver has limits by the wall clock alone; asking a clock of Python's slows it down. Insertion,
        which gives the better routes, begins with pairs, and finds no place for one where the vehicle begins full.
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
            self._routing.SolveWithParameters(parameters)  # ends only where it has found none

    def _found(self) -> None:
        """Write a route that is better than those before."""
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
        """Pickups come before their deliveries; the order says so, as distances between them may be 0."""
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
