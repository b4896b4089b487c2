"""Updates about running actions: the planner answers them in the grounding of its last search."""

from random import Random

import clingo
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.strategy_runner import StrategyRunner

#: Carts to place 4; r2 follows r1. With a failure, a cart stays where it is.
TRACK = """
#external _running/3. #external _return/3. #external _failed/3. #external _request/2.
#program base. cart(r1). cart(r2). at(r1,1,0). at(r2,0,0).
#program cumulative(t).
wanted(t) :- _request(go,t).
wanted(t) :- wanted(t-1).
_action_lib(A,P,t) :- _running(A,P,t-1).
{ _action_lib(go(r1),P,t) : P = 1..6 } 1.
{ _action_lib(go(r2),P,t) : P = 1..6, P <= Q } 1 :- at(r1,Q,t-1).
failed(R,t) :- _action_lib(go(R),P,t), _failed(go(R),V,t).
done(R,P,t) :- _action_lib(go(R),P,t), not _running(go(R),P,t), not failed(R,t).
at(R,P,t) :- done(R,P,t).
at(R,P,t) :- at(R,P,t-1), not done(R,Q,t) : Q = 1..6.
:- _action_lib(go(R),P,t), not at(R,P-1,t-1), not _running(go(R),P,t-1).
#show _action_lib/3.
#program volatile(t).
:- wanted(t), at(R,P,t), P < 4.
"""
PROGRAM = ReactiveProgram.from_text(TRACK)


def update_after(plan, step, random, failures):
    """Return the text of the update of ``step``: some of the actions before it have returned."""
    actions = sorted(one for one in plan.actions if cycle_of(one) == step - 1)
    lines = [f":- not {one}." for one in actions]
    for number, one in enumerate(random.sample(actions, len(actions))):
        name, place, cycle = one.arguments
        fails = random.random() < failures
        ends = f"_return({name},{'blocked' if fails else place},{cycle})."
        lines.append(ends if number == 0 or random.random() < 0.3 else f"_running({name},{place},{cycle}).")
    return f"#step {step} : 12. #closed {step - 1}. {' '.join(lines)} #endstep."


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 6)
@given(st.integers(0, 10**6), st.sampled_from([0.0, 0.2]), st.sampled_from([None, 0.0]))
def test_planner_answers_as_if_it_had_grounded_the_update(seed, failures, plan_time):
    random = Random(seed)
    solver = PlanSolver(PROGRAM, plan_time=plan_time, idles=True)
    result = solver.update(parse_update("#step 1 : 12. _request(go,1). #endstep."))
    for step in range(2, 10):
        before, update = solver.log, parse_update(update_after(solver.log.plan, step, random, failures))
        result = solver.search(update, lambda: False)
        fresh = PlanSolver(PROGRAM, idles=True)
        fresh.restore(before)
        shortest = fresh.search(update, lambda: False)
        assert (result.outcome, shortest.outcome) == (SolveOutcome.SATISFIABLE, SolveOutcome.SATISFIABLE)
        assert result.horizon == shortest.horizon if plan_time is None else result.horizon >= shortest.horizon
        assert is_plan(Plan.from_result(result), before, update)
        better = solver.improve()
        assert better is None or is_plan(Plan.from_result(better), before, update)


def is_plan(plan, before, update):
    """Return whether ``plan`` is a plan after the update, according to a new grounding."""
    checker = PlanSolver(PROGRAM, idles=True)
    checker.restore(before.with_entries())
    checker.search(update, lambda: False)
    actions = sorted(one for one in plan.actions if cycle_of(one) >= update.step)
    others = [
        clingo.Function("_action_lib", [clingo.Function("go", [clingo.Function(cart)]), clingo.Number(place), cycle])
        for cart in ("r1", "r2")
        for place in range(1, 7)
        for cycle in map(clingo.Number, range(update.step, plan.horizon + 1))
    ]
    given_actions = [f":- not {one}." for one in actions] + [f":- {one}." for one in others if one not in plan.actions]
    steps = plan.horizon - update.step
    text = f"#step {update.step} : {steps}. #volatile. {' '.join(given_actions)} #endstep."
    return checker.search(parse_update(text), lambda: False).outcome is SolveOutcome.SATISFIABLE


@pytest.mark.parametrize("rule", ["", "slow(A) :- _takes(A,any,S), S > 5."])
def test_durations_need_no_grounding(rule):
    """A program that uses durations itself plans them as steps, so the planner does not."""
    program = ReactiveProgram.from_text(TRACK.replace("#program base.", f"#external _takes/3. #program base. {rule}"))

    def build(snapshot, horizon, stopped):
        return Grounding(program, snapshot, horizon, frozenset(), stopped, False)

    first = Snapshot.initial(program).with_update(parse_update("#step 1 : 12. _request(go,1). #endstep."), program)
    runner = StrategyRunner(program, first, build, 8)
    then = "#step 2 : 12. #closed 1. _takes(go(r1),any,8). _takes(go(r1),4,9). #endstep."
    later = runner.following(first.with_update(parse_update(then), program))
    if rule:
        assert later is None or later.durations == {}
    else:
        assert {str(name): seconds for name, seconds in later.durations.items()} == {"go": 8}
