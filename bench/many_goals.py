#!/usr/bin/env python3
"""Measures the core with many requests on rows of offices: first plan, plan lengths, and the steps executed in the end.

The core runs without ROS, with the mailbot's program and its solver in worker processes. As in the node, it improves
plans while actions run. A world with rules of its own executes the actions and checks the plans. The routing solver of
OR-Tools gets the same requests. Seconds are processor time except in "still", so that the figures do not depend on
other load of the machine.

A row is a floor (a number of offices in a row, or "loops": twenty offices with two loops), a number of requests, and
"once" (all requests are known at the start) or "stream" (one more every four actions, earlier if none is open).

Figures of a row:
  first [s]   the first plan without time to shorten it: seconds, its steps (first), and the number of requests that are
              queued and not served by it (wait)
  all [s]     a plan for all requests, without a limit for the search: seconds and steps (all); - after --limit
  executed    executed steps. During each action, --action-time seconds are spent to improve the plan, or the standby
              worker plans for queued requests.
  or          steps of OR-Tools' plan after 5 s; in a stream, it plans again for 1 s with each request
  out [s]     seconds until the first action is sent; its plan serves the requests that are not queued
  still [s]   longest wall time between a return and the next action of a plan in force; needs a quiet machine

Run it in the built workspace: ./dev exec python3 bench/many_goals.py
./dev bench many_goals installs OR-Tools.
"""

from collections import deque
from itertools import product

import peers
from acting_core import OPTIONS, Arrivals, execute, first_plan
from deliveries import actions_of_route, floor_named, office_of, random_requests, task_of
from figures import Option, main, row_figures
from planning_domains import check

from rosoclingo.reasoning.settings import CoreSettings

GAP = 4  # actions between two requests of a stream
OR_SECONDS, OR_STREAM_SECONDS = 5.0, 1.0

UNITS = {"first [s]": "s of processor", "first": "steps", "wait": "requests", "all [s]": "s of processor"}
UNITS.update({"all": "steps", "executed": "steps", "or": "steps", "out [s]": "s of processor", "still [s]": "s"})


def routes_planned(floor, requests, task):
    """Return the number of steps of OR-Tools' plan for all requests."""
    (visits,) = peers.routes(floor, [1], requests, seconds=OR_SECONDS)
    plan = actions_of_route(floor, 1, visits)
    check(task.world(), [[action] for action in plan])
    return len(plan)


def routes_executed(floor, requests, task):
    """Return the number of executed steps if OR-Tools plans again with each request."""
    world, arrivals, route, executed = task.world_type(task), Arrivals(len(requests), GAP), deque(), 0
    while arrivals or world.open:
        fresh = arrivals.due(executed, world.open)
        if fresh:
            for number in fresh:
                world.ask(number)
            known = [requests[number - 1] for number in world.open]
            carried = [one for one in known if ("carried", f"p{one.number}") in world.state]
            waiting, office = [one for one in known if one not in carried], office_of(world)
            (visits,) = peers.routes(floor, [office], waiting, carried, OR_STREAM_SECONDS)
            route = deque(actions_of_route(floor, office, visits))
        world.do([route.popleft()])
        executed += 1
    return executed


def measure_row(name, count, how, options):
    """Return the figures of a row."""
    floor = floor_named(name)
    requests = random_requests(floor, count, options.seed)
    task, cells = task_of(floor, requests), {}
    if how == "once":
        first, whole = first_plan(task, timeout=CoreSettings.search_timeout), first_plan(task, limit=options.limit)
        cells.update({"first [s]": first.seconds, "first": first.steps, "wait": first.queued})
        cells.update({"all [s]": whole.seconds, "all": whole.steps} if whole else {})
    cells.update(execute(task, options.action_time, gap=GAP if how == "stream" else 0))
    if peers.folder_of(peers.OR_TOOLS):
        cells["or"] = (routes_planned if how == "once" else routes_executed)(floor, requests, task)
    return cells


def measure(options):
    """Yield the figures of all rows."""
    for floor, count, how in product(options.floors, options.requests, options.how):
        yield from row_figures(f"{floor}/{count} {how}", measure_row(floor, count, how, options), UNITS)


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        floors=Option(["4", "20", "50", "loops"], "floors", ["4", "20", "loops"]),
        requests=Option([3, 10, 20, 50, 100], "numbers of requests", [20]),
        how=Option(["once", "stream"], "arrival of requests", ["once"], ["once", "stream"]),
        **OPTIONS,
    )
