#!/usr/bin/env python3
"""Times the core's cycles without ROS: from the last return of a cycle to the actions of the next.

The pure core and its solver in a process of its own carry out requests on a row of offices; each action is a success,
some time after it went out, in which the core does what the node lets it do. Processor time tells what a cycle costs,
wall time how long the robot waits. With --fail some actions fail, once the answer to that is prepared: those cycles
are told apart. To be run in the built workspace: ./dev exec python3 bench/cycles.py --offices 20
"""

import argparse
import random
import statistics
import time
from pathlib import Path

from figures import Figure, parse, write

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.workers.pool import WorkerPool
from rosoclingo.planning.workers.process_solver import ProcessSolver
from rosoclingo.reasoning import Core, CoreSettings

ENCODINGS = Path(__file__).resolve().parents[1] / "encodings"


def program_of(name, offices):
    """The paper's program, which has four offices, or the mailbot on a row of them."""
    if name == "paper":
        return ReactiveProgram.from_files([ENCODINGS / "paper.lp"])
    row = [f"office(office{n})." for n in range(1, offices + 1)]
    row += [f"corridor(office{n},office{n + 1})." for n in range(1, offices)]
    floor = Source("row", "#program base. start(office1). " + " ".join(row))
    return ReactiveProgram([Source.from_file(ENCODINGS / "mailbot.lp"), floor])


def processor_clock(pid):
    """The clock of a process's processor time, as clock_getcpuclockid(3) makes it on Linux."""
    return (~pid << 3) | 2


class Run:
    """A core with its solver's process."""

    def __init__(self, program, plan_time, prepares):
        self.process = WorkerPool(program, shortest=True, plan_time=plan_time, standby=True)
        self.process.start()
        self.core = Core(program, lambda: ProcessSolver(self.process), lambda event: None, CoreSettings())
        self.core.start()
        self.prepares = prepares

    def clocks(self):
        """Seconds of wall time, and of processor time of the core and of its solver."""
        return time.perf_counter(), time.process_time(), time.clock_gettime(processor_clock(self.process.pid))

    def prepare(self):
        """Have the answer prepared to what is awaited failing, and wait for that."""
        self.core.prepare()
        while self.process.is_prefetching:
            time.sleep(0.01)
            self.core.prepare()

    def act(self, seconds, value=None):
        """Let the actions take so long, and answer, by their parameters or a value; what is due then is next."""
        end = time.perf_counter() + seconds
        if value is not None and self.prepares:
            self.prepare()
        while time.perf_counter() < end and self.core.improve(lambda: time.perf_counter() >= end):
            pass
        time.sleep(max(0.0, end - time.perf_counter()))
        for action in self.core.awaited:
            self.core.receive("bench", [f"_return({action.interface},{value or action.parameter},{action.cycle})"])

    def cycle(self):
        """Go on to the next actions; return what that took."""
        pids = [self.process.pid, self.process.standby_pid]
        before, spare = self.clocks(), self.process.standby_pid and time.clock_gettime(processor_clock(pids[1]))
        while self.core.advance(0.0):
            pass
        if self.process.pid == pids[1]:  # it had the answer
            before = (*before[:2], spare)
        return tuple(1000 * (after - one) for one, after in zip(before, self.clocks()))


def play(options):
    """Carry out all requests; return the first plan's cycle, the others, and those after failures."""
    program = program_of(options.program, options.offices)
    run, source = Run(program, options.plan_time, not options.unprepared), random.Random(options.seed)
    places = range(1, 5 if options.program == "paper" else options.offices + 1)
    for number in range(1, options.requests + 1):
        start, end = source.sample(places, 2)
        run.core.add_goal(str(number), f"goal(office{start},office{end},{number})")
    cycles, failed = [run.cycle()], []
    while run.core.awaited and len(cycles) <= options.cycles:
        fails = options.fail and not len(cycles) % options.fail
        run.act(options.seconds, "failed" if fails else None)
        cycles.append(run.cycle())
        failed += [cycles[-1]] if fails else []
        if options.verbose:
            print(run.core.cycle, "wall {:.1f} core {:.1f} solver {:.1f} ms".format(*cycles[-1]), flush=True)
    run.process.close()
    return cycles[0], cycles[1:-1] if not run.core.awaited else cycles[1:], failed


def report(first, cycles, failed):
    """Print the figures and return them."""
    print("first plan: wall {:.0f} ms, core {:.0f} ms, solver {:.0f} ms".format(*first))
    found = [Figure("first plan", sum(first[1:]), "ms of processor")]
    for name, place in (("core", 1), ("solver", 2)) if failed else ():
        median = statistics.median(cycle[place] for cycle in failed)
        print(f"{len(failed)} of them after failures, {name}: median {median:.1f} ms")
        found.append(Figure(f"after a failure, {name}, median", median, "ms of processor"))
    for name, place, unit in (("wall", 0, "ms"), ("core", 1, "ms of processor"), ("solver", 2, "ms of processor")):
        values = sorted(cycle[place] for cycle in cycles)
        median, late = statistics.median(values), values[int(0.99 * (len(values) - 1))]
        print(f"{len(values)} cycles, {name}: median {median:.1f} ms, p99 {late:.1f} ms, worst {values[-1]:.1f} ms")
        found += [Figure(f"a cycle, {name}, median", median, unit), Figure(f"a cycle, {name}, 99 %", late, unit)]
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", choices=["mailbot", "paper"], default="mailbot")
    parser.add_argument("--offices", type=int, default=20, help="of the mailbot (default: %(default)s)")
    parser.add_argument("--requests", type=int, default=10, help="told at once (default: %(default)s)")
    parser.add_argument("--cycles", type=int, default=200, help="at most (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=0.2, help="that an action takes (default: %(default)s)")
    parser.add_argument("--plan-time", type=float, default=1.0, help="(default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--fail", type=int, default=0, help="one action in so many fails (default: none)")
    parser.add_argument("--unprepared", action="store_true", help="prepare no answers to failures")
    parser.add_argument("--verbose", action="store_true", help="tell each cycle")
    options = parse(parser, requests=5, seconds=0.1)
    write(options.json, report(*play(options)))


if __name__ == "__main__":
    main()
