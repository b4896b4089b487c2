"""Plays updates given as text on the stream solvers, and returns their answers."""

import pytest

from rosoclingo.oclingo import DroppedError, ReactiveProgram, ReactiveSolver, parse_update
from rosoclingo.planning.solver import PlanSolver

#: A robot on a line of numbers with requested places.
WALK = """
#program base.
at(0,0).
#program cumulative(t).
#external _request/2.
{ _action_lib(move,X,t) : X = (P-1;P+1), at(P,t-1) } 1.
moves(t) :- _action_lib(move,X,t).
at(X,t) :- _action_lib(move,X,t).
at(X,t) :- at(X,t-1), not moves(t).
wanted(X,t) :- _request(X,t).
wanted(X,t) :- wanted(X,t-1).
reached(X,t) :- wanted(X,t), at(X,t).
reached(X,t) :- reached(X,t-1).
#program volatile(t).
:- wanted(X,t), not reached(X,t).
"""

#: The incremental solver and the planner.
SOLVERS = pytest.mark.parametrize("kind", [ReactiveSolver, PlanSolver])


def solver_of(text, kind=ReactiveSolver, **options):
    """Return a solver for a program given as text."""
    return kind(ReactiveProgram.from_text(text), **options)


def planner_of(text, **options):
    """Return a planner for a program given as text."""
    return solver_of(text, PlanSolver, **options)


def play(solver, text):
    """Play an update and return the result."""
    return solver.update(parse_update(text + " #endstep."))


def atoms(result):
    """Return the atoms of the first answer as sorted texts."""
    return sorted(map(str, result.answers[0]))


def plan(result):
    """Return the actions of the first answer as sorted texts."""
    return [str(one) for one in sorted(result.answers[0]) if one.name == "_action_lib"]


def drop_grounding(solver):
    """Force an incremental solver to reground, by an update that is dropped."""
    with pytest.raises(DroppedError):
        solver.update(parse_update("#step 99. #endstep."), None, lambda: True)
