#!/usr/bin/env python3
"""Measures how long it takes until goals are told that they cannot be met, as a blocked connection cuts them off.

The pure core with the mailbot's program on a row of offices, its solver in a process of its own, as the node has both.
Some requests are known at once; after a few actions the connection in the middle is told to be blocked. Goals that it
cuts off have to end as aborted, with that for a reason, the others must not. Seconds are of processor time, of the core
and its solver. To be run in the built workspace: ./dev exec python3 bench/cut_off.py
"""

import argparse
import time

from acting_core import PooledCore, mailbot_program
from deliveries import floor_named, random_requests
from figures import Figure, parse, write

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.reasoning import GoalChanged, Outcome

DONE = 3
"""Actions that have been done when the connection is blocked."""


class Run(PooledCore):
    """A core whose actions all succeed; it has ended the goals in ``ended``, with these outcomes."""

    def __init__(self, floor):
        super().__init__(mailbot_program(floor), CoreParameters.plan_time)
        self.ended = {}

    @property
    def used(self):
        """Seconds of processor time of this process and the solver's."""
        return time.process_time() + self.process.cpu_time

    def act(self, *facts):
        """Answer the actions that are out, and tell some facts beside."""
        answers = [f"_return({one.interface},{one.parameter},{one.cycle})" for one in self.core.awaited]
        self.core.receive("bench", [*facts, *answers])
        self.advance()

    def note(self, event):
        """Note how a goal has ended."""
        if isinstance(event, GoalChanged) and event.outcome is not None:
            self.ended[event.key] = event.outcome


def measure(offices, count, seed):
    """Seconds until the goals that are cut off have ended, and how many they are."""
    floor = floor_named(str(offices))
    middle = offices // 2
    with Run(floor) as run:
        for request in random_requests(floor, count, seed):
            run.core.add_goal(str(request.number), request.goal)
        run.advance()
        for _ in range(DONE):
            run.act()
        begin = run.used
        run.act(f"_blocked(office{middle},office{middle + 1},{run.core.cycle})")
        told = {key: one for key, one in run.ended.items() if one is not Outcome.SUCCEEDED}
        wrong = [key for key, one in told.items() if one is not Outcome.ABORTED]
        if wrong:
            raise SystemExit(f"requests {', '.join(wrong)} ended neither as met nor as aborted")
        return run.used - begin, len(told)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--offices", type=int, nargs="+", default=[4, 10, 20], help="(default: %(default)s)")
    parser.add_argument("--requests", type=int, nargs="+", default=[6, 10], help="(default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the requests (default: %(default)s)")
    options = parse(parser, offices=[4, 20], requests=[6])
    found = []
    for offices in options.offices:
        for count in options.requests:
            seconds, told = measure(offices, count, options.seed)
            print(f"{offices} offices, {count} requests: {told} told that they are cut off after {seconds:.2f} s")
            found.append(Figure(f"{offices} offices, {count} requests: told", seconds, "s of processor"))
    write(options.json, found)


if __name__ == "__main__":
    main()
