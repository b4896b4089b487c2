"""Shorter plans: what is committed or running stays as it is, and a stop at any moment leaves a plan."""

import time
from itertools import count

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from plain_walk import Walk, program_text

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, SolveOutcome, StreamUpdate, parse_atom, parse_update
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.improvement import Part
from rosoclingo.oclingo.solving.stream_log import Plan, cycle_of

PROGRAMS = {advice: ReactiveProgram.from_text(program_text(advice)) for advice in (False, True)}

#: What comes with each step: places that are wanted, and whether the action before has failed.
NEWS = st.tuples(st.lists(st.integers(-4, 5), max_size=3), st.booleans())


def solver_of(advice=True, **options):
    return ReactiveSolver(PROGRAMS[advice], shortest=True, oclingo_strings=False, plan_time=0.0, **options)


def stop_after(looks):
    """A stop that comes with the so many-th look, None for never."""
    numbers = count()
    return lambda: looks is not None and next(numbers) >= looks


def at(plan, first, last):
    return {one for one in plan.actions if first <= cycle_of(one) <= last}


def moved(action, steps):
    kind, what, cycle = action.arguments
    return parse_atom(f"_action_lib({kind},{what},{cycle.number + steps})")


def worse(plan, step, idle):
    """The same plan with so many idle steps behind the present one: what comes later comes as much later."""
    later = Plan(frozenset(plan.actions - at(plan, 0, step)), plan.horizon)
    for _ in range(idle):
        later = later.later()
    return Plan(later.actions | at(plan, 0, step), plan.horizon + idle)


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples * 2 // 5)
@given(st.booleans(), st.lists(NEWS, min_size=1, max_size=4), st.integers(0, 3), st.none() | st.integers(0, 30))
def test_improved_plans_are_plans_that_leave_past_and_present_alone(advice, news, idle, looks):
    walk, solver, done = Walk(), solver_of(advice), set()
    for wanted, fails in news:
        update = walk.update(wanted, fails, done, None)
        if walk.step > 1:
            solver.close_cycle(walk.step - 1, done)
        solver.update(update)
        plan = solver.log.plan = worse(solver.log.plan, walk.step, idle)
        entries = solver.log.entries
        while True:
            result = solver.improve(stop_after(looks))
            if result is None:
                break
            better = result.plan
            assert better == solver.log.plan
            assert better.horizon < plan.horizon
            assert at(better, 0, walk.step) == at(plan, 0, walk.step)
            assert walk.allows(result.horizon, frozenset(at(better, walk.step, result.horizon)))
            plan = better
        assert solver.log.plan == plan
        assert solver.log.entries == entries
        done = at(plan, walk.step, walk.step)
        if looks is None:
            next_step = Walk(walk.step + 1, walk.facts, walk.done | done)
            assert next_step.least(walk.step, plan.horizon) == plan.horizon


def test_nothing_is_tried_where_there_is_nothing_to_shorten():
    solver = solver_of()
    asked = []
    assert solver.improve(lambda: asked.append(1)) is None
    solver.update(parse_update("#step 1. _request(3,1). _request(-2,1). #endstep."))
    while solver.improve() is not None:
        pass
    asked.clear()
    assert solver.improve(lambda: asked.append(1)) is None
    assert len(asked) <= 1
    assert ReactiveSolver(PROGRAMS[True]).improve() is None


def idling(solver, further=""):
    """The solver with a plan that idles for two steps."""
    solver.update(parse_update(f"#step 1. _request(3,1). {further} #endstep."))
    solver.log.plan = worse(solver.log.plan, 1, 2)
    return solver


LOOP = "#program cumulative(t). #external e(t). c(t) :- e(t)."


@pytest.mark.parametrize(
    ("text", "further", "options"),
    [
        ("", "", {"models": 0}),
        ("#program cumulative(t). #minimize { 1,X,t : at(X,t) }.", "", {}),
        (LOOP, "e(1) :- c(1).", {}),
    ],
)
def test_plans_that_are_one_of_many_the_best_or_ground_anew_are_left_as_they_are(text, further, options, searches):
    program = ReactiveProgram.from_text(program_text() + text)
    solver = idling(ReactiveSolver(program, shortest=True, plan_time=0.0, **options), further)
    searches.clear()
    assert solver.improve() is None
    assert searches == []
    other = idling(ReactiveSolver(ReactiveProgram.from_text(program_text() + LOOP), shortest=True, plan_time=0.0))
    assert other.improve() is not None


