#!/usr/bin/env python3
"""Measures the cost of a goal in a long run: processor time of the core and its solver.

The core runs without ROS, with the program of a house or a row of offices and its solver in a worker process. Each
action returns at once, with success or sometimes a failure. Plan and goal events are converted to text, as the node
publishes them. At the end, a long run and a short one continue in turns.

Run it in the built workspace: ./dev exec python3 bench/long_run.py
"""

import argparse
import random
import statistics
import time

from acting_core import ENCODINGS, PooledCore, returned
from figures import Figure, parse, write

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.events import GoalProgress, PlanMade

OFFICES = ["office1", "office2", "office3", "office4"]
ROOMS = ["hallway", "kitchen", "living_room", "bathroom", "study", "bedroom"]
THINGS = ["cup", "tray", "book", "newspaper", "towel"]


def office_goal(source, number):
    """Return a goal for the row of offices."""
    start, end = source.sample(OFFICES, 2)
    return f"goal({start},{end},{number})"


def house_goal(source, number):
    """Return a goal for the house; goals in a row are about different things."""
    return f"bring({source.choice(ROOMS)},{THINGS[number % len(THINGS)]})"


PROGRAMS = {"mailbot": (["mailbot.lp", "office.lp"], office_goal), "house": (["house.lp", "home.lp"], house_goal)}


def load(name):
    """Return the program ``name``, and a function that generates goals for it."""
    names, goal = PROGRAMS[name]
    return ReactiveProgram.from_files([ENCODINGS / one for one in names]), goal


def answer(action, source, failures):
    """Return the text of an action's return; the fraction ``failures`` of the actions fails."""
    return returned(action, "failed" if source.random() < failures else None)


class Run(PooledCore):
    """A core whose actions return at once; ``bytes`` counts the text that the node would publish."""

    def __init__(self, program, goal, failures):
        super().__init__(program, standby=False)
        self._goal, self._failures = goal, failures
        self._source, self._number, self.bytes = random.Random(1), 0, 0

    def note(self, event):
        """Count the text of the actions in a plan."""
        if isinstance(event, (PlanMade, GoalProgress)):
            self.bytes += sum(len(str(action.atom)) for action in event.actions)

    def goals(self, count):
        """Execute ``count`` goals; return the processor time in seconds and the published bytes per goal."""
        seconds, size = time.process_time() + self.process.cpu_time, self.bytes
        for _ in range(count):
            self._number += 1
            self.core.add_goal(str(self._number), self._goal(self._source, self._number))
        while self.core.live_goals:
            self.advance()
            for action in self.core.awaited:
                self.core.receive("bench", [answer(action, self._source, self._failures)])
        seconds = time.process_time() + self.process.cpu_time - seconds
        return seconds / count, (self.bytes - size) / count


def grow(run, cycles, batch, step=500):
    """Continue a run up to a cycle, and print the cost of a goal at intervals."""
    mark, sample = run.core.cycle + step, []
    while run.core.cycle < cycles:
        sample.append(run.goals(batch))
        if run.core.cycle >= mark:
            print(f"cycle {run.core.cycle:6d}: {describe(sample)}", flush=True)
            mark, sample = mark + step, []


def compare(long, short, cycles, batch):
    """Continue two runs in turns, so that other programs slow down both; return the figures."""
    samples = {long: [], short: []}
    ends = {run: run.core.cycle + cycles for run in samples}
    while any(run.core.cycle < end for run, end in ends.items()):
        for run, sample in samples.items():
            sample.append(run.goals(batch))
    for run, sample in samples.items():
        print(f"up to cycle {run.core.cycle:6d}: {describe(sample)}")
    seconds = [statistics.mean(one for one, _ in sample) for sample in samples.values()]
    print(f"a goal of the long run costs {seconds[0] / seconds[1]:.2f} times one of the short run")
    costs = [Figure(f"a goal of the {name} run", 1000 * one, "ms") for name, one in zip(("long", "short"), seconds)]
    size = statistics.mean(size for _, size in samples[long])
    ratio = Figure("long over short", seconds[0] / seconds[1], "")
    return [*costs, ratio, Figure("published for a goal", size / 1000, "kB")]


def describe(sample):
    """Return the means of a sample as text."""
    seconds, size = map(statistics.mean, zip(*sample))
    return f"{1000 * seconds:6.1f} ms a goal, {size / 1000:5.1f} kB published"


def add_run(parser, failures):
    """Add the options of a run to ``parser``."""
    parser.add_argument(
        "--program", choices=PROGRAMS, default="mailbot", help="program of the core (default: %(default)s)"
    )
    parser.add_argument("--batch", type=int, default=2, help="goals sent at once (default: %(default)s)")
    parser.add_argument(
        "--failures", type=float, default=failures, help="fraction of actions that fail (default: %(default)s)"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_run(parser, failures=0.0)
    parser.add_argument("--cycles", type=int, default=10000, help="cycles of the long run (default: %(default)s)")
    parser.add_argument("--short-cycles", type=int, default=100, help="cycles of the short run (default: %(default)s)")
    parser.add_argument("--window", type=int, default=400, help="cycles of the comparison (default: %(default)s)")
    options = parse(parser, cycles=300, short_cycles=30, window=60)
    program, goal = load(options.program)
    with Run(program, goal, options.failures) as long, Run(program, goal, options.failures) as short:
        grow(long, options.cycles, options.batch)
        grow(short, options.short_cycles, options.batch)
        write(options.json, compare(long, short, options.window, options.batch))


if __name__ == "__main__":
    main()
