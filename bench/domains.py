#!/usr/bin/env python3
"""Compares the planner with other planners on domains without advice: time to the first plan, and plan length.

All goals of a task (bench/planning_domains) are known at the start. Rules in plain Python check the plans of all
planners. Seconds are processor time.

Columns of the table:
  first       the first plan with --plan-time 0: seconds and steps
  out         the plan that the core executes with --plan-time: seconds and steps
  5 s         steps of that plan after further --seconds of improvement
  executed    executed steps if the plan is improved for --action-time seconds during each action
  incmode     plain clingo with the same program, which adds one step at a time: seconds and steps of a shortest plan
  lama-first  Fast Downward on the same task in PDDL, translation included: seconds and steps of the first plan
  lama        steps of the best plan of seq-sat-lama-2011 after --lama-seconds
  best        the fewest steps in this row
  time        ratio of seconds, first to lama-first
  steps       ratio of steps, executed to best

A cell is - if there is no plan within --limit seconds, if Fast Downward is not installed, or if PDDL lacks the task.

Run it in the built workspace: ./dev exec python3 bench/domains.py
./dev bench domains installs Fast Downward.
"""

import argparse
import os
import time
from contextlib import suppress
from statistics import mean

import fast_downward
import incmode
from acting_core import ActingCore, TooLongError
from figures import Figure, parse, write
from planning_domains import DOMAINS, check
from planning_domains.task import require

from rosoclingo.nodes.core.loading import CoreParameters
from rosoclingo.reasoning.settings import CoreSettings

SIZES = ("small", "middle", "large")

COLUMNS = ("first [s]", "first", "out [s]", "out", "improved", "executed", "incmode [s]", "incmode")
COLUMNS += ("lama-first [s]", "lama-first", "lama", "best", "time", "steps")

OURS = COLUMNS[:6]


class Robot(ActingCore):
    """A core with the program of a task, and the world that executes its actions."""

    def __init__(self, task, plan_time, search_timeout=0.0, all_seconds=0.0):
        super().__init__(task.program, plan_time, search_timeout, all_seconds)
        self.task, self.world, self.executed, self._known = task, task.new_world(), 0, set()
        for number, goal in enumerate(task.goals, 1):
            self.core.add_goal(str(number), goal)

    def execute(self, actions):
        self.world.do([(one.interface_name, str(one.parameter)) for one in actions])
        self.executed += 1

    def steps(self):
        self._update_world()
        plan = {}
        for action in sorted(self.core.plan.after(self.core.cycle - 1), key=lambda action: action.cycle):
            plan.setdefault(action.cycle, []).append((action.interface_name, str(action.parameter)))
        if self.core.awaited:
            check(self.world, list(plan.values()))
        return len(plan)

    def _update_world(self):
        """Give the world the goals that the program knows: a plan does not serve queued goals."""
        fed = {int(goal.key): goal.fed for goal in self.core.live_goals}
        for number, goal in enumerate(self.task.goals, 1):
            if fed.get(number) and number not in self._known:
                self.world.ask(number, goal)
                self._known.add(number)
            elif not fed.get(number, True) and number in self._known:
                self.world.cancel(number)
                self._known.discard(number)


# ---- Measurements ----------------------------------------------------------------------------------------------------


def first_plan(task, options):
    """Return the seconds until the first plan, and its steps."""
    with suppress(TooLongError), Robot(task, plan_time=0.0, all_seconds=options.limit) as robot:
        begin = robot.used
        steps = robot.plan()
        return {"first [s]": robot.used - begin, "first": steps}
    return {}


def improved_plan(task, options):
    """Return the seconds until the core executes a plan, its steps, and the steps after further improvement."""
    with suppress(TooLongError), Robot(task, options.plan_time, all_seconds=options.limit) as robot:
        begin = robot.used
        steps = robot.plan()
        found = {"out [s]": robot.used - begin, "out": steps}
        for _ in robot.improve(options.seconds):
            steps = robot.steps()
        return {**found, "improved": steps}
    return {}


def executed(task, options):
    """Return the number of steps executed until all goals are met."""
    limits = options.search_timeout, options.limit
    with suppress(TooLongError), Robot(task, options.plan_time, *limits) as robot:
        while robot.plan_until_action():
            for _ in robot.improve(options.action_time):
                robot.steps()
            robot.prepare(options.action_time)
            robot.act(options.action_time)
        require(robot.world.at_rest, "the executed actions have not met all goals")
        return {"executed": robot.executed}
    return {}


def incremental_mode(task, options):
    """Return seconds and steps of plain clingo."""
    begin = time.process_time()
    plan = incmode.shortest_plan([source.text for source in task.sources], task.goals, options.limit)
    if plan is None:
        return {}
    check(task.world(), plan)
    return {"incmode [s]": time.process_time() - begin, "incmode": len(plan)}