def test_of_a_plan_that_is_the_shortest_or_not_ground_nothing_is_asked(searches):
    """Nor by a solver that looks for no shortest ones."""
    solver = ReactiveSolver(PROGRAMS[True], shortest=True, oclingo_strings=False, plan_time=100.0)
    solver.update(parse_update("#step 1. _request(3,1). #endstep."))
    assert solver.log.plan.shortest
    reader, other = solver_of(), ReactiveSolver(PROGRAMS[True], oclingo_strings=False)
    for one in (reader, other):
        one.restore(idling(solver_of()).log)
    other.solve()
    searches.clear()
    assert (solver.improve(), reader.improve(), other.improve()) == (None, None, None)
    assert searches == []


def test_a_better_plan_is_the_answer_from_then_on():
    solver = idling(solver_of())
    solver.interrupt()  # what ran before
    began = time.perf_counter()
    result = solver.improve()
    seconds = time.perf_counter() - began
    assert (result.outcome, result.step) == (SolveOutcome.SATISFIABLE, 1)
    assert 3 <= result.horizon < 5
    assert (result.plan, result.shortest) == (solver.log.plan, False)
    assert 0.0 <= result.statistics.pop("solve") <= seconds
    assert result.statistics == {"ground": 0.0, "needed": 0.0}


def test_all_idle_steps_go_at_once_with_the_first_that_a_window_fills():
    solver = solver_of()
    solver.update(parse_update("#step 1. _request(40,1). #endstep."))
    plan = solver.log.plan
    idle = {one: sum(cycle_of(one) > last for last in (4, 22, 30)) for one in plan.actions}
    solver.log.plan = Plan(frozenset(moved(one, steps) for one, steps in idle.items()), plan.horizon + 3)
    assert solver.improve().horizon == plan.horizon


def test_an_action_is_put_off_for_some_steps_and_all_is_free_from_there_on():
    actions = [parse_atom(text) for text in ("_action_lib(go,a,1)", "_action_lib(take,b,2)", "_action_lib(go,c,3)")]
    part = Part(2, put_off=actions[1], span=3)
    later = [parse_atom(f"_action_lib(take,b,{cycle})") for cycle in (2, 3, 4)]
    assert part.given(Plan(frozenset(actions), 3)) == [(actions[0], True), *((one, False) for one in later)]


def test_the_next_update_goes_on_from_the_better_plan():
    solver = solver_of()
    solver.update(parse_update("#step 1. _request(3,1). #endstep."))
    solver.log.plan = worse(solver.log.plan, 1, 1)
    better = solver.improve().plan
    (action,) = at(better, 1, 1)
    result = solver.update(StreamUpdate(2, items=parse_update(f"#step 2. :- not {action}. #endstep.").items))
    assert result.plan.since(2).actions == better.since(2).actions
    assert result.horizon == 3


@pytest.mark.parametrize("looks", [0, 1, 5])
def test_no_question_is_asked_after_a_stop(looks, monkeypatch):
    solver = solver_of()
    solver.update(parse_update("#step 1. _request(5,1). _request(-4,1). #endstep."))
    plan = solver.log.plan = worse(solver.log.plan, 1, 2)
    stop, stopped, search = stop_after(looks), [], Grounding.search

    def look():
        stopped.append(stop())
        return stopped[-1]

    def asked(grounding, models, stopped_now, *arguments, **limits):
        assert True not in stopped
        stopped_now()  # a search that is quick never looks, one that is slow does
        return search(grounding, models, stopped_now, *arguments, **limits)

    monkeypatch.setattr(Grounding, "search", asked)
    while (result := solver.improve(look)) is not None:
        plan = result.plan
    assert True in stopped
    assert solver.log.plan == plan
