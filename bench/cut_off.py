#!/usr/bin/env python3
"""Measures how soon the core aborts goals that a blocked connection cuts off.

The core runs without ROS, with the mailbot's program on a row of offices and its solver in a worker process. All
requests are known at the start. After three actions, the connection in the middle is reported as blocked. The goals
behind it must end as aborted, and no others. Seconds are processor time of the core and its solver.

Run it in the built workspace: ./dev exec python3 bench/cut_off.py
"""

import argparse
import time

from acting_core import PooledCore, mailbot_program, returned
from deliveries import floor_named, random_requests
from figures import Figure, parse, write

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.goals import Outcome


class Run(PooledCore):
    """A core whose actions all succeed; ``ended`` maps goals to their outcomes."""

    def __init__(self, floor):
        super().__init__(mailbot_program(floor), CoreParameters.plan_time)
        self.ended = {}

    def act(self, *facts):
        """Send returns of the awaited actions and some facts; return the seconds until the next actions."""
        begin = time.process_time() + self.process.cpu_time
        self.core.receive("bench", [*facts, *map(returned, self.core.awaited)])
        self.advance()
        return time.process_time() + self.process.cpu_time - begin

    def note(self, event):
        """Record the end of a goal."""
        if isinstance(event, GoalChanged) and event.outcome is not None:
            self.ended[event.key] = event.outcome


def measure(offices, count, seed):
    """Return the seconds until the goals that are cut off have ended, and their number."""
    floor, middle = floor_named(str(offices)), offices // 2
    with Run(floor) as run:
        for request in random_requests(floor, count, seed):
            run.core.add_goal(str(request.number), request.goal)
        run.advance()
        for _ in range(3):
            run.act()
        seconds = run.act(f"_blocked(office{middle},office{middle + 1},{run.core.cycle})")
        outcomes = [one for one in run.ended.values() if one is not Outcome.SUCCEEDED]
        if set(outcomes) - {Outcome.ABORTED}:
            raise SystemExit(f"some goals ended neither as succeeded nor as aborted: {run.ended}")
        return seconds, len(outcomes)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--offices", type=int, nargs="+", default=[4, 10, 20], help="numbers of offices (default: %(default)s)"
    )
    parser.add_argument(
        "--requests", type=int, nargs="+", default=[6, 10], help="numbers of requests (default: %(default)s)"
    )
    parser.add_argument("--seed", type=int, default=1, help="seed of the requests (default: %(default)s)")
    options = parse(parser, offices=[4, 20], requests=[6])
    found = []
    for offices in options.offices:
        for count in options.requests:
            seconds, aborted = measure(offices, count, options.seed)
            print(f"{offices} offices, {count} requests: {aborted} aborted after {seconds:.2f} s")
            found.append(Figure(f"{offices} offices, {count} requests: aborted", seconds, "s of processor"))
    write(options.json, found)


if __name__ == "__main__":
    main()
