#!/usr/bin/env python3
"""Measures the journal of a long run: its size, and the time to resume from it.

The core runs without ROS, with the program of the office and its solver in the same process. Each action returns at
once, one in twenty with a failure. At intervals, a second core resumes from the file, as if the first one had been
killed, and plans for one more goal. The time that a fresh core needs for this goal is measured for comparison.

Run it in the built workspace: ./dev exec python3 bench/journal.py
"""

import random
import tempfile
import time
from pathlib import Path

from acting_core import ENCODINGS
from figures import Figure, Option, main

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.journal.database import Header, file_of, read
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.journal.keeper import ClientGoal, Keeper
from rosoclingo.reasoning.settings import CoreSettings

FAILURES = 0.05
BATCH = 2  # goals sent at once
PROGRAM = [ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp"]


def office_goal(source, number):
    """Return a random goal for the row of four offices."""
    start, end = source.sample(range(1, 5), 2)
    return f"goal(office{start},office{end},{number})"


class Run:
    """A core that executes goals; it can write a journal and resume from a ``record``."""

    def __init__(self, program, journal=None, record=None):
        self.keeper = Keeper(lambda event: None, journal, time.monotonic, time.time)
        self.core = Core(
            program, lambda: PlanSolver(program, plan_time=1.0), self.keeper, CoreSettings(), record=record
        )
        self.keeper.attach(self.core, record)
        self.core.start()
        self.keeper.send()

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

    def finish(self, source):
        """Return all actions, some with failures, until all goals have ended."""
        while self.core.live_goals:
            for action in self.core.awaited:
                value = "failed" if source.random() < FAILURES else action.parameter
                self.core.receive("bench", [f"_return({action.interface},{value},{action.cycle})"])
            self.advance()


def first_answer(program, path, text):
    """Return the processor time (s) until the first actions of one more goal; ``path`` is a journal or None."""
    start = time.process_time()
    Run(program, record=None if path is None else read(path).state).goal("extra", text)
    return time.process_time() - start


def play(program, goals, every, path):
    """Play all goals in the journal folder ``path``; yield the figures at intervals."""
    journal, source, largest = Journal(path, Header("bench", program.fingerprint)), random.Random(1), 0.0
    run, file = Run(program, journal), file_of(path)
    for number in range(1, goals + 1):
        run.goal(str(number), office_goal(source, number))
        if number % BATCH == 0 or number == goals:
            run.finish(source)
        size = sum(one.stat().st_size for one in path.glob(f"{file.name}*") if not one.name.endswith("-shm"))
        largest = max(largest, size / 1000)
        if number % every == 0 or number == goals:
            if journal.fault:
                raise SystemExit(journal.fault)
            text, when = office_goal(random.Random(number), 10 * goals), f"after {number} goals"
            yield Figure(f"{when}, largest files", largest, "kB")
            for name, record in (("resumed", file), ("fresh core", None)):
                seconds = first_answer(program, record, text)
                yield Figure(f"{when}, {name}, to the first answer", seconds, "s of processor")


def measure(options):
    """Play all goals with a journal in a temporary folder."""
    with tempfile.TemporaryDirectory() as name:
        yield from play(ReactiveProgram.from_files(PROGRAM), options.goals, options.every, Path(name))


if __name__ == "__main__":
    every = Option(500, "goals between two measurements", 100)
    main(__doc__, measure, goals=Option(10000, "number of goals", 100), every=every)
