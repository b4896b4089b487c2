#!/usr/bin/env python3
"""Measures planning for many requests: time to the first plan, plan lengths, and the steps executed in the end.

The core runs without ROS, with the mailbot's program and its solver in worker processes. As in the node, it improves
plans while actions run. A robot in plain Python executes the actions and refuses an action that breaks a rule. The
routing solver of OR-Tools gets the same requests and the same time, Fast Downward the same task in PDDL. Seconds are
processor time except in "first" and "still", so the figures do not depend on other load of the machine.

Columns of the table:
  floor     number of offices in a row, or loops: twenty offices with two loops
  how       once: all requests are known at the start; stream: one more every --gap actions, earlier if none is open
  first     the first plan, with --plan-time 0: wall time (first [s]), processor time (cpu [s]), steps, and the number
            of requests that are queued and not served by it (wait)
  all       a plan for all requests, without a limit for the search: seconds and steps; - after --all-seconds
  1 s ...   steps of such a plan after this time, before any action: for the core and (or) for OR-Tools
  driven    executed steps. During each action, --action-time seconds are spent to improve the plan, or the standby
            worker plans for queued requests. OR-Tools executes its plan of --or-seconds; in a stream it plans again for
            --or-stream-seconds with each request.
  ratio     executed steps, core to OR-Tools
  lama-first, lama   Fast Downward for requests known at once: seconds, translation included, and steps of its first
            plan; steps of the best plan of seq-sat-lama-2011 after --lama-seconds
  out       seconds until the first action is sent; its plan serves the requests that are not queued
  longest   longest time until the next action is sent, in seconds
  still     longest wall time between a return and the next action of a plan in force; needs a quiet machine
  ms        processor time for an action, without improvement and prefetching
  waited    largest number of queued requests while an action was running

With --search-timeout, which applies to the first plan and to the execution, the core queues requests.

Run it in the built workspace: ./dev exec python3 bench/many_goals.py
./dev bench many_goals installs the other planners.
"""

import argparse
import os
import time
from collections import deque
from contextlib import suppress
from statistics import mean

import fast_downward
import routing
from acting_core import ActingCore, TooLongError, mailbot_program
from deliveries import World, actions_of_route, floor_named, pddl_of, random_requests
from figures import Figure, parse, write

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.reasoning.settings import CoreSettings

HOWS = ("once", "stream")


class Robot(ActingCore):
    """A core with the mailbot's program, and the floor that executes its actions."""

    def __init__(self, floor, plan_time, search_timeout=0.0, all_seconds=0.0):
        super().__init__(mailbot_program(floor), plan_time, search_timeout, all_seconds)
        self.world = World(floor)

    def ask(self, requests):
        """Send goals; their packages wait on the floor."""
        self.world.ask(requests)
        for request in requests:
            self.core.add_goal(str(request.number), request.goal)

    def execute(self, actions):
        for action in sorted(actions, key=lambda action: action.cycle):
            self.world.do(action.interface_name, str(action.parameter))

    def steps(self):
        actions = self.core.plan.after(self.core.cycle - 1)
        world = self.world.copy()
        for action in sorted(actions, key=lambda action: action.cycle):
            world.do(action.interface_name, str(action.parameter))
        if world.open > self.unknown:
            raise SystemExit(f"the plan leaves {world.open} requests open")
        return len(actions)


class Arrivals:
    """Requests in the order of their arrival: all at once, or one every ``gap`` actions."""

    def __init__(self, requests, gap):
        self._left, self._gap, self._count = deque(requests), gap, 0

    def __bool__(self):
        return bool(self._left)

    def due(self, world):
        """Return the requests that arrive now; at least one if no request is open."""
        found = []
        while self._left and (self._gap * self._count <= world.actions or not (found or world.open)):
            found.append(self._left.popleft())
            self._count += 1
        return found


# ---- Measurements ----------------------------------------------------------------------------------------------------


def first_plan(floor, requests, options):
    """Return wall time and processor time (s) until the first plan, its steps, and the number of queued requests."""
    with Robot(floor, plan_time=0.0, search_timeout=options.search_timeout) as robot:
        begin, used = time.perf_counter(), robot.used
        robot.ask(requests)
        steps = robot.plan()
        seconds, cpu = time.perf_counter() - begin, robot.used - used
        return {"first [s]": seconds, "cpu [s]": cpu, "steps": steps, "wait": robot.unknown}


