#!/usr/bin/env python3
"""Measures what a goal costs the core when a run has got long: processor time in both processes of the core.

The pure core with the program of a house or a row of offices, its solver in a process of its own as the node has it;
each action is answered at once, with success or, now and then, a failure. What is told of plan and goals is made into
the texts that the node publishes. In the end a long run and a short one go on in turns. To be run in the built
workspace: ./dev exec python3 bench/long_run.py
"""

import argparse
import random
import statistics
import time
from pathlib import Path

from figures import Figure, parse, write

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning import Core, CoreSettings, GoalChanged, GoalProgress, PlanMade

ENCODINGS = Path(__file__).resolve().parents[1] / "encodings"

OFFICES = ["office1", "office2", "office3", "office4"]
ROOMS = ["hallway", "kitchen", "living_room", "bathroom", "study", "bedroom"]
THINGS = ["cup", "tray", "book", "newspaper", "towel"]


def errand(source, number):
    """A goal for the row of offices."""
    start, end = source.sample(OFFICES, 2)
    return f"goal({start},{end},{number})"


def wish(source, number):
    """A goal for the house; a thing is asked for once at a time."""
    return f"bring({source.choice(ROOMS)},{THINGS[number % len(THINGS)]})"


PROGRAMS = {"mailbot": (["mailbot.lp", "office.lp"], errand), "house": (["house.lp", "home.lp"], wish)}


def load(name):
    """The program of a name, and what makes goals for it."""
    names, goal = PROGRAMS[name]
    return ReactiveProgram.from_files([ENCODINGS / one for one in names]), goal


def answer(action, source, failures):
    """The return of an action, some of which fail."""
    value = "failed" if source.random() < failures else action.parameter
    return f"_return({action.interface},{value},{action.cycle})"


class Teller:
    """Stands for the node: writes what it would publish."""

    def __init__(self):
        self.bytes = 0
        self.ended = 0

    def __call__(self, event):
        if isinstance(event, (PlanMade, GoalProgress)):
            self.bytes += sum(len(str(action.atom)) for action in event.actions)
        elif isinstance(event, GoalChanged) and event.outcome is not None:
            self.ended += 1


class Run:
    """A core that is given goals, each action of which is answered at once; an own process has its solver."""

    def __init__(self, program, goal, failures):
        self.process = WorkerPool(program, shortest=True)
        self.process.start()
        self.teller = Teller()
        self.core = Core(program, lambda: ProcessSolver(self.process), self.teller, CoreSettings())
        self.core.start()
        self._goal, self._failures = goal, failures
        self._source = random.Random(1)
        self._number = 0

    def goals(self, count):
        """Send goals and answer until all have ended; return seconds of processor time and bytes told for each."""
        spent, told = self._spent(), self.teller.bytes
        for _ in range(count):
            self._number += 1
            self.core.add_goal(str(self._number), self._goal(self._source, self._number))
        while self.core.live_goals:
            while self.core.advance(0.0):
                pass
            for action in self.core.awaited:
                self.core.receive("bench", [answer(action, self._source, self._failures)])
        return (self._spent() - spent) / count, (self.teller.bytes - told) / count

    def _spent(self):
        """Seconds of this process, of the solver's, and of those that were there before it: one that has grown goes."""
        return time.process_time() + self.process.cpu_time


def grow(run, cycles, batch, step=500):
    """Let a run come to a cycle, and print the cost of a goal on the way."""
    mark, sample = run.core.cycle + step, []
    while run.core.cycle < cycles:
        sample.append(run.goals(batch))
        if run.core.cycle >= mark:
            print(f"cycle {run.core.cycle:6d}: {describe(sample)}", flush=True)
            mark, sample = mark + step, []


def compare(long, short, cycles, batch):
    """Let two runs go on for some cycles, in turns, so that other programs slow both down alike; return the figures."""
    samples = {long: [], short: []}
    ends = {run: run.core.cycle + cycles for run in samples}
    while any(run.core.cycle < end for run, end in ends.items()):
        for run, sample in samples.items():
            sample.append(run.goals(batch))
    for run, sample in samples.items():
        print(f"up to cycle {run.core.cycle:6d}: {describe(sample)}")
    seconds = [statistics.mean(one for one, _ in sample) for sample in samples.values()]
    print(f"a goal of the long run costs {seconds[0] / seconds[1]:.2f} times one of the short run")
    names = zip(("long", "short"), seconds, samples.values())
    costs = [Figure(f"a goal of the {name} run", 1000 * one, "ms of processor") for name, one, _ in names]
    told = statistics.mean(size for _, size in samples[long])
    return [*costs, Figure("long over short", seconds[0] / seconds[1], ""), Figure("told of a goal", told / 1000, "kB")]


def describe(sample):
    """The means of a sample, in words."""
    seconds, size = map(statistics.mean, zip(*sample))
    return f"{1000 * seconds:6.1f} ms a goal, {size / 1000:5.1f} kB told"


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
    runs = [Run(program, goal, options.failures) for _ in range(2)]
    for run, cycles in zip(runs, (options.cycles, options.beside)):
        grow(run, cycles, options.batch)
    write(options.json, compare(*runs, options.window, options.batch))


if __name__ == "__main__":
    main()
