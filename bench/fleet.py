#!/usr/bin/env python3
"""Measures fleets: several robots, whose drives take different times, serve many requests.

The core runs without ROS, with encodings/fleet.lp and its solver in worker processes. A world in plain Python executes
the actions. It draws the duration of each around its mean, the same for the same seed, and refuses actions that break a
rule: robots hold both ends of the connection that they drive on. Each place has room for --room robots.

The routing solver of OR-Tools gets the same requests, the mean durations, and --or-seconds of processor time. It
minimizes the makespan and ignores collisions.

Columns of the table:
  floor, robots, requests   number of offices in a row, or loops
  how       once: all requests are known at the start; stream: one more every --gap seconds
  first     wall time in seconds until the first action
  makespan  simulated seconds until the last delivery, and the same without _running, in the paper's cycle (paper)
  drive     seconds of driving, of all robots
  or        the makespan of OR-Tools' plan, for requests that are known at the start
  ratio     makespan, core to OR-Tools
  idle      longest time in seconds that a robot stood still without a task while a package waited for a robot

Run it in the built workspace: ./dev exec python3 bench/fleet.py
./dev bench fleet installs OR-Tools.
"""

import argparse
import heapq
import json
import subprocess
import sys
import time
from pathlib import Path

import routing
from acting_core import ENCODINGS, PooledCore, returned
from deliveries import floor_named, random_requests
from figures import Figure, parse, write
from fleet_world import DRIVE, HANDLE, FleetWorld

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.reasoning.events import ActionsDispatched, GoalChanged
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.settings import CoreSettings

RUNNING = "#external _running/3.\n"
"""The declaration in encodings/fleet/rules.lp that gives a program the finer cycle."""


