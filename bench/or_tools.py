"""The process in which OR-Tools plans a route: one vehicle, pickup and delivery, guided local search.

It reads a problem of ``routing.py`` as JSON, and writes each better route with the processor time until then. It runs
with the Python that has OR-Tools, which has no other library of this project.
"""

import json
import signal
import sys
import time
from typing import Dict, List, Optional

from ortools.constraint_solver import pywrapcp, routing_enums_pb2


class Search:
    """One search for a route.

    Node 0 is the place of the vehicle. Pickups follow, then their deliveries, then deliveries of carried packages.
    """

    def __init__(self, problem: Dict) -> None:
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


if __name__ == "__main__":
    task = json.load(sys.stdin)
    Search(task).run(task["seconds"])