def plan_for_all(floor, requests, options):
    """Return the processor time (s) until a plan for all requests, and its steps; None if it takes too long."""
    with Robot(floor, plan_time=0.0, all_seconds=options.all_seconds) as robot:
        begin = robot.used
        robot.ask(requests)
        try:
            steps = robot.plan()
        except TooLongError:
            return {"all [s]": None, "all": None}
        return {"all [s]": robot.used - begin, "all": steps}


def plans_after(floor, requests, seconds, plan_time):
    """Return the steps of the best plan after each time in ``seconds``; None before the first plan."""
    with Robot(floor, plan_time, all_seconds=max(seconds)) as robot:
        begin, found = robot.used, []
        robot.ask(requests)
        with suppress(TooLongError):
            found.append((robot.plan(), robot.used - begin))
            for _ in robot.improve(max(seconds) - found[0][1]):
                found.append((robot.steps(), robot.used - begin))
    known = {limit: [steps for steps, used in found if used <= limit + plan_time / 2] for limit in seconds}
    return {f"{limit:g} s": min(steps, default=None) for limit, steps in known.items()}


def driven(floor, arrivals, options):
    """Execute all requests; return the number of steps and the costs."""
    with Robot(floor, options.plan_time, options.search_timeout) as robot:
        begin, own, out = robot.used, time.process_time(), 0.0
        while arrivals or robot.world.open:
            robot.ask(arrivals.due(robot.world))
            robot.plan_until_action()
            out = out or robot.used - begin
            for _ in robot.improve(options.action_time):
                robot.steps()
            robot.prepare(options.action_time)
            robot.act(options.action_time)
        used = robot.used - begin - robot.improving + time.process_time() - own
        actions = robot.world.actions
        costs = {"out [s]": out, "longest [s]": robot.longest, "still [s]": robot.still}
        return {"driven": actions, **costs, "ms": 1000 * used / actions, "waited": robot.waited}


def routes_after(floor, requests, options):
    """Return the steps of OR-Tools' plans after each time limit, and of the plan that it executes."""
    world = World(floor)
    world.ask(requests)
    limits = [*options.seconds, options.or_seconds]
    found = []
    for route in routing.routes(floor, world, limits):
        trial = world.copy()
        follow(trial, actions_of_route(floor, trial.office, route.visits))
        found.append(trial.actions)
    return {**{f"or {limit:g} s": steps for limit, steps in zip(limits, found[:-1])}, "or driven": found[-1]}


def routes_driven(floor, arrivals, options):
    """Return the number of executed steps if OR-Tools plans again with each request."""
    world, actions = World(floor), deque()
    while arrivals or world.open:
        fresh = arrivals.due(world)
        if fresh:
            world.ask(fresh)
            route = routing.routes(floor, world, [options.or_stream_seconds])[0]
            actions = deque(actions_of_route(floor, world.office, route.visits))
        world.do(*actions.popleft())
    return {"or driven": world.actions}


def plans_of_fast_downward(floor, requests, options):
    """Return seconds and steps of Fast Downward's first plan, and the steps of its best plan."""

    def check(actions):
        world = World(floor)
        world.ask(requests)
        follow(world, actions)

    found = fast_downward.measure(pddl_of(floor, requests), check, options.all_seconds, options.lama_seconds)
    return {name: found.get(name) for name in LAMA}


def follow(world, actions):
    """Execute all actions in ``world``; raises RuleError."""
    for action in actions:
        world.do(*action)
    if world.open:
        raise SystemExit(f"the plan leaves {world.open} requests open")


def measure(name, count, how, seed, options):
    """Return the row for one seed: column -> figure."""
    floor = floor_named(name)
    requests = random_requests(floor, count, seed)
    gap = options.gap if how == "stream" else 0
    found = {}
    if how == "once":
        found.update(first_plan(floor, requests, options))
        found.update(plan_for_all(floor, requests, options))
        found.update(plans_after(floor, requests, options.seconds, options.plan_time))
    found.update(driven(floor, Arrivals(requests, gap), options))
    if not options.without_or_tools:
        theirs = routes_after(floor, requests, options) if how == "once" else {}
        found.update(theirs or routes_driven(floor, Arrivals(requests, gap), options))
        found["ratio"] = found["driven"] / found["or driven"]
    if how == "once" and not options.without_fast_downward:
        found.update(plans_of_fast_downward(floor, requests, options))
    return found


# ---- The table -------------------------------------------------------------------------------------------------------

LAMA = ("lama-first [s]", "lama-first", "lama")

