"""Improving plans in small programs (see also test_walks.py and test_events.py)."""

from dataclasses import replace

import pytest
from stream_play import adopt, delay_plan

from rosoclingo.oclingo import ReactiveProgram, commitment, parse_update
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver


def at(plan, step):
    return {one for one in plan.actions if cycle_of(one) == step}


#: A robot paints walls with paints of different prices.
PAINT = """
#program cumulative(t).
#external _request/2. #external _return/3.
{ _action_lib(paint,wall(W,P),t) : W = 1..8, P = 1..3; _action_lib(wait,nothing,t) } 1.
painted(W,t) :- _action_lib(paint,wall(W,P),t).
painted(W,t) :- painted(W,t-1).
wanted(W,t) :- _request(paint(W,I),t+1).
wanted(W,t) :- wanted(W,t-1).
:- _action_lib(paint,wall(W,P),t), painted(W,t-1).
#minimize { (W*P)\\5,W,P,t : _action_lib(paint,wall(W,P),t) }.
#program volatile(t).
:- wanted(W,t), not painted(W,t).
#program base.
#show _action_lib/3.
"""


def price(plan):
    """Return the cost of a plan for PAINT."""
    walls = [one.arguments[1].arguments for one in plan.actions if str(one.arguments[0]) == "paint"]
    return sum(wall.number * paint.number % 5 for wall, paint in walls)


@pytest.mark.mostly_slow
@pytest.mark.parametrize(("walls", "steps"), [(1, 0), (4, 2)])
def test_improve_lowers_the_cost_of_optimizing_programs(walls, steps):
    """Down to the optimum, which a search without a limit proves; running actions stay."""
    solver = PlanSolver(ReactiveProgram.from_text(PAINT), plan_time=0.0)
    requests = " ".join(f"_request(paint({wall},{wall}),2)." for wall in range(1, walls + 1))
    solver.update(parse_update(f"#step 1 : 60. {requests} #endstep."))
    asked = solver.log.update
    adopt(solver, [f"_action_lib(paint,wall({wall},2),{wall})" for wall in range(1, walls + 1)], walls)
    delay_plan(solver, steps)
    plan = solver.log.plan
    while (result := solver.improve()) is not None:
        better = Plan.from_result(result)
        assert (better.horizon, price(better)) < (plan.horizon, price(plan))
        assert at(better, 1) == at(plan, 1)
        plan = better
    best = PlanSolver(solver.program).update(replace(asked, items=(*asked.items, *map(commitment, at(plan, 1)))))
    assert best.shortest
    assert (plan.horizon, price(plan)) == (best.horizon, price(Plan.from_result(best)))
