#!/usr/bin/env python3
"""Measures the cost of a goal in a long run: processor time of the core and its solver.

The pure core with the program of a house or a row of offices, its solver in a process of its own. Each action is
returned at once, as a success or sometimes a failure; events of plan and goals are written as the node publishes them.
At the end a long run and a short one continue in turns.
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
    """A goal for the row of offices."""
    start, end = source.sample(OFFICES, 2)
    return f"goal({start},{end},{number})"


def house_goal(source, number):
    """A goal for the house, for another thing than the goals before."""
    return f"bring({source.choice(ROOMS)},{THINGS[number % len(THINGS)]})"


PROGRAMS = {"mailbot": (["mailbot.lp", "office.lp"], office_goal), "house": (["house.lp", "home.lp"], house_goal)}


def load(name):
    """The program of a name, and a function that makes goals for it."""
    names, goal = PROGRAMS[name]
    return ReactiveProgram.from_files([ENCODINGS / one for one in names]), goal


def answer(action, source, failures):
    """The return of an action; a share of the actions fails."""
    return returned(action, "failed" if source.random() < failures else None)


class Run(PooledCore):
    """A core whose actions are returned at once; ``bytes`` counts the text that the node would publish."""

    def __init__(self, program, goal, failures):
        super().__init__(program, standby=False)
        self._goal, self._failures = goal, failures
        self._source, self._number, self.bytes = random.Random(1), 0, 0

    def note(self, event):
        """Write the actions of a plan."""
        if isinstance(event, (PlanMade, GoalProgress)):
            self.bytes += sum(len(str(action.atom)) for action in event.actions)

    def goals(self, count):
        """Send goals and return actions until all have ended; return seconds of processor time and bytes for each."""
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
    """Continue a run up to a cycle, and print the cost of a goal on the way."""
    mark, sample = run.core.cycle + step, []
    while run.core.cycle < cycles:
        sample.append(run.goals(batch))
        if run.core.cycle >= mark:
            print(f"cycle {run.core.cycle:6d}: {describe(sample)}", flush=True)
            mark, sample = mark + step, []


def compare(long, short, cycles, batch):
    """Continue two runs for some cycles in turns, so that other programs slow both; return the figures."""
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
    return [*costs, Figure("long over short", seconds[0] / seconds[1], ""), Figure("told of a goal", size / 1000, "kB")]


def describe(sample):
    """The means of a sample, in words."""
    seconds, size = map(statistics.mean, zip(*sample))
    return f"{1000 * seconds:6.1f} ms a goal, {size / 1000:5.1f} kB published"


def add_run(parser, failures):
    """Add the options of a run: its program, how many goals come at once, and the share of actions that fail."""
    parser.add_argument("--program", choices=PROGRAMS, default="mailbot", help="(default: %(default)s)")
    parser.add_argument("--batch", type=int, default=2, help="goals at once (default: %(default)s)")
    parser.add_argument(
        "--failures", type=float, default=failures, help="share of actions that fail (default: %(default)s)"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_run(parser, failures=0.0)
    parser.add_argument("--cycles", type=int, default=10000, help="cycles of the long run (default: %(default)s)")
    parser.add_argument("--beside", type=int, default=100, help="cycles of the short run (default: %(default)s)")
    parser.add_argument("--window", type=int, default=400, help="cycles to compare them for (default: %(default)s)")
    options = parse(parser, cycles=300, beside=30, window=60)
    program, goal = load(options.program)
    with Run(program, goal, options.failures) as long, Run(program, goal, options.failures) as short:
        grow(long, options.cycles, options.batch)
        grow(short, options.beside, options.batch)
        write(options.json, compare(long, short, options.window, options.batch))


if __name__ == "__main__":
    main()
