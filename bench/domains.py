#!/usr/bin/env python3
"""Compares the planner with other planners on domains without advice: time to the first plan, and plan length.

All goals of a task (bench/planning_domains) are known at the start. A world with rules of its own checks the plans.
Seconds are processor time.

Figures of a row:
  first       a plan for all goals without time to shorten it: seconds and steps
  out         the plan that the core executes with the default of ~plan_time: seconds and steps
  improved    steps of that plan after further --seconds of improvement
  executed    executed steps if the plan is improved for --action-time seconds during each action
  incmode     plain clingo with the same program, which adds one step at a time: seconds and steps of a shortest plan
  lama-first  Fast Downward on the same task in PDDL, translation included: seconds and steps of the first plan
  lama        steps of the best plan of seq-sat-lama-2011 after --lama-seconds
  best        the fewest steps in this row

A figure is left out if there is no plan within --limit seconds, if Fast Downward is not installed, or if PDDL lacks the
task.

Run it in the built workspace: ./dev exec python3 bench/domains.py
./dev bench domains installs Fast Downward.
"""

import time
from itertools import product

import incmode
import peers
from acting_core import OPTIONS, execute, first_plan
from figures import Option, main, row_figures
from planning_domains import DOMAINS, check

from rosoclingo.nodes.core.loading import CoreParameters

SIZES = ["small", "middle", "large"]
COLUMNS = ("first [s]", "first", "out [s]", "out", "improved", "executed", "incmode [s]", "incmode")
COLUMNS += ("lama-first [s]", "lama-first", "lama", "best")
UNITS = {one: "s of processor" if "[s]" in one else "steps" for one in COLUMNS}


def first_plans(task, limit, seconds):
    """Return the figures of the first plan, and of the one with the default of ~plan_time and its improvement."""
    first = first_plan(task, limit=limit)
    sent = first_plan(task, CoreParameters.plan_time, limit=limit, improvement=seconds)
    cells = {"first [s]": first.seconds, "first": first.steps} if first else {}
    cells.update({"out [s]": sent.seconds, "out": sent.steps, "improved": sent.improved} if sent else {})
    return cells


def incremental_mode(task, limit):
    """Return seconds and steps of plain clingo; nothing after ``limit``."""
    begin = time.process_time()
    plan = incmode.shortest_plan([source.text for source in task.sources], [one.term for one in task.goals], limit)
    if plan is None:
        return {}
    seconds = time.process_time() - begin
    check(task.world(), plan)
    return {"incmode [s]": seconds, "incmode": len(plan)}


def fast_downward(task, limit, seconds):
    """Return seconds and steps of Fast Downward's first plan within ``limit``, and its best steps in ``seconds``."""
    cells = {}
    for name, end in (("lama-first", limit), ("lama", seconds)):
        spent, steps = peers.fast_downward(task, name, end)
        if steps is not None:
            cells.update({f"{name} [s]": spent, name: steps})
    return cells


def measure_row(domain, size, options):
    """Return the figures of a row."""
    task = DOMAINS[domain].make(*DOMAINS[domain].sizes[size], seed=options.seed)
    cells = first_plans(task, options.limit, options.seconds)
    cells["executed"] = execute(task, options.action_time, options.limit).get("executed")
    cells.update(incremental_mode(task, options.limit))
    if task.robots == 1 and peers.folder_of(peers.FAST_DOWNWARD):
        cells.update(fast_downward(task, options.limit, options.lama_seconds))
    steps = [cells[name] for name in UNITS if UNITS[name] == "steps" and cells.get(name) is not None]
    cells["best"] = min(steps, default=None)
    return cells


def measure(options):
    """Yield the figures of all rows."""
    for domain, size in product(options.domains, options.sizes):
        yield from row_figures(f"{domain}, {size}", measure_row(domain, size, options), UNITS)


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        domains=Option([*DOMAINS], "domains to measure", ["blocks", "elevator", "keys", "crates"], [*DOMAINS]),
        sizes=Option(SIZES, "sizes of tasks", ["small"], SIZES),
        seconds=Option(5.0, "seconds to improve the first plan", 0.5),
        lama_seconds=Option(10.0, "time limit of seq-sat-lama-2011", 1.0),
        **OPTIONS,
    )