def fast_downward_plans(task, options):
    """Return seconds and steps of Fast Downward's first plan, and the steps of its best plan."""
    if task.pddl is None or fast_downward.driver() is None:
        return {}
    return fast_downward.measure(
        task.pddl,
        lambda actions: check(task.world(), [[one] for one in actions]),
        options.limit,
        options.lama_seconds,
    )


def measure(domain, size, seed, options):
    """Return the row for one seed: column -> figure, None for no figure."""
    task = DOMAINS[domain].make(*DOMAINS[domain].sizes[size], seed=seed)
    found = dict.fromkeys(COLUMNS)
    for part in (first_plan, improved_plan, executed, incremental_mode, fast_downward_plans):
        if part.__name__ not in options.without:
            found.update({name: value for name, value in part(task, options).items() if name in found})
    steps = [found[name] for name in ("first", "out", "improved", "executed", "incmode", "lama-first", "lama")]
    found["best"] = min((one for one in steps if one is not None), default=None)
    found["time"] = _ratio(found["first [s]"], found["lama-first [s]"])
    found["steps"] = _ratio(found["executed"], found["best"])
    return found


def _ratio(ours, other):
    return None if ours is None or other is None else ours / other


# ---- The table -------------------------------------------------------------------------------------------------------


def averaged(runs):
    """Return the mean of some rows; None in a column if a row has no figure."""
    return {name: None if None in (values := [run[name] for run in runs]) else mean(values) for name in COLUMNS}


def line(domain, size, cells):
    """Return a line of the table; a cell is text, a figure or None."""
    shown = []
    for name in COLUMNS:
        value = cells[name]
        digits = 2 if "[s]" in name or name in ("time", "steps") else 1
        text = value if isinstance(value, str) else "-" if value is None else f"{value:.{digits}f}"
        shown.append((text[:-2] if text.endswith(".0") else text).rjust(max(5, len(name))))
    return "  ".join([domain.ljust(12), size.ljust(6), *shown])


def play(options):
    """Print the table row by row; return its figures."""
    figures, head = [], {name: name for name in COLUMNS}
    head["improved"] = f"{options.seconds:g} s".rjust(len("improved"))
    print(line("domain", "size", head), flush=True)
    for domain in options.domains:
        for size in options.sizes:
            row = averaged([measure(domain, size, seed, options) for seed in options.seeds])
            print(line(domain, size, row), flush=True)
            known = [name for name in OURS if row[name] is not None]
            units = {name: "s of processor" if "[s]" in name else "steps" for name in known}
            figures += [Figure(f"{domain}, {size}: {name}", row[name], units[name]) for name in known]
    print("load of the machine (1, 5, 15 min):", *(f"{load:.1f}" for load in os.getloadavg()))
    return figures


PARTS = tuple(one.__name__ for one in (first_plan, improved_plan, executed, incremental_mode, fast_downward_plans))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument(
        "--domains", nargs="+", choices=list(DOMAINS), default=list(DOMAINS), help="domains to measure (default: all)"
    )
    parser.add_argument("--sizes", nargs="+", choices=SIZES, default=list(SIZES), help="sizes of tasks (default: all)")
    parser.add_argument(
        "--seeds", type=int, nargs="+", default=[1], help="a row is the mean of these seeds (default: %(default)s)"
    )
    parser.add_argument("--without", nargs="+", choices=PARTS, default=[], help="parts of a row to leave out")
    parser.add_argument(
        "--plan-time",
        type=float,
        default=CoreParameters.plan_time,
        help="~plan_time of the core (default: %(default)s)",
    )
    parser.add_argument(
        "--seconds", type=float, default=5.0, help="seconds to improve the first plan (default: %(default)s)"
    )
    parser.add_argument(
        "--action-time",
        type=float,
        default=0.5,
        help="seconds to improve the plan during an action (default: %(default)s)",
    )
    parser.add_argument(
        "--search-timeout",
        type=float,
        default=CoreSettings.search_timeout,
        help="~search_timeout of the core (default: %(default)s)",
    )
    parser.add_argument("--limit", type=float, default=60.0, help="time limit of a search (default: %(default)s)")
    parser.add_argument(
        "--lama-seconds", type=float, default=10.0, help="time limit of seq-sat-lama-2011 (default: %(default)s)"
    )
    short = {"domains": ["blocks", "elevator", "keys", "crates"], "sizes": ["small"], "action_time": 0.05}
    options = parse(parser, **short, seconds=0.5, limit=10.0, lama_seconds=1.0)
    if "fast_downward_plans" not in options.without and fast_downward.driver() is None:
        print(fast_downward.HOW)
    write(options.json, play(options))


if __name__ == "__main__":
    main()
