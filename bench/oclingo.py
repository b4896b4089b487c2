#!/usr/bin/env python3
"""Measures the solver on the mailbot's program: offices in a row, random requests, the first plan and updates.

Each cycle commits and returns the action of the previous cycle. New requests arrive when all earlier ones are met; such
an update needs a search. The other updates are predicted. Wall time, without ROS.

Run it in the built workspace: ./dev exec python3 bench/oclingo.py
"""

import random
import statistics
import time

from deliveries import row
from figures import Figure, Option, main

from rosoclingo.oclingo import SolveOutcome, StreamUpdate, commitment, fact, parse_term
from rosoclingo.oclingo.progression.updates import CloseCycles, Expire
from rosoclingo.planning.solver import PlanSolver

BOUND = 200
"""Horizon bound, in steps after the present cycle."""


class Robot:
    """A solver and a robot that never fails, with one update a cycle."""

    def __init__(self, offices, requests, seed):
        self._solver, self._random = PlanSolver(row(offices).program), random.Random(seed)
        self._offices, self._requests, self._ids = offices, requests, 0
        self._cycle, self._plan = 0, {}
        self._solver.solve()

    def _requested(self):
        for _ in range(self._requests):
            self._ids += 1
            start, end = self._random.sample(range(1, self._offices + 1), 2)
            yield fact(parse_term(f"_request(goal(office{start},office{end},{self._ids}),{self._cycle + 1})"))

    def step(self):
        """Play one cycle; return the milliseconds of its update, and whether it had new requests."""
        action = self._plan.get(self._cycle)
        self._cycle += 1
        asks = not any(cycle >= self._cycle for cycle in self._plan)
        items = [*([commitment(action)] if action else ()), *(self._requested() if asks else ())]
        if action:
            items.append(fact(parse_term("_return({},{},{})".format(*action.arguments))))
        if self._cycle > 1:
            items += [CloseCycles(self._cycle - 1, self._cycle - 1), Expire(self._cycle - 1)]
        start = time.perf_counter()
        result = self._solver.update(StreamUpdate(self._cycle, BOUND, tuple(items)))
        seconds = time.perf_counter() - start
        if result.outcome is not SolveOutcome.SATISFIABLE:
            raise SystemExit(f"no plan: {result}")
        self._plan = {one.arguments[2].number: one for one in result.answers[0] if one.name == "_action_lib"}
        return 1000 * seconds, asks


def measure(options):
    """Yield the figures for each number of offices and requests."""
    for offices in options.offices:
        for requests in options.requests:
            robot = Robot(offices, requests, options.seed)
            first, *later = (robot.step() for _ in range(options.cycles))
            what = f"{offices} offices, {requests} requests: "
            yield Figure(what + "first plan", first[0], "ms")
            yield Figure(what + "update", statistics.median(one for one, _ in later), "ms")
            yield Figure(what + "slowest search", max((one for one, asks in later if asks), default=0.0), "ms")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        offices=Option([4, 10, 20], "numbers of offices", [4, 10]),
        requests=Option([1, 3, 5], "numbers of requests", [1, 3]),
        cycles=Option(60, "cycles of each run", 40),
        seed=Option(1, "seed of the requests"),
    )
