#!/usr/bin/env python3
"""Measures the solver on the mailbot's program: offices in a row, random requests, 60 cycles each.

For each number of offices and requests, the table shows the time of the first plan (s) and of updates (ms): the median,
the slowest update with new requests (a search) and without, and the medians of the first and the last ten cycles. Each
cycle commits and returns the action of the previous cycle. New requests arrive when all earlier ones are met.
"""

import argparse
import random
import statistics
import time
from typing import Tuple

from acting_core import mailbot_program
from deliveries import row
from figures import Figure, parse, write

from rosoclingo.oclingo import SolveOutcome, StreamUpdate, commitment, fact, parse_term
from rosoclingo.oclingo.progression.updates import CloseCycles, Expire
from rosoclingo.planning.solver import PlanSolver

BOUND = 200
"""Horizon bound, in steps after the present cycle."""


class Robot:
    """A core and a robot that never fails, with one update a cycle."""

    def __init__(self, offices: int, requests: int, seed: int) -> None:
        self.solver = PlanSolver(mailbot_program(row(offices)))
        self.random = random.Random(seed)
        self.offices, self.requests, self.ids = offices, requests, 0
        self.cycle = 0
        self.plan = {}
        self.solver.solve()

    def new_requests(self) -> list:
        items = []
        for _ in range(self.requests):
            self.ids += 1
            start, end = self.random.sample(range(1, self.offices + 1), 2)
            goal = f"goal(office{start},office{end},{self.ids})"
            items.append(fact(parse_term(f"_request({goal},{self.cycle + 1})")))
        return items

    def step(self) -> Tuple[float, bool]:
        """Play one cycle; return the seconds of its update, and whether it had new requests."""
        before = self.plan.get(self.cycle)
        self.cycle += 1
        items = []
        if before is not None:
            items.append(commitment(before))
        asks = not any(cycle >= self.cycle for cycle in self.plan)
        if asks:
            items += self.new_requests()
        if before is not None:
            name, what, cycle = before.arguments
            items.append(fact(parse_term(f"_return({name},{what},{cycle})")))
        if self.cycle > 1:
            items += [CloseCycles(self.cycle - 1, self.cycle - 1), Expire(self.cycle - 1)]
        start = time.perf_counter()
        result = self.solver.update(StreamUpdate(self.cycle, BOUND, tuple(items)))
        seconds = time.perf_counter() - start
        assert result.outcome is SolveOutcome.SATISFIABLE, result
        actions = [one for one in result.answers[0] if one.name == "_action_lib"]
        self.plan = {one.arguments[2].number: one for one in actions}
        return seconds, asks


def run(offices: int, requests: int, cycles: int, seed: int) -> list:
    """Print one line of the table; return its figures."""
    robot = Robot(offices, requests, seed)
    times = [robot.step() for _ in range(cycles)]
    later = [1000 * one for one, _ in times[1:]]
    searches = [1000 * one for one, asks in times[1:] if asks]
    others = [1000 * one for one, asks in times[1:] if not asks]
    figures = (
        times[0][0],
        statistics.median(later),
        max(searches, default=0.0),
        max(others, default=0.0),
        statistics.median(later[:10]),
        statistics.median(later[-10:]),
    )
    line = "{:8d} {:9d} {:11.3f} {:11.2f} {:19.2f} {:7.2f} {:10.2f} {:14.2f}"
    print(line.format(offices, requests, *figures), flush=True)
    what = f"{offices} offices, {requests} requests: "
    return [Figure(what + "first plan", 1000 * figures[0], "ms"), Figure(what + "update", figures[1], "ms")]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--offices", type=int, nargs="+", default=[4, 10, 20], help="numbers of offices (default: %(default)s)"
    )
    parser.add_argument(
        "--requests", type=int, nargs="+", default=[1, 3, 5], help="numbers of requests (default: %(default)s)"
    )
    parser.add_argument("--cycles", type=int, default=60, help="cycles of each run (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the requests (default: %(default)s)")
    options = parse(parser, offices=[4, 10], requests=[1, 3], cycles=40)
    print("offices  requests  first [s]  median [ms]  worst: search [ms]  other  first ten  last ten [ms]")
    pairs = [(offices, requests) for offices in options.offices for requests in options.requests]
    found = [one for pair in pairs for one in run(*pair, options.cycles, options.seed)]
    write(options.json, found)


if __name__ == "__main__":
    main()
