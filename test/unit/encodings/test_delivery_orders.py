"""Improved plans of the mailbot: a reordered plan is far shorter and obeys the rules."""

import pytest
from mailbot_world import neighbours, program
from office_world import Office

from rosoclingo.oclingo import parse_update
from rosoclingo.planning.history import cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.strategies import reorder
from rosoclingo.reasoning.keywords import action_of

ROW = tuple((number, number + 1) for number in range(1, 20))


def errands(number, offices):
    """Return a number of requests between offices, always the same."""
    pairs = ((7 * one % offices + 1, (3 * one + one // 5 + 2) % offices + 1) for one in range(number))
    return [(a, b if b != a else b % offices + 1) for a, b in pairs]


def improved(corridors, requests, questions):
    """Return the steps of the first plan, and of the best after a number of improvement questions."""
    solver = PlanSolver(program(20, corridors, 1, 3), plan_time=0.0)
    goals = [f"_request(goal(o{a},o{b},{n}),2)." for n, (a, b) in enumerate(requests, 1)]
    solver.update(parse_update(f"#step 1 : 300. {' '.join(goals)} #endstep."))
    first = solver.log.plan.horizon
    running = {one for one in solver.log.plan.actions if cycle_of(one) <= 1}
    for _ in range(questions):
        if solver.improve() is None:
            break
    plan = solver.log.plan
    assert running == {one for one in plan.actions if cycle_of(one) <= 1}
    packages = {number: ("waits", f"o{a}", f"o{b}") for number, (a, b) in enumerate(requests, 1)}
    office = Office(neighbours([(f"o{a}", f"o{b}") for a, b in corridors]), 3, "o1", packages)
    assert office.judge(map(action_of, plan.actions), 1) <= plan.horizon
    return first, plan.horizon


@pytest.mark.slow
def test_reorder_first_better_plan_is_far_better(monkeypatch):
    """One further question turns 116 steps into 96."""
    monkeypatch.setattr(reorder, "EFFORT", 40_000)  # as in a core; other tests try fewer orders
    first, steps = improved(ROW, errands(20, 20), 1)
    assert first > 110
    assert steps <= 100
