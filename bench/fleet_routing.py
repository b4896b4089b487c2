"""Plans a fleet's deliveries with the routing solver of OR-Tools; prints the makespan in seconds.

bench/fleet.py starts this file with the Python that has OR-Tools, and sends the problem as JSON: the times between the
places (of the robots, of the pickups, of the deliveries), with the time to handle a package at the first of them.
"""

import json
import sys

from ortools.constraint_solver import pywrapcp, routing_enums_pb2


def makespan(problem):
    """Return the makespan of the best plan after the time limit; None if there is none."""
    robots, requests = problem["robots"], problem["requests"]
    nodes = len(problem["times"])
    manager = pywrapcp.RoutingIndexManager(nodes + 1, robots, list(range(robots)), [nodes] * robots)
    routing = pywrapcp.RoutingModel(manager)
    matrix = [[*map(int, row), 0] for row in problem["times"]] + [[0] * (nodes + 1)]
    for number, row in enumerate(matrix[:-1]):
        row[nodes] = row[number]  # the time to handle the last package; the way to the common end takes none
    times = routing.RegisterTransitMatrix(matrix)
    routing.SetArcCostEvaluatorOfAllVehicles(times)
    routing.AddDimension(times, 0, 10**7, True, "time")
    loads = routing.RegisterUnaryTransitVector([0] * robots + [1] * requests + [-1] * requests + [0])
    routing.AddDimension(loads, 0, problem["capacity"], True, "load")
    routing.AddDimension(routing.RegisterUnaryTransitVector([1] * (nodes + 1)), 0, nodes + 1, True, "order")
    span, order = routing.GetDimensionOrDie("time"), routing.GetDimensionOrDie("order")
    span.SetGlobalSpanCostCoefficient(100)
    for number in range(requests):
        pickup, delivery = (manager.NodeToIndex(robots + number + more) for more in (0, requests))
        routing.AddPickupAndDelivery(pickup, delivery)
        routing.solver().Add(routing.VehicleVar(pickup) == routing.VehicleVar(delivery))
        routing.solver().Add(order.CumulVar(pickup) <= order.CumulVar(delivery))
    parameters = pywrapcp.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = routing_enums_pb2.FirstSolutionStrategy.PARALLEL_CHEAPEST_INSERTION
    parameters.local_search_metaheuristic = routing_enums_pb2.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    parameters.time_limit.FromSeconds(int(problem["seconds"]))
    found = routing.SolveWithParameters(parameters)
    return None if found is None else max(found.Min(span.CumulVar(routing.End(one))) for one in range(robots))


if __name__ == "__main__":
    length = makespan(json.load(sys.stdin))
    sys.exit("no plan") if length is None else print(length)
