"""Plays texts of updates on the solvers of streams, and reads their answers."""

import pytest

from rosoclingo.oclingo import DroppedError, ReactiveProgram, ReactiveSolver, parse_update
from rosoclingo.planning.solver import PlanSolver

#: A robot on a line of numbers that is asked to go to some of them.
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

#: oClingo's own solver, and the solver of plans.
SOLVERS = pytest.mark.parametrize("kind", [ReactiveSolver, PlanSolver])


def solver_of(text, kind=ReactiveSolver, **options):
    """A solver of a program's text."""
    return kind(ReactiveProgram.from_text(text), **options)


def planner_of(text, **options):
    """A solver of plans of a program's text."""
    return solver_of(text, PlanSolver, **options)


def play(solver, text):
    """The result of an update."""
    return solver.update(parse_update(text + " #endstep."))


def atoms(result):
    """The atoms of the first answer as texts, in order."""
    return sorted(map(str, result.answers[0]))


def plan(result):
    """The actions of the first answer as texts, in order."""
    return [str(one) for one in sorted(result.answers[0]) if one.name == "_action_lib"]


def drop_grounding(solver):
    """Have an incremental solver ground its program again: an update that was dropped leaves no grounding."""
    with pytest.raises(DroppedError):
        solver.update(parse_update("#step 99. #endstep."), None, lambda: True)
