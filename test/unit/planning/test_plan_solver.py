"""The planner: behaviour that neither random streams nor tests of its parts cover."""

import time
from types import SimpleNamespace

import pytest
from stream_play import WALK, plan, planner_of, play

from rosoclingo.oclingo import SolveOutcome
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.strategies import soon


@pytest.mark.parametrize(("options", "needed"), [({"plan_time": 9.0}, 3.0), ({}, 0.0)])
def test_solver_counts_the_time_until_an_answer(monkeypatch, options, needed):
    """The clock after the search is irrelevant, as the search continues to improve the answer."""
    ended = SimpleNamespace(perf_counter=time.perf_counter, process_time=lambda: 100.0)
    monkeypatch.setattr(solver_module, "time", ended)
    monkeypatch.setattr(soon, "time", SimpleNamespace(process_time=lambda: 103.0))
    solver = planner_of("#cumulative t. { a(t) }. #volatile t. :- t < 3.", **options)
    assert play(solver, "#step 1 : 9.").statistics["needed"] == needed


def test_solver_reports_messages_of_clingo_once():
    solver = planner_of("#cumulative t. #external e(t). c(Y+t) :- e(t), p(Y). #base. p(1). p(a).")
    found = [one for step in (1, 2) for one in play(solver, f"#step {step} : 0. e({step}). e(x).").warnings]
    assert sum("e(x)" in one for one in found) == 2, "each update has an ignored fact"
    assert sum("undefined operation" in one for one in found) == 1


def test_solver_keeps_the_last_plan_without_an_answer():
    solver = planner_of(WALK)
    play(solver, "#step 1. _request(2,1).")
    last = solver.log.plan
    assert len(last.actions) == 2
    assert play(solver, "#step 2 : 0. #volatile. :- at(0,0).").outcome is SolveOutcome.UNSATISFIABLE
    assert solver.log.plan == last


def line(first, last):
    """Return the actions of a walk to the right."""
    return [f"_action_lib(move,{step},{step})" for step in range(first, last + 1)]


def test_solver_finds_shortest_plans_after_going_back():
    solver = planner_of(WALK, horizon_limit=30)
    assert plan(play(solver, "#step 1. _request(4,1).")) == line(1, 4)
    log, grown = solver.log, solver.horizon
    play(solver, "#step 2. _request(-4,2).")
    assert solver.horizon > grown
    solver.restore(log)
    assert solver.horizon == grown
    assert plan(play(solver, "#step 1. _request(5,1).")) == line(1, 5)
