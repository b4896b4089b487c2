#!/usr/bin/env python3
"""Measures the journal of a long run: its size, the time to resume from it and the time to write it.

The core runs without ROS, with the program of a row of offices or of a house and its solver in the same process. Each
action returns at once, with success or sometimes a failure. At intervals, a second core resumes from the file, as if
the first one had been killed, and plans for one more goal. The time that a fresh core needs for this goal is printed
for comparison.

Run it in the built workspace: ./dev exec python3 bench/journal.py
"""

import argparse
import random
import tempfile
import time
from pathlib import Path

from figures import Figure, parse, write
from long_run import add_run, answer, load

from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.journal.database import Header, file_of, read
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.journal.keeper import ClientGoal, Keeper
from rosoclingo.reasoning.journal.resumable_core import ResumableCore
from rosoclingo.reasoning.settings import CoreSettings


class Run:
    """A core that executes goals; it can write a journal and resume from a ``record``."""

    def __init__(self, program, journal=None, record=None):
        self._writing = journal and Timed(journal)
        self.keeper = Keeper(lambda event: None, self._writing, time.monotonic)

        def solver():
            return PlanSolver(program, plan_time=1.0)

        self.core = ResumableCore(program, solver, self.keeper, CoreSettings(), record=record)
        self.keeper.attach(self.core, record)
        self.core.start()
        self.keeper.send()

    @property
    def written(self):
        """Seconds of processor time and of wall time spent on the journal, and the number of writes."""
        return self._writing.spent, self._writing.passed, self._writing.count

    def goal(self, key, text):
        """Add the goal of a client and plan until its first actions are sent."""
        self.keeper.add(key, ClientGoal(text, (0, 0)))
        self.keeper.keep()
        self.core.add_goal(key, text)
        self.advance()

    def advance(self):
        """Advance the core until it awaits returns."""
        while self.core.advance(0.0):
            self.keeper.send()
        self.keeper.send()

    def finish(self, answer):
        """Return all actions by ``answer`` until all goals have ended."""
        while self.core.live_goals:
            for action in self.core.awaited:
                self.core.receive("bench", [answer(action)])
            self.advance()


class Timed:
    """A journal that measures the time of its writes."""

    def __init__(self, journal):
        self._journal, self.spent, self.passed, self.count, self.fault = journal, 0.0, 0.0, 0, ""
        self.is_due = journal.is_due

    def write(self, *state_and_times):
        """Write the state."""
        self.count += 1
        start, begun = time.process_time(), time.perf_counter()
        self._journal.write(*state_and_times)
        self.spent += time.process_time() - start
        self.passed += time.perf_counter() - begun
        if self._journal.fault:
            raise SystemExit(self._journal.fault)


def first_answer(program, path, number, text):
    """Return the processor time (s) until the first actions of one more goal; ``path`` is a journal or None."""
    start = time.process_time()
    record = None if path is None else read(path).state
    Run(program, record=record).goal(f"extra {number}", text)
    return time.process_time() - start


def play(program, goal, options, path):
    """Play all goals and print the state of the journal at intervals; return the figures at the end."""
    run = Run(program, Journal(path, Header("bench", program.fingerprint)))
    file, source, largest = file_of(path), random.Random(1), 0
    mark, times = 0, (0.0, 0.0)

    for number in range(1, options.goals + 1):
        run.goal(str(number), goal(source, number))
        if number % options.batch == 0 or number == options.goals:
            run.finish(lambda action: answer(action, source, options.failures))
        size = sum(one.stat().st_size for one in path.glob(f"{file.name}*") if not one.name.endswith("-shm"))
        largest = max(largest, size)
        if number >= mark + options.every or number == options.goals:
            mark, text = number, goal(random.Random(number), 10 * options.goals)
            times = first_answer(program, file, number, text), first_answer(program, None, number, text)
            spent, passed, count = run.written
            print(
                f"goal {number:6d}, cycle {run.core.cycle:6d}: {size / 1000:6.1f} kB, "
                f"largest {largest / 1000:6.1f} kB, to the first answer {times[0]:.3f} s, "
                f"fresh {times[1]:.3f} s, {count} writes of {1000 * spent / count:.2f} ms of processor "
                f"and {1000 * passed / count:.2f} ms",
                flush=True,
            )
    spent, passed, count = run.written
    return [
        Figure("largest files", largest / 1000, "kB"),
        Figure("resumed, to the first answer", times[0], "s of processor"),
        Figure("fresh core, to the first answer", times[1], "s of processor"),
        Figure("writing", 1000 * spent / count, "ms of processor"),
        Figure("writing, until durable", 1000 * passed / count, "ms"),
    ]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_run(parser, failures=0.05)
    parser.add_argument("--goals", type=int, default=10000, help="number of goals (default: %(default)s)")
    parser.add_argument("--every", type=int, default=500, help="goals between two measurements (default: %(default)s)")
    options = parse(parser, goals=100, every=50)
    program, goal = load(options.program)
    with tempfile.TemporaryDirectory() as name:
        write(options.json, play(program, goal, options, Path(name)))


if __name__ == "__main__":
    main()
