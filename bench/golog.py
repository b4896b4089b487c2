#!/usr/bin/env python3
"""Measures the search for shortest plans with control knowledge, written in Golog, and without it.

Random towers of blocks are to be rearranged into other random towers, one move of a block in each step. There are
two kinds of programs:
  alone    the domain alone, with a choice of any move in each step
  control  a control program that moves blocks to their final places as soon as these are ready, in the order of their
           names. It moves a block to the table only if no final place is ready. At least one shortest plan remains.

All plans are shortest plans, so both kinds need equally many moves. With other names for the same blocks, clasp takes
half or twice the time. So each task is solved with several sets of names, and the figures are medians.

Run it in the built workspace: ./dev exec python3 bench/golog.py --blocks 18
"""

import random
import statistics
import time

from deliveries import ENCODINGS
from figures import Figure, Option, main
from planning_domains.tasks import towers

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_update
from rosoclingo.oclingo.program.sources import Source
from rosoclingo.planning.solver import PlanSolver

DOMAIN = """
#program base.
place(B) :- block(B).
place(table).
on(B,X,0) :- first(B,X).

#program cumulative(t).
#external _request/2.
#external _return/3.
holds(B,X,t)   :- on(B,X,t-1).
covered(X,t)   :- on(B,X,t-1), X != table.
right(B,t)     :- last(B,table), on(B,table,t-1).
right(B,t)     :- last(B,X), on(B,X,t-1), right(X,t).
wrong(t)       :- block(B), not right(B,t).
can(B,X,t)     :- block(B), place(X), B != X, not covered(B,t), not covered(X,t), not on(B,X,t-1).
moved(B,t)     :- _action_lib(B,X,t).
on(B,X,t)      :- _action_lib(B,X,t).
on(B,X,t)      :- on(B,X,t-1), not moved(B,t).
:- 2 { _action_lib(B,X,t) }.
#show _action_lib/3.
"""

ALONE = """
#program cumulative(t).
asked(t) :- _request(tower,t+1).
asked(t) :- asked(t-1).
{ _action_lib(B,X,t) : can(B,X,t) } 1 :- asked(t).
#program volatile(t).
:- asked(t), wrong(t).
:- asked(t), _action_lib(B,X,t).
"""

WORDS = """
#include "golog.lp".
#program cumulative(t).
golog_action(move(B,X),B,X,t) :- can(B,X,t).
golog_holds(done,t)           :- not wrong(t).
golog_holds(ready(B,X),t)     :- last(B,X), not right(B,t), can(B,X,t), right(X,t).
golog_holds(ready(B,table),t) :- last(B,table), not right(B,t), can(B,table,t).
golog_holds(astray(B),t)      :- block(B), not right(B,t), can(B,table,t).
"""

CONTROL = """
proc control {
    while not done {
        if ready(_, _) { pick B, X: ready(B, X) and not some C: ready(C, _) and C < B { move(B, X); } }
        else           { pick B: astray(B) { move(B, table); } }
    }
}
"""

KINDS = {"alone": "tower", "control": "run(control,1)"}  # and the requests for their plans


def renamed(first, last, dice):
    """Return the same towers with shuffled names of the blocks."""
    names = dict(zip(sorted(first), dice.sample(sorted(first), len(first))), table="table")
    return tuple({names[one]: names[below] for one, below in those.items()} for those in (first, last))


def program_of(kind, first, last):
    """Return the program of a task, which rearranges the towers ``first`` into ``last``."""
    facts = [f"block({one})." for one in first]
    facts += [f"first({one},{below})." for one, below in first.items()]
    facts += [f"last({one},{below})." for one, below in last.items()]
    sources = [Source("domain.lp", DOMAIN), Source("task.lp", "#program base. " + " ".join(facts))]
    if kind == "alone":
        return ReactiveProgram([*sources, Source("alone.lp", ALONE)])
    return ReactiveProgram([*sources, Source("words.lp", WORDS, ENCODINGS), Source("blocks.golog", CONTROL)])


def plan_of(kind, program, limit):
    """Return the number of moves, None after ``limit`` seconds, and the processor time of the search in seconds."""
    solver = PlanSolver(program)
    solver.solve()
    update = parse_update(f"#step 1 : 100. _request({KINDS[kind]},2). #endstep.")
    begin = time.process_time()
    result = solver.update(update, lambda: time.process_time() - begin > limit)
    seconds = time.process_time() - begin
    if result.outcome is not SolveOutcome.SATISFIABLE:
        return None, seconds
    return sum(one.name == "_action_lib" for one in result.answers[0]), seconds


def measure(options):
    """Solve the tasks with each kind of program; yield the median times."""
    dice, times = random.Random(options.seed), {kind: [] for kind in KINDS}
    for task in range(1, options.tasks + 1):
        given = [towers(range(1, options.blocks + 1), dice) for _ in range(2)]
        for number in range(options.names):
            first, last = renamed(*given, random.Random(number)) if number else given
            lengths = set()
            for kind in KINDS:
                moves, seconds = plan_of(kind, program_of(kind, first, last), options.limit)
                times[kind].append(seconds)
                lengths |= {moves} - {None}
                length = "no plan in time" if moves is None else f"{moves} moves"
                print(f"task {task}: {kind:8} {seconds:8.2f} s, {length}", flush=True)
            if len(lengths) > 1:
                raise SystemExit("the plans have different lengths")
    for kind in KINDS:
        yield Figure(f"{kind}, {options.blocks} blocks", statistics.median(times[kind]), "s")


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        blocks=Option(18, "number of blocks", 15),
        tasks=Option(3, "number of tasks", 1),
        names=Option(5, "sets of names for each task"),
        seed=Option(1, "seed of the tasks"),
        limit=Option(300.0, "seconds of processor time for one search", 30.0),
    )
