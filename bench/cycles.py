#!/usr/bin/env python3
"""Measures the core's cycles without ROS: from the last return of a cycle to the actions of the next.

The core executes requests on a row of offices; its solver runs in a worker process. Each action succeeds after some
seconds, in which the core improves its plan as in the node. Processor time is the cost of a cycle; wall time is how
long the robot waits. With --fail, some actions fail after the core has prefetched the answer to the failure. These
cycles have separate figures.

Run it in the built workspace: ./dev exec python3 bench/cycles.py --offices 20
"""

import argparse
import random
import statistics
import time

from acting_core import ENCODINGS, PooledCore, mailbot_program, processor_clock, returned
from deliveries import row
from figures import Figure, parse, write

from rosoclingo.oclingo import ReactiveProgram


class Run(PooledCore):
    """A core whose actions take time and can fail."""

    def __init__(self, program, plan_time, prefetches):
        super().__init__(program, plan_time)
        self._prefetches = prefetches

    def clocks(self):
        """Return the wall time and the processor times of the core and of its solver, in seconds."""
        return time.perf_counter(), time.process_time(), time.clock_gettime(processor_clock(self.process.pid))

    def prefetch(self):
        """Prefetch the answer to a failure of the awaited action, and wait for it."""
        self.core.prepare()
        while self.process.is_prefetching:
            time.sleep(0.01)
            self.core.prepare()

    def act(self, seconds, value=None):
        """Execute the actions for some seconds; return their parameters, or ``value``."""
        end = time.perf_counter() + seconds
        if value is not None and self._prefetches:
            self.prefetch()
        while time.perf_counter() < end and self.core.improve(lambda: time.perf_counter() >= end):
            pass
        time.sleep(max(0.0, end - time.perf_counter()))
        for action in self.core.awaited:
            self.core.receive("bench", [returned(action, value)])

    def cycle(self):
        """Advance to the next actions; return the milliseconds of each clock."""
        pids = [self.process.pid, self.process.standby_pid]
        before, standby = self.clocks(), self.process.standby_pid and time.clock_gettime(processor_clock(pids[1]))
        self.advance()
        if self.process.pid == pids[1]:  # the standby worker had the answer
            before = (*before[:2], standby)
        return tuple(1000 * (after - one) for one, after in zip(before, self.clocks()))


def play(options):
    """Execute all requests; return the figures of the first cycle, of the others, and of those after failures."""
    paper = options.program == "paper"
    program = ReactiveProgram.from_files([ENCODINGS / "paper.lp"]) if paper else mailbot_program(row(options.offices))
    source, places = random.Random(options.seed), range(1, 5 if paper else options.offices + 1)
    with Run(program, options.plan_time, not options.unprepared) as run:
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
        return cycles[0], cycles[1:] if run.core.awaited else cycles[1:-1], failed


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
    parser.add_argument(
        "--program", choices=["mailbot", "paper"], default="mailbot", help="program of the core (default: %(default)s)"
    )
    parser.add_argument("--offices", type=int, default=20, help="offices of the mailbot (default: %(default)s)")
    parser.add_argument("--requests", type=int, default=10, help="requests sent at once (default: %(default)s)")
    parser.add_argument("--cycles", type=int, default=200, help="limit of cycles (default: %(default)s)")
    parser.add_argument("--seconds", type=float, default=0.2, help="duration of an action (default: %(default)s)")
    parser.add_argument("--plan-time", type=float, default=1.0, help="~plan_time of the core (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="seed of the requests (default: %(default)s)")
    parser.add_argument("--fail", type=int, metavar="N", default=0, help="every N-th action fails (default: none)")
    parser.add_argument("--unprepared", action="store_true", help="do not prefetch answers to failures")
    parser.add_argument("--verbose", action="store_true", help="print each cycle")
    options = parse(parser, requests=5, seconds=0.1)
    write(options.json, report(*play(options)))


if __name__ == "__main__":
    main()
