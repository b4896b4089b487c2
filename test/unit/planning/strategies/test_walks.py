"""Random streams of a robot on a line: plans soon and their improvements, compared with a reference."""

from itertools import count

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_walk import Walk, program_text
from stream_logs import copied
from stream_play import delay_plan, processor_clock, stop_after
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome
from rosoclingo.planning.history import Plan, cycle_of
from rosoclingo.planning.solver import PlanSolver

FOREVER = float("inf")
PROGRAMS = {advice: ReactiveProgram.from_text(program_text(advice)) for advice in (False, True)}

#: For each step: requested places, and whether the previous action has failed.
NEWS = st.lists(st.tuples(st.lists(st.integers(-3, 4), max_size=2), st.booleans()), min_size=1, max_size=6)
BOUNDS = st.none() | st.integers(0, 5)


def play(solver, news, bound, improve):
    """Execute the plans of a stream; yield walk, result and the rest of the previous plan after each update."""
    walk, left = Walk(), None
    for wanted, fails in news:
        done = frozenset(one for one in left.actions if cycle_of(one) == walk.step) if left else frozenset()
        before = left and left._replace(actions=left.actions - done)
        with processor_clock(count(0.0).__next__):
            result = solver.update(walk.update(wanted, fails, done, bound))
        assert result.step == walk.step
        yield walk, result, before
        if not result.answers:
            return
        improve(solver, walk)
        left = solver.log.plan.rest(walk.step)


@settings(max_examples=sized(7, settings.default.max_examples * 4 // 5))
@given(st.booleans(), st.sampled_from([0.0, 0.0, FOREVER]) | st.integers(0, 12), BOUNDS, NEWS)
def test_plans_hold_in_random_streams(advice, plan_time, bound, news):
    """Plans are valid, and shortest if there is time; without time a valid last plan is kept."""
    solver = PlanSolver(PROGRAMS[advice], plan_time=plan_time, log_limit=2)
    for walk, result, before in play(solver, news, bound, lambda *_: None):
        if result.outcome is SolveOutcome.UNSATISFIABLE:
            assert walk.least(walk.step, walk.step + bound) is None
            return
        found = Plan.from_result(result)
        assert solver.log.plan == found
        assert walk.allows(found.horizon, found.rest(walk.step).actions)
        assert result.shortest or plan_time < FOREVER
        if result.shortest:
            assert walk.least(walk.step, result.horizon) == result.horizon
        if plan_time == 0 and before and walk.allows(max(before.horizon, walk.step), before.actions):
            assert found.rest(walk.step).actions == before.actions
            assert found.horizon <= max(before.horizon, walk.step)
        if plan_time == 0 and bound is None:
            reader = PlanSolver(solver.program, plan_time=0.0)
            reader.restore(copied(solver.log))
            again = Plan.from_result(reader.solve())
            assert walk.allows(again.horizon, again.rest(walk.step).actions)


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 4)
@given(st.booleans(), NEWS, st.integers(0, 3), st.none() | st.integers(0, 30))
def test_improved_plans_keep_actions_up_to_the_present(advice, news, delay, looks):
    """Each is shorter; without a stop, the last one is shortest."""

    def improve(solver, walk):
        plan, key = delay_plan(solver, delay), solver.log.key
        while (result := solver.improve(stop_after(looks))) is not None:
            better = Plan.from_result(result)
            assert better == solver.log.plan
            assert better.horizon < plan.horizon
            assert all(cycle_of(one) > walk.step for one in better.actions ^ plan.actions)
            assert walk.allows(result.horizon, better.rest(walk.step).actions)
            plan = better
        assert solver.log.plan == plan
        assert solver.log.key == key, "only the plan is appended"
        if looks is None:
            now = frozenset(one for one in plan.actions if cycle_of(one) == walk.step)
            assert Walk(walk.step + 1, walk.facts, walk.done | now).least(walk.step, plan.horizon) == plan.horizon

    for _ in play(PlanSolver(PROGRAMS[advice], plan_time=0.0), news[:4], None, improve):
        pass
