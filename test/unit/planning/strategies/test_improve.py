"""Improving plans in small programs (see also test_walks.py and test_events.py)."""

import time
from dataclasses import replace

import pytest
from plain_walk import EARLY
from stream_play import adopt, check_answer, delay_plan

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, commitment, parse_update
from rosoclingo.planning.history import AcceptedUpdate, History, Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver


def requested(*places, text=EARLY, horizon=1, delay=0, further="", **options):
    """Return a solver with a plan for some places.

    The plan can be long if the first grounding has a large ``horizon``. It idles for ``delay`` steps.
    """
    solver = PlanSolver(ReactiveProgram.from_text(text), **{"plan_time": 0.0, **options})
    solver.restore(History().with_entries(AcceptedUpdate(None, horizon)))
    requests = " ".join(f"_request({place},2)." for place in places)
    solver.update(parse_update(f"#step 1 : 60. {requests} {further} #endstep."))
    if delay:
        delay_plan(solver, delay)
    return solver


def at(plan, step):
    return {one for one in plan.actions if cycle_of(one) == step}


# ---- Together with predicted updates ---------------------------------------------------------------------------------


# ---- Without anything to try -----------------------------------------------------------------------------------------


LOOP = EARLY + "#external e(t). c(t) :- e(t)."


@pytest.mark.parametrize(
    "options",
    [
        {"models": 0, "delay": 2},
        {"text": LOOP, "further": "e(1) :- c(1).", "delay": 2},
        {"plan_time": 100.0},
    ],
    ids=["many answers", "regrounding for a loop", "the shortest plan"],
)
def test_improve_leaves_plans_it_cannot_shorten(options, searches):
    solver = requested(3, **options)
    searches.clear()
    assert solver.improve() is None
    assert searches == []


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
    solver = requested(*(f"paint({wall},{wall})" for wall in range(1, walls + 1)), text=PAINT)
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


# ---- Results ---------------------------------------------------------------------------------------------------------


def test_improve_result_is_the_adopted_plan():
    solver = requested(3, delay=2)
    began = time.perf_counter()
    result = solver.improve()
    seconds = time.perf_counter() - began
    assert (result.outcome, result.step, result.shortest) == (SolveOutcome.SATISFIABLE, 1, False)
    assert Plan.from_result(result) == solver.log.plan
    assert 0.0 <= result.statistics.pop("solve") <= seconds
    assert result.statistics == {"ground": 0.0, "needed": 0.0}
    assert PlanSolver(solver.program, plan_time=0.0).improve() is None, "there is no plan to improve"


# ---- Stops -----------------------------------------------------------------------------------------------------------


#: A robot waters plants in a corridor; the fern comes before another plant.
GARDEN = """
#program base. at(0,0). plant(fern,2). plant(lily,2). plant(rose,0). plant(ivy,0). first(fern,{}).
#program cumulative(t).
{{ _action_lib(go,X+1,t) : X < 2; _action_lib(go,X-1,t) : X > 0; _action_lib(water,P,t) : plant(P,X) }} 1 :- at(X,t-1).
at(X,t) :- _action_lib(go,X,t).
at(X,t) :- at(X,t-1), not _action_lib(go,_,t).
wet(P,t) :- _action_lib(water,P,t).
wet(P,t) :- wet(P,t-1).
:- first(P,Q), _action_lib(water,Q,t), not wet(P,t-1).
#program volatile(t).
:- plant(P,X), not wet(P,t).
#program base.
#show _action_lib/3.
"""
TO_AND_FRO = "go 1; go 2; water fern; go 1; go 0; water rose; go 1; go 2; water lily; go 1; go 0; water ivy"


@pytest.mark.parametrize(("later", "horizon"), [("lily", 7), ("rose", 9)])
def test_improve_reorders_tasks_as_the_program_allows(later, horizon):
    solver = requested(text=GARDEN.format(later), horizon=13)
    acts = [one.replace(" ", ",") for one in TO_AND_FRO.split("; ")]
    adopt(solver, [f"_action_lib({one},{cycle})" for cycle, one in enumerate(acts, 2)], 13)
    while (result := solver.improve()) is not None:
        check_answer(solver, result)
    assert solver.log.plan.horizon == horizon