UNITS = {"first [s]": "s", "cpu [s]": "s of processor", "out [s]": "s of processor", "longest [s]": "s of processor"}
UNITS.update({"all [s]": "s of processor", "ms": "ms of processor", "ratio": ""})
UNITS.update({"still [s]": "s", "wait": "requests", "waited": "requests"})


def columns(options):
    """Return the columns of the table."""
    seconds = [f"{one:g} s" for one in options.seconds]
    theirs = [] if options.without_or_tools else [*(f"or {one}" for one in seconds), "or driven", "ratio"]
    theirs += [] if options.without_fast_downward else LAMA
    planned = ["first [s]", "cpu [s]", "steps", "wait", "all [s]", "all", *seconds]
    return [*planned, "driven", *theirs, "out [s]", "longest [s]", "still [s]", "ms", "waited"]


def line(head, cells, names):
    """Return a line of the table; a cell is text, a figure or None."""
    shown = []
    for name in names:
        value = cells.get(name)
        digits = 2 if "[s]" in name or name == "ratio" else 0 if name in ("ms", "wait", "waited") else 1
        text = value if isinstance(value, str) else "-" if value is None else f"{value:.{digits}f}"
        shown.append((text[:-2] if text.endswith(".0") else text).rjust(max(7, len(name))))
    return "  ".join([head[0].ljust(5), str(head[1]).rjust(8), head[2].ljust(6), *shown])


SHORT = {
    "lama_seconds": 1,
    "floors": ["4", "20", "loops"],
    "requests": [20],
    "how": ["once"],
    "seconds": [1, 5],
    "action_time": 0.05,
}
"""Values of options in the short form."""


def command_line():
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)

    def add(name, default, text, **more):
        parser.add_argument(name, default=default, help=f"{text} (default: %(default)s)", **more)

    add("--floors", ["4", "20", "50", "loops"], "floors", nargs="+")
    add("--requests", [3, 10, 20, 50, 100], "numbers of requests", type=int, nargs="+")
    add("--how", list(HOWS), "arrival of requests", nargs="+", choices=HOWS)
    add("--seeds", [1], "a row is the mean of these seeds", type=int, nargs="+")
    add("--seconds", [1, 5, 20], "times to compare plans at", type=float, nargs="+")
    add("--plan-time", CoreParameters.plan_time, "~plan_time of the core", type=float)
    add("--action-time", 0.5, "seconds to improve the plan during an action; real actions take longer", type=float)
    add("--search-timeout", CoreSettings.search_timeout, "~search_timeout of the core", type=float)
    add("--all-seconds", 60, "time limit of a plan for all requests", type=float)
    add("--gap", 4, "actions between two requests", type=int)
    add("--or-seconds", 5, "OR-Tools' time for a plan", type=float)
    add("--or-stream-seconds", 1, "OR-Tools' time for each plan in a stream", type=float)
    add("--lama-seconds", 10, "time limit of seq-sat-lama-2011", type=float)
    parser.add_argument("--without-or-tools", action="store_true", help="leave OR-Tools out")
    parser.add_argument("--without-fast-downward", action="store_true", help="leave Fast Downward out")
    return parser


def main():
    parser = command_line()
    options = parse(parser, **SHORT)
    try:
        for name in options.floors:
            floor_named(name)
    except ValueError as error:
        parser.error(str(error))
    if not (options.without_or_tools or routing.is_there()):
        parser.error(routing.HOW)
    if not (options.without_fast_downward or fast_downward.driver()):
        print(fast_downward.HOW)
        options.without_fast_downward = True
    write(options.json, play(options))


def averaged(runs):
    """Return the mean of some rows, without the columns in which a row has no figure."""
    return {name: mean(run[name] for run in runs) for name in runs[0] if all(run[name] is not None for run in runs)}


def play(options):
    """Print the table row by row; return its figures."""
    names, figures = columns(options), []
    print(line(("floor", "requests", "how"), {name: name for name in names}, names), flush=True)
    for floor in options.floors:
        for count in options.requests:
            for how in options.how:
                row = averaged([measure(floor, count, how, seed, options) for seed in options.seeds])
                print(line((floor, count, how), row, names), flush=True)
                ours = [name for name in names if name in row and not name.startswith(("or ", "lama"))]
                what = f"{floor}/{count} {how}: "
                figures += [Figure(what + name, row[name], UNITS.get(name, "steps")) for name in ours]
    print("load of the machine (1, 5, 15 min):", *(f"{load:.1f}" for load in os.getloadavg()))
    return figures


if __name__ == "__main__":
    main()
