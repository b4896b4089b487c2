#!/usr/bin/env python3
"""Times the report that goals are impossible after a blocked connection has cut them off.

The pure core with the mailbot's program on a row of offices, its solver in a process of its own. Some requests are
known at once; after three actions the connection in the middle is reported as blocked. Goals behind it have to end as
aborted, and no others. Seconds are of processor time, of the core and its solver.
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
    """A core whose actions all succeed; ``ended`` has the outcomes of goals."""

    def __init__(self, floor):
        super().__init__(mailbot_program(floor), CoreParameters.plan_time)
        self.ended = {}

    def act(self, *facts):
        """Return the awaited actions, together with some facts; return the seconds to the next ones."""
        begin = time.process_time() + self.process.cpu_time
        self.core.receive("bench", [*facts, *map(returned, self.core.awaited)])
        self.advance()
        return time.process_time() + self.process.cpu_time - begin

    def note(self, event):
        """Note the end of a goal."""
        if isinstance(event, GoalChanged) and event.outcome is not None:
            self.ended[event.key] = event.outcome


def measure(offices, count, seed):
    """Seconds until the goals that are cut off have ended, and their number."""
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
            raise SystemExit(f"requests ended neither as succeeded nor as aborted: {run.ended}")
        return seconds, len(outcomes)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--offices", type=int, nargs="+", default=[4, 10, 20], help="(default: %(default)s)")
    parser.add_argument("--requests", type=int, nargs="+", default=[6, 10], help="(default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the requests (default: %(default)s)")
    options = parse(parser, offices=[4, 20], requests=[6])
    found = []
    for offices in options.offices:
        for count in options.requests:
            seconds, aborted = measure(offices, count, options.seed)
            print(f"{offices} offices, {count} requests: {aborted} reported as cut off after {seconds:.2f} s")
            found.append(Figure(f"{offices} offices, {count} requests: told", seconds, "s of processor"))
    write(options.json, found)


if __name__ == "__main__":
    main()
