#!/usr/bin/env python3
"""Measures the core with many requests on rows of offices: first plan, plan lengths, and the steps executed in the end.

The core runs without ROS, with the mailbot's program and its solver in worker processes. As in the node, it improves
plans while actions run. A world with rules of its own executes the actions and checks the plans. The routing solver of
OR-Tools gets the same requests and the same time, Fast Downward the same task in PDDL. Seconds are processor time
except in "first" and "still", so the figures do not depend on other load of the machine.

A row is a floor (a number of offices in a row, or "loops": twenty offices with two loops), a number of requests, and
"once" (all requests are known at the start) or "stream" (one more every four actions, earlier if none is open).

Columns of the table:
  first [s]   wall time of the first plan without time to shorten it, its processor time (cpu [s]), its steps (first),
              and the number of requests that are queued and not served by it (wait)
  all [s]     a plan for all requests, without a limit for the search: seconds and steps (all); - after --limit
  1 s ...     steps of such a plan after this time, before any action: for the core and (or) for OR-Tools
  executed    executed steps. During each action, --action-time seconds are spent to improve the plan, or the standby
              worker plans for queued requests. OR-Tools (or executed) plans for 5 s and executes this plan; in a stream
              it plans again for 1 s with each request.
  ours/or     executed steps, core to OR-Tools
  lama-first  Fast Downward for requests known at once: seconds, translation included, and steps of its first plan
  lama        steps of the best plan of seq-sat-lama-2011 after --lama-seconds
  out [s]     seconds until the first action is sent; its plan serves the requests that are not queued
  longest [s] longest time until the next action is sent
  still [s]   longest wall time between a return and the next action of a plan in force; needs a quiet machine
  ms          processor time for an action, without improvement and prefetching
  queued      largest number of queued requests while an action was running

Run it in the built workspace: ./dev exec python3 bench/many_goals.py
./dev bench many_goals installs the other planners.
"""

import time
from collections import deque

import comparison
import fast_downward
import routing
from acting_core import Robot
from deliveries import actions_of_route, floor_named, office_of, random_requests, task_of
from figures import Option, main
from planning_domains import check

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.reasoning.settings import CoreSettings

GAP = 4  # actions between two requests of a stream
OR_SECONDS, OR_STREAM_SECONDS = 5.0, 1.0
TIMEOUT = CoreSettings.search_timeout

UNITS = {"first [s]": "s", "still [s]": "s", "wait": "requests", "queued": "requests", "ms": "ms of processor"}
UNITS.update(dict.fromkeys(("cpu [s]", "all [s]", "out [s]", "longest [s]"), "s of processor"))
UNITS.update(dict.fromkeys(("first", "all", "executed"), "steps"), **{"ours/or": ""})


class Arrivals:
    """Requests in the order of their arrival: one every ``gap`` actions, all at once if it is 0."""

    def __init__(self, numbers, gap):
        self._left, self._gap, self._count = deque(numbers), gap, 0

    def __bool__(self):
        return bool(self._left)

    def due(self, actions, busy):
        """Return the numbers that arrive after some actions; at least one if no request is open (not ``busy``)."""
        found = []
        while self._left and (self._gap * self._count <= actions or not (found or busy)):
            found.append(self._left.popleft())
            self._count += 1
        return found


def first_plan(task):
    """Return wall time and processor time (s) until the first plan, its steps, and the number of queued requests."""
    with Robot(task, search_timeout=TIMEOUT) as robot:
        begin, used = time.perf_counter(), robot.process.cpu_time
        robot.ask()
        steps = robot.plan()
        seconds, cpu = time.perf_counter() - begin, robot.process.cpu_time - used
        return {"first [s]": seconds, "cpu [s]": cpu, "first": steps, "wait": robot.waiting}


def best_after(plans, seconds):
    """Return the steps of the best plan after each time; None before the first plan."""
    grace = CoreParameters.plan_time / 2
    ends = {f"{limit:g} s": limit + grace for limit in seconds}
    return {name: min((steps for used, steps in plans if used <= end), default=None) for name, end in ends.items()}


