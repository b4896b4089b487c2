#!/usr/bin/env python3
"""Measures how soon the core aborts goals that a blocked connection cuts off.

The core runs without ROS, with the mailbot's program on a row of offices and its solver in a worker process. All
requests are known at the start. After three actions, the connection in the middle is reported as blocked. The goals
behind it must end as aborted, and no others. Seconds are processor time of the core and its solver.

Run it in the built workspace: ./dev exec python3 bench/cut_off.py
"""

from itertools import product

from acting_core import PooledCore
from deliveries import random_requests, row
from figures import Figure, Option, main

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.reasoning.goals import Outcome


def cut_off(offices, count, seed):
    """Return the seconds until the goals that are cut off have ended, and their number."""
    floor, middle = row(offices), offices // 2
    with PooledCore(floor.program, CoreParameters.plan_time) as robot:
        for request in random_requests(floor, count, seed):
            robot.core.add_goal(str(request.number), request.goal)
        robot.advance()
        for _ in range(3):
            robot.answer()
            robot.advance()
        begin = robot.used
        robot.answer(f"_blocked(office{middle},office{middle + 1},{robot.core.cycle})")
        robot.advance()
        outcomes = [one for one in robot.outcomes.values() if one is not Outcome.SUCCEEDED]
        if set(outcomes) - {Outcome.ABORTED}:
            raise SystemExit(f"some goals ended neither as succeeded nor as aborted: {robot.outcomes}")
        return robot.used - begin, len(outcomes)


def measure(options):
    """Yield the figures for each number of offices and requests."""
    for offices, count in product(options.offices, options.requests):
        seconds, aborted = cut_off(offices, count, seed=1)
        yield Figure(f"{offices} offices, {count} requests: aborted", seconds, "s of processor")
        yield Figure(f"{offices} offices, {count} requests: number aborted", aborted, "goals", "higher")


if __name__ == "__main__":
    offices = Option([4, 10, 20], "numbers of offices", [4, 20])
    main(__doc__, measure, offices=offices, requests=Option([6, 10], "numbers of requests", [6]))
