#!/usr/bin/env python3
"""Measures the cost of a goal in a long run: processor time of the core and its solver.

The core runs without ROS, with the program of the office and its solver in a worker process. Each action returns its
success at once. Plan and goal events are converted to text, as the node publishes them. At the end, a long run and a
short one continue in turns.

Run it in the built workspace: ./dev exec python3 bench/long_run.py
"""

import random
import statistics

from acting_core import ENCODINGS, PooledCore
from figures import Figure, Option, main

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.events import GoalProgress, PlanMade

BATCH = 2  # goals sent at once
PROGRAM = [ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp"]


def office_goal(source, number):
    """Return a random goal for the row of four offices."""
    start, end = source.sample(range(1, 5), 2)
    return f"goal(office{start},office{end},{number})"


class Run(PooledCore):
    """A core whose actions return at once; ``bytes`` counts the text that the node would publish."""

    def __init__(self):
        super().__init__(ReactiveProgram.from_files(PROGRAM), standby=False)
        self._source, self._number, self.bytes = random.Random(1), 0, 0

    def note(self, event):
        """Count the text of the actions in a plan."""
        if isinstance(event, (PlanMade, GoalProgress)):
            self.bytes += sum(len(str(action.atom)) for action in event.actions)

    def goals(self):
        """Execute a batch of goals; return the processor time in ms and the published kB of a goal."""
        begin, size = self.used, self.bytes
        for _ in range(BATCH):
            self._number += 1
            self.core.add_goal(str(self._number), office_goal(self._source, self._number))
        while self.core.live_goals:
            self.advance()
            self.answer()
        return 1000 * (self.used - begin) / BATCH, (self.bytes - size) / 1000 / BATCH


def measure(options):
    """Continue a long and a short run in turns, so that other programs slow down both; yield the figures."""
    with Run() as long, Run() as short:
        for run, cycles in ((long, options.cycles), (short, options.short_cycles)):
            while run.core.cycle < cycles:
                run.goals()
        found, ends = {long: [], short: []}, {run: run.core.cycle + options.window for run in (long, short)}
        while any(run.core.cycle < end for run, end in ends.items()):
            for run in found:
                found[run].append(run.goals())
    (ours, kilobytes), (theirs, _) = ([statistics.mean(part) for part in zip(*one)] for one in found.values())
    yield Figure("a goal of the long run", ours, "ms of processor")
    yield Figure("a goal of the short run", theirs, "ms of processor")
    yield Figure("long over short", ours / theirs, "")
    yield Figure("published for a goal", kilobytes, "kB")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        cycles=Option(10000, "cycles of the long run", 300),
        short_cycles=Option(100, "cycles of the short run", 30),
        window=Option(400, "cycles of the comparison", 60),
    )
