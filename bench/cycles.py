#!/usr/bin/env python3
"""Measures the core's cycles without ROS: from the last return of a cycle to the actions of the next.

The core executes requests on a row of offices; its solver runs in a worker process. Each action succeeds after some
seconds, in which the core improves its plan as in the node. Processor time is the cost of a cycle; wall time is how
long the robot waits. With --fail, some actions fail after the core has prefetched the answer to the failure. These
cycles have separate figures.

Run it in the built workspace: ./dev exec python3 bench/cycles.py --offices 20
"""

import random
import time

from acting_core import PooledCore, processor_clock
from deliveries import row
from figures import Figure, Option, main, quantiles

CLOCKS = {"wall": "ms", "core": "ms of processor", "solver": "ms of processor"}


def cycle(robot):
    """Advance to the next actions; return the milliseconds of each clock."""

    def clocks(pid):
        return time.perf_counter(), time.process_time(), time.clock_gettime(processor_clock(pid))

    active, standby = robot.process.pid, robot.process.standby_pid
    before = {pid: clocks(pid) for pid in (active, standby) if pid}
    robot.advance()
    begin = before.get(robot.process.pid, before[active])  # of the standby worker if it had the answer
    return [1000 * (after - one) for one, after in zip(begin, clocks(robot.process.pid))]


def act(robot, seconds, value, prefetches):
    """Execute the actions for some seconds, and return ``value``; prefetch the answer to a failure and wait for it."""
    end = time.perf_counter() + seconds
    if value is not None and prefetches:
        robot.core.prepare()
        while robot.process.is_prefetching:
            time.sleep(0.01)
            robot.core.prepare()
    while time.perf_counter() < end and robot.core.improve(lambda: time.perf_counter() >= end):
        pass
    time.sleep(max(0.0, end - time.perf_counter()))
    robot.answer(value=value)


def measure(options):
    """Execute all requests; yield the figures of the first cycle, of those after failures, and of all others."""
    source, places = random.Random(options.seed), range(1, options.offices + 1)
    with PooledCore(row(options.offices).program, options.plan_time) as robot:
        for number in range(1, options.requests + 1):
            start, end = source.sample(places, 2)
            robot.core.add_goal(str(number), f"goal(office{start},office{end},{number})")
        cycles, failed = [cycle(robot)], []
        while robot.core.awaited and len(cycles) <= options.cycles:
            fails = options.fail and not len(cycles) % options.fail
            act(robot, options.seconds, "failed" if fails else None, not options.unprepared)
            cycles.append(cycle(robot))
            failed += [cycles[-1]] if fails else []
        later = cycles[1:] if robot.core.awaited else cycles[1:-1]
    yield Figure("first plan", sum(cycles[0][1:]), "ms of processor")
    for place, (name, unit) in enumerate(CLOCKS.items()):
        yield from quantiles(f"a cycle, {name}", [one[place] for one in later], unit)
        if failed:
            yield from quantiles(f"after a failure, {name}", [one[place] for one in failed], unit)


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        offices=Option(20, "offices in a row"),
        requests=Option(10, "requests sent at once", 5),
        cycles=Option(200, "limit of cycles"),
        seconds=Option(0.2, "duration of an action", 0.1),
        plan_time=Option(1.0, "~plan_time of the core"),
        seed=Option(1, "seed of the requests"),
        fail=Option(0, "every N-th action fails; 0: none"),
        unprepared=Option(False, "do not prefetch answers to failures"),
    )
