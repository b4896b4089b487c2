#!/usr/bin/env python3
"""Measures what cancels cost: how many solver processes a run takes, and the longest time without an answer.

The pure core with the delivery program on a row of offices, its solver in a process of its own, as the node has both.
Goals come while others are under way, a share of them is cancelled at a random time, each action is answered at once.
A cancel ends a search as it does in the node. To be run in the built workspace: ./dev exec python3 bench/cancels.py
"""

import argparse
import collections
import random
import time
from pathlib import Path

from figures import Figure, parse, write

from rosoclingo.nodes.core.core_node import CANCEL_GRACE
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.reasoning import Core, CoreSettings, GoalChanged, Halt, Problem

ENCODING = Path(__file__).resolve().parents[1] / "encodings" / "mailbot.lp"


def row(offices):
    """An instance: offices in a row."""
    facts = [f"office(office{i})." for i in range(1, offices + 1)]
    facts += [f"corridor(office{i},office{i + 1})." for i in range(1, offices)]
    return Source("row of offices", "#program base.\nstart(office1).\n" + "\n".join(facts) + "\n")


class Run:
    """A core with a number of goals under way, some of which are cancelled."""

    def __init__(self, options):
        program = ReactiveProgram([Source.from_file(ENCODING), row(options.offices)])
        self.options, self.source = options, random.Random(options.seed)
        self.process = WorkerPool(program, shortest=True, oclingo_strings=False, standby=True)
        self.process.start()
        self.cancels = {}  # key of a goal to when it is cancelled
        self.ends, self.lost, self.longest = collections.Counter(), 0, 0.0
        self.processes = {self.process.pid}
        self.core = Core(program, self.process.solver, self.note, CoreSettings(), self.watch)
        self.core.start()

    def note(self, event):
        """Count what has ended, and what the core lost with a solver process."""
        if isinstance(event, GoalChanged) and event.outcome is not None:
            self.cancels.pop(event.key, None)
            self.ends[event.outcome.name.lower()] += 1
        elif isinstance(event, Problem):
            self.lost += "the request was discarded" in event.message

    def watch(self):
        """As the node does it: a cancel ends a search that has gone on for a moment."""
        begin = time.monotonic()

        def look():
            now = time.monotonic()
            cancelled = any(due <= now for due in self.cancels.values())
            return Halt("a goal was cancelled", disturbed=True) if cancelled and now - begin >= CANCEL_GRACE else None

        return look

    def send(self, number):
        """One more goal, which may be cancelled within the next few answers."""
        start, end = self.source.sample(range(1, self.options.offices + 1), 2)
        if self.source.random() < self.options.cancels:
            self.cancels[str(number)] = time.monotonic() + self.source.uniform(0.0, self.options.within)
        self.core.add_goal(str(number), f"goal(office{start},office{end},{number})")

    def go_on(self):
        """One turn of the node's worker."""
        for key in [key for key, due in self.cancels.items() if due <= time.monotonic()]:
            del self.cancels[key]
            self.core.cancel_goal(key)
        begin = time.monotonic()
        if not self.core.advance(0.0):
            for action in self.core.awaited:
                self.core.receive("bench", [f"_return({action.interface},{action.parameter},{action.cycle})"])
        self.longest = max(self.longest, time.monotonic() - begin)
        self.processes.add(self.process.pid)

    def play(self):
        """Return the seconds that it took until all goals had ended."""
        begin, number = time.monotonic(), 0
        while number < self.options.goals or self.core.live_goals:
            while number < self.options.goals and len(self.core.live_goals) < self.options.at_once:
                number += 1
                self.send(number)
            self.go_on()
        return time.monotonic() - begin


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--offices", type=int, default=20, help="(default: %(default)s)")
    parser.add_argument("--goals", type=int, default=300, help="goals in all (default: %(default)s)")
    parser.add_argument("--at-once", type=int, default=3, help="goals under way (default: %(default)s)")
    parser.add_argument("--cancels", type=float, default=0.3, help="share that is cancelled (default: %(default)s)")
    parser.add_argument("--within", type=float, default=1.0, help="seconds until a cancel comes (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="(default: %(default)s)")
    options = parse(parser, offices=10, goals=30)
    run = Run(options)
    seconds = run.play()
    ends = ", ".join(f"{count} {status}" for status, count in sorted(run.ends.items()))
    print(f"{sum(run.ends.values())} goals in {seconds:.0f} s, {run.core.cycle} cycles: {ends}")
    replaced = len(run.processes) - 1
    print(f"solver processes replaced: {run.lost} that were lost, {replaced - run.lost} that had grown")
    print(f"the longest turn, with all that was ground, solved and rebuilt in it: {run.longest:.2f} s")
    found = [Figure("a goal", 1000 * seconds / options.goals, "ms"), Figure("longest turn", 1000 * run.longest, "ms")]
    write(options.json, [*found, Figure("processes lost", run.lost, "")])


if __name__ == "__main__":
    main()
