"""The search for a first plan: its questions, and the time for better plans (see also test_walks.py)."""

import pytest
from fake_grounding import FakeGrounding, actions
from hypothesis import given
from hypothesis import strategies as st
from stream_play import adopt

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.strategies.soon import LATER, FirstPlanSearch

# ---- Questions -------------------------------------------------------------------------------------------------------


def plan(horizon, *cycles, shortest=False):
    return Plan(actions(*cycles), horizon, shortest)


def run(plans, options, last=None, block=8, predicted=False):
    """Return the first plan (None after a stop), its horizon (False: no plan), and the questions."""
    found, asked = FakeGrounding(plans, **options).run(
        lambda runner: FirstPlanSearch(runner, last, predicted).run(), block
    )
    return found, found and found.reply.satisfiable and found.reply.horizon, asked


HORIZONS = st.integers(2, 30)
WORLDS = st.fixed_dictionaries(
    {
        "step": st.integers(1, 2),
        "horizon": st.integers(2, 12),
        "most": st.integers(12, 30),
        "hard": st.dictionaries(HORIZONS, st.integers(0, 90_000), max_size=3),
        "advises": st.booleans(),
        "claims": st.integers(0, 40),
    }
)
LAST = st.none() | st.builds(lambda horizon, cycles: plan(horizon, *cycles), HORIZONS, st.sets(HORIZONS, max_size=4))


@given(st.dictionaries(HORIZONS, st.lists(HORIZONS, max_size=4), max_size=3), WORLDS, LAST, st.sampled_from([1, 8]))
def test_soon_finds_a_plan_or_refutes_all_horizons(plans, world, last, block):
    """Without steps that can invalidate answers, the plan is shortest; a stop ends the search."""
    reachable = [horizon for horizon in plans if horizon <= world["most"]]
    found, horizon, asked = run(plans, world, last, block)
    assert horizon in (reachable or [False])
    assert found.least <= min(reachable, default=100)
    for number in range(asked.count("..")):
        stopped, horizon, _ = run(plans, {**world, "halts": number, "cut": True}, last, block)
        assert stopped is None or horizon in reachable, "a stop only ends the trimming"


# ---- In the solver ---------------------------------------------------------------------------------------------------


CARTS = """
#external _running/3. #external _return/3. #external _request/2.
#program base. cart(r1). cart(r2).
#program cumulative(t).
wanted(t) :- _request(go,t).
wanted(t) :- wanted(t-1).
_action_lib(A,P,t) :- _running(A,P,t-1).
{ _action_lib(go(R),P,t) : P = 1..6 } 1 :- cart(R).
done(R,P,t) :- _action_lib(go(R),P,t), not _running(go(R),P,t).
at(R,0,0) :- cart(R), t = 1.
at(R,P,t) :- done(R,P,t).
at(R,P,t) :- at(R,P,t-1), not done(R,Q,t) : Q = 1..6.
:- _action_lib(go(R),P,t), not at(R,P-1,t-1).
#program volatile(t).
:- wanted(t), at(R,P,t), P < 4.
"""


def late_plan(searches, rule=""):
    """Return the actions planned after cycle 1, in which the second cart is late."""
    solver = PlanSolver(ReactiveProgram.from_text(CARTS + rule), plan_time=0.0)
    solver.update(parse_update("#step 1. _request(go,1). #endstep."))
    searches.clear()
    sent = ":- not _action_lib(go(r1),1,1). :- not _action_lib(go(r2),1,1)."
    news = "_running(go(r2),1,1). _return(go(r1),1,1)."
    result = solver.update(parse_update(f"#step 2. #closed 1. {sent} {news} #endstep."))
    return sorted(str(one) for one in Plan.from_result(result).actions if cycle_of(one) > 1)


def test_soon_delays_only_the_robot_whose_action_goes_on(searches):
    first = [f"_action_lib(go(r1),{place},{place})" for place in (2, 3, 4)]
    second = [f"_action_lib(go(r2),{place},{place + 1})" for place in (1, 2, 3, 4)]
    assert late_plan(searches) == first + second
    assert searches == [(5, 5)], "only the delayed plan"


def test_soon_delays_other_robots_if_one_is_in_the_way(searches):
    """The delayed plan breaks the last rule of the program."""
    found = late_plan(searches, "#program cumulative(t). :- at(r1,3,t), at(r2,2,t).")
    assert len(found) == 7, "each cart goes on"
    assert searches[:2] == [(5, 5), (2, 5 + LATER)], "the delayed plan, and any later one"


def test_soon_drops_the_drives_that_no_goal_needs():
    """The program advises them; with several robots, its advice is not trusted."""
    needs = "#program base. needs(r1,4). needs(r2,0). #program cumulative(t). "
    advice = "#heuristic _action_lib(go(R),P,t) : cart(R), P = 1..6. [1,true]"
    text = CARTS.replace("P < 4", "P < N, needs(R,N)") + needs + advice
    result = PlanSolver(ReactiveProgram.from_text(text), plan_time=0.0).update(
        parse_update("#step 1. _request(go,1). #endstep.")
    )
    assert {str(one.arguments[0]) for one in Plan.from_result(result).actions} == {"go(r1)"}


@pytest.mark.parametrize(
    ("cycles", "rule", "found"),
    [
        ((3, 4), "", [2, 3]),
        ((2, 4), "", [2, 4]),
        ((3, 4), "#program cumulative(t). :- at(r1,2,t), at(r2,1,t).", [3, 4]),
    ],
)
def test_improve_lets_a_cart_go_as_early_as_possible(cycles, rule, found):
    """The second cart's next drive begins in the next cycle if that is possible, although the plan is no shorter."""
    text = CARTS.replace("P < 4", "P < N, needs(R,N)") + "#program base. needs(r1,4). needs(r2,2)." + rule
    solver = PlanSolver(ReactiveProgram.from_text(text), plan_time=0.0)
    solver.update(parse_update("#step 1. _request(go,1). #endstep."))
    drives = [("r1", place, place) for place in (1, 2, 3, 4)] + [("r2", one, cycles[one - 1]) for one in (1, 2)]
    adopt(solver, [f"_action_lib(go({cart}),{place},{cycle})" for cart, place, cycle in drives], 4)
    while solver.improve() is not None:
        pass
    planned = {cart: [] for cart in ("go(r1)", "go(r2)")}
    for one in solver.log.plan.actions:
        planned[str(one.arguments[0])].append(cycle_of(one))
    assert {cart: sorted(some) for cart, some in planned.items()} == {"go(r1)": [1, 2, 3, 4], "go(r2)": found}
