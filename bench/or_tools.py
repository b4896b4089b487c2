"""The process in which OR-Tools plans deliveries: pickups and deliveries of robots, by guided local search.

It reads a problem of ``peers.py`` as JSON, and writes each better solution: for each robot, the numbers of its stops.
It runs with the Python that has OR-Tools, which has no other library of this project.
"""

import json
import signal
import sys

from ortools.constraint_solver import pywrapcp, routing_enums_pb2


class Search:
    """One search for routes.

    The first nodes are the places of the robots. Stops follow: pickups, their deliveries, and deliveries of carried
    packages. The last node is the end of all routes, to which no robot has to drive.
    """

    def __init__(self, problem):
        self._problem, self._robots, self._best = problem, problem["robots"], None
        self._end = len(problem["times"])
        starts, ends = list(range(self._robots)), [self._end] * self._robots
        self._manager = pywrapcp.RoutingIndexManager(self._end + 1, self._robots, starts, ends)
        self._routing = pywrapcp.RoutingModel(self._manager)
        self._limit_load()
        self._order_stops(self._take_time())

    def run(self, seconds):
        """Search for better and better routes and write them; SIGPROF ends this process after ``seconds``.

        SIGPROF measures processor time. The routing solver only supports limits of wall time, and reading a clock in
        Python slows it down. Insertion finds better routes, but inserts pairs first, which fails if the robot is full
        at the start.
        """
        parameters = pywrapcp.DefaultRoutingSearchParameters()
        strategies = routing_enums_pb2.FirstSolutionStrategy
        parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
        parameters.time_limit.FromSeconds(24 * 3600)  # guided local search never ends by itself
        self._routing.AddAtSolutionCallback(self._write)
        signal.setitimer(signal.ITIMER_PROF, seconds)
        for strategy in (strategies.PARALLEL_CHEAPEST_INSERTION, strategies.PATH_CHEAPEST_ARC):
            parameters.first_solution_strategy = strategy
            self._routing.SolveWithParameters(parameters)  # returns only if it finds no route

    def _write(self):
        """Write the present routes if they are better than all earlier ones."""
        cost = self._routing.CostVar().Max()
        if self._best is None or cost < self._best:
            self._best = cost
            print(json.dumps([self._stops(robot) for robot in range(self._robots)]), flush=True)

    def _stops(self, robot):
        index, stops = self._routing.Start(robot), []
        while not self._routing.IsEnd(index):
            index = self._routing.NextVar(index).Value()
            stops.append(self._manager.IndexToNode(index) - self._robots)
        return stops[:-1]

    def _limit_load(self):
        waiting, carried = self._problem["waiting"], self._problem["carried"]
        loads = [carried, *[0] * (self._robots - 1), *[1] * waiting, *[-1] * (waiting + carried), 0]
        load = self._routing.RegisterUnaryTransitVector(loads)
        self._routing.AddDimension(load, 0, self._problem["capacity"], True, "load")

    def _take_time(self):
        """Minimize the time of the last robot, or of the only one; return the dimension of times."""
        times = [[*row, row[number]] for number, row in enumerate(self._problem["times"])]
        matrix = self._routing.RegisterTransitMatrix([*times, [0] * (self._end + 1)])
        self._routing.SetArcCostEvaluatorOfAllVehicles(matrix)
        self._routing.AddDimension(matrix, 0, 10**7, True, "time")
        time = self._routing.GetDimensionOrDie("time")
        if self._robots > 1:
            time.SetGlobalSpanCostCoefficient(100)
        return time

    def _order_stops(self, time):
        """Require pickups before their deliveries, by the same robot."""
        routing, waiting = self._routing, self._problem["waiting"]
        for number in range(self._robots, self._robots + waiting):
            pickup, delivery = (self._manager.NodeToIndex(node) for node in (number, number + waiting))
            routing.AddPickupAndDelivery(pickup, delivery)
            routing.solver().Add(routing.VehicleVar(pickup) == routing.VehicleVar(delivery))
            routing.solver().Add(time.CumulVar(pickup) <= time.CumulVar(delivery))


if __name__ == "__main__":
    task = json.load(sys.stdin)
    Search(task).run(task["seconds"])