def starts(floor, robots):
    """Return the initial offices of the robots r1, r2 ..., spread over the floor."""
    return {f"r{number + 1}": 1 + (2 * number + 1) * floor.offices // (2 * robots) for number in range(robots)}


def fleet_program(floor, robots, room=1, paper=False):
    """Return the program of a fleet on a floor; in the ``paper``'s cycle, an action ends with all others."""
    offices = range(1, floor.offices + 1)
    facts = [f"office(office{one}). room(office{one},{room})." for one in offices]
    facts += [f"corridor(office{a},office{b})." for a, b in sorted(floor.corridors)]
    facts += [f"start({robot},office{office})." for robot, office in starts(floor, robots).items()]
    program = ReactiveProgram(
        [Source.from_file(ENCODINGS / "fleet.lp"), Source("floor", "\n".join(["#program base.", *facts, ""]))]
    )
    if not paper:
        return program
    texts = [Source(one.name, one.text.replace(RUNNING, "#defined _running/3.\n")) for one in program.texts]
    return ReactiveProgram(texts, whole=True)


class FleetCore(PooledCore):
    """A core whose actions a world executes, each for its own time; all of them succeed.

    Attributes:
        now: the simulated time in seconds.
        idle: the longest time that a robot rested while a package waited.

    """

    def __init__(self, program, world, plan_time, search_timeout):
        super().__init__(program, plan_time, CoreSettings(search_timeout=search_timeout))
        self.world, self.now, self.idle = world, 0.0, 0.0
        self._ends, self._rests, self.first = [], {}, None

    def ask(self, requests):
        """Send goals; their packages wait on the floor."""
        self.world.ask(requests)
        for one in requests:
            self.core.add_goal(str(one.number), one.goal)

    def note(self, event):
        """Begin the actions that the core sends."""
        if isinstance(event, ActionsDispatched):
            self.first = self.first or time.perf_counter()
            for action in event.actions:
                verb, robot = action.interface.name, str(action.interface.arguments[0])
                duration = self.world.begin(robot, verb, int(str(action.parameter).replace("office", "")))
                heapq.heappush(self._ends, (self.now + duration, len(self._ends), robot, action))
        if isinstance(event, GoalChanged) and event.outcome not in (None, Outcome.SUCCEEDED):
            raise SystemExit(f"goal {event.key} is feasible, but ended as {event.outcome.name}: {event.message}")

    def play(self, arrivals, seconds):
        """Serve the requests, each at its time; spend ``seconds`` of processor time to improve plans between events."""
        while arrivals or self.world.open:
            self._rest()
            if arrivals and (not self._ends or arrivals[0][0] <= self._ends[0][0]):
                self.now = max(self.now, arrivals[0][0])
                self.ask(arrivals.pop(0)[1])
            elif self._ends:
                self.now, _, robot, action = heapq.heappop(self._ends)
                self.world.end(robot)
                self.core.receive("bench", [returned(action)])
            else:
                self.now += 1.0
            self.core.poll(self.now)
            self.advance(self.now)
            self._improve(seconds)

    def _improve(self, seconds):
        begin = self.process.cpu_time
        while self.core.improve(lambda: self.process.cpu_time - begin >= seconds):
            if self.process.cpu_time - begin >= seconds:
                break

    def _rest(self):
        """Measure how long robots rest while a package waits at a place of its own."""
        world = self.world
        resting = [one for one in world.at if world.waiting and one not in world.acts and not world.load[one]]
        self._rests = {robot: self._rests.get(robot, self.now) for robot in resting}
        self.idle = max([self.idle, *(self.now - since for since in self._rests.values())])


# ---- OR-Tools --------------------------------------------------------------------------------------------------------


def routed(floor, robots, requests, seconds):
    """Return the makespan in seconds of OR-Tools' plan for several vehicles; raises RoutingError."""
    distances = floor.distances()
    places = [*starts(floor, robots).values(), *(one.start for one in requests), *(one.end for one in requests)]
    handled = [0] * robots + [HANDLE] * 2 * len(requests)
    times = [[DRIVE * distances[a, b] + time_ for b in places] for a, time_ in zip(places, handled)]
    problem = {"times": times, "robots": robots, "requests": len(requests), "seconds": seconds}
    command = [routing.bench_python(), str(Path(__file__).resolve().with_name("fleet_routing.py"))]
    done = subprocess.run(command, input=json.dumps(problem), capture_output=True, text=True, check=False)
    if done.returncode:
        raise routing.RoutingError(f"OR-Tools has found no plan: {done.stderr.strip()}")
    return float(done.stdout)


# ---- Measurements ----------------------------------------------------------------------------------------------------


def driven(floor, robots, requests, gap, options, paper=False):
    """Serve the requests; return the figures of the run."""
    world = FleetWorld(floor, starts(floor, robots), options.room, options.seed)
    batches = [(gap * number, [one]) for number, one in enumerate(requests)] if gap else [(0.0, requests)]
    with FleetCore(
        fleet_program(floor, robots, options.room, paper), world, options.plan_time, options.search_timeout
    ) as core:
        begin = time.perf_counter()
        core.play(batches, options.improve_time)
        return {"first [s]": core.first - begin, "makespan": core.now, "drive": world.driven, "idle": core.idle}


def measure(name, robots, count, how, options):
    """Return a row: column -> figure."""
    floor = floor_named(name)
    requests = random_requests(floor, count, options.seed)
    gap = options.gap if how == "stream" else 0.0
    found = driven(floor, robots, requests, gap, options)
    found["paper"] = driven(floor, robots, requests, gap, options, paper=True)["makespan"]
    if how == "once" and not options.without_or_tools:
        found["or"] = routed(floor, robots, requests, options.or_seconds)
        found["ratio"] = found["makespan"] / found["or"]
    return found


COLUMNS = ("first [s]", "makespan", "paper", "drive", "or", "ratio", "idle")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)

    def add(name, default, text, **more):
        parser.add_argument(name, default=default, help=f"{text} (default: %(default)s)", **more)

    add("--floors", ["20", "loops"], "floors", nargs="+")
    add("--robots", [1, 2, 4, 8], "numbers of robots", type=int, nargs="+")
    add("--requests", [20, 50], "numbers of requests", type=int, nargs="+")
    add("--how", ["once", "stream"], "arrival of requests", nargs="+", choices=("once", "stream"))
    add("--seed", 1, "seed of requests and durations", type=int)
    add("--room", 2, "number of robots for which a place has room", type=int)
    add("--gap", 15.0, "seconds between two requests of a stream", type=float)
    add("--plan-time", CoreParameters.plan_time, "~plan_time of the core", type=float)
    add("--search-timeout", CoreSettings.search_timeout, "~search_timeout of the core", type=float)
    add("--improve-time", 0.2, "seconds of processor time to improve the plan between two events", type=float)
    add("--or-seconds", 5.0, "OR-Tools' time for a plan", type=float)
    parser.add_argument("--without-or-tools", action="store_true", help="leave OR-Tools out")
    options = parse(parser, floors=["loops"], robots=[2, 4], requests=[20], how=["once"])
    options.without_or_tools |= not routing.is_there()
    write(options.json, play(options))


def play(options):
    """Print the table row by row; return its figures."""
    print("floor  robots  requests  how     ", *(name.rjust(9) for name in COLUMNS), flush=True)
    figures = []
    for name in options.floors:
        for robots in options.robots:
            for count in options.requests:
                for how in options.how:
                    row = measure(name, robots, count, how, options)
                    cells = (f"{row[one]:9.2f}" if one in row else "-".rjust(9) for one in COLUMNS)
                    print(f"{name:5s}  {robots:6d}  {count:8d}  {how:7s} ", *cells, flush=True)
                    head = f"{name}/{robots}/{count} {how}: "
                    figures += [
                        Figure(head + one, row[one], "" if one == "ratio" else "s")
                        for one in COLUMNS
                        if one in row and one != "or"
                    ]
    return figures


if __name__ == "__main__":
    sys.exit(main())