def routes_after(floor, requests, task, seconds):
    """Return the steps of OR-Tools' plans after each time, and of the plan that it executes."""
    names = [*(f"or {limit:g} s" for limit in seconds), "or executed"]
    found = routing.routes(floor, 1, requests, [], [*seconds, OR_SECONDS])
    plans = [[[action] for action in actions_of_route(floor, 1, visits)] for visits in found]
    for plan in plans:
        check(task.world(), plan)
    return dict(zip(names, map(len, plans)))


def routes_executed(floor, requests, task):
    """Return the number of executed steps if OR-Tools plans again with each request."""
    world, arrivals, route, executed = task.world_type(task), Arrivals(range(len(requests)), GAP), deque(), 0
    while arrivals or world.open:
        fresh = arrivals.due(executed, world.open)
        if fresh:
            for number in fresh:
                world.ask(number + 1)
            known = [requests[number - 1] for number in world.open]
            carried = [one for one in known if ("carried", f"p{one.number}") in world.state]
            waiting, office = [one for one in known if one not in carried], office_of(world)
            visits = routing.routes(floor, office, waiting, carried, [OR_STREAM_SECONDS])[0]
            route = deque(actions_of_route(floor, office, visits))
        world.do([route.popleft()])
        executed += 1
    return {"or executed": executed}


def measure_row(name, count, how, options):
    """Return the cells of a row: column -> figure."""
    floor = floor_named(name)
    requests = random_requests(floor, count, options.seed)
    task, cells = task_of(floor, requests), {}
    if how == "once":
        cells.update(first_plan(task))
        cells["all [s]"], cells["all"] = comparison.first_plan(task, options.limit) or (None, None)
        plans = comparison.improved_plans(task, max(options.seconds), max(options.seconds))
        cells.update(best_after(plans, options.seconds))
    arrivals = Arrivals(range(1, count + 1), GAP if how == "stream" else 0)
    due = lambda robot: arrivals.due(robot.executed, robot.busy)  # noqa: E731
    cells.update(comparison.execute(task, options.action_time, TIMEOUT, due=due))
    if "or-tools" not in options.without:
        if how == "once":
            cells.update(routes_after(floor, requests, task, options.seconds))
        else:
            cells.update(routes_executed(floor, requests, task))
        cells["ours/or"] = cells["executed"] / cells["or executed"]
    if how == "once" and "fast-downward" not in options.without:
        cells.update(comparison.fast_downward_plans(task, options.limit, options.lama_seconds))
    return cells


def measure(options):
    """Print the table row by row; yield its figures."""
    for name, there, hint in (
        ("or-tools", routing.is_there(), routing.HOW),
        ("fast-downward", fast_downward.driver(), fast_downward.HOW),
    ):
        if not there and name not in options.without:
            print(hint)
            options.without = [*options.without, name]
    seconds = [f"{one:g} s" for one in options.seconds]
    columns = ["first [s]", "cpu [s]", "first", "wait", "all [s]", "all", *seconds, "executed"]
    if "or-tools" not in options.without:
        columns += [*(f"or {one}" for one in seconds), "or executed", "ours/or"]
    if "fast-downward" not in options.without:
        columns += ["lama-first [s]", "lama-first", "lama"]
    columns += ["out [s]", "longest [s]", "still [s]", "ms", "queued"]
    table = comparison.Table("floor/requests how", columns, {**UNITS, **dict.fromkeys(seconds, "steps")})
    for floor in options.floors:
        for count in options.requests:
            for how in options.how:
                yield from table.row(f"{floor}/{count} {how}", measure_row(floor, count, how, options))


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        shown=False,
        floors=Option(["4", "20", "50", "loops"], "floors", ["4", "20", "loops"]),
        requests=Option([3, 10, 20, 50, 100], "numbers of requests", [20]),
        how=Option(["once", "stream"], "arrival of requests", ["once"], ["once", "stream"]),
        seconds=Option([1.0, 5.0, 20.0], "times to compare plans at", [1.0, 5.0]),
        without=Option([], "planners to leave out", choices=["or-tools", "fast-downward"]),
        **comparison.OPTIONS,
    )
