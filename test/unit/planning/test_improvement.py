"""Shorter plans: what is committed or running stays as it is, and a stop at any moment leaves a plan."""

import time
from functools import lru_cache
from itertools import count
from random import Random

import pytest
from foreign_programs import SOUND
from hypothesis import event, given, settings
from hypothesis import strategies as st
from plain_walk import Walk, program_text
from shipped import shipped

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, StreamUpdate, commitment, fact, parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import Closed, Over
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import AcceptedUpdate, History, Plan, cycle_of
from rosoclingo.planning.prediction import success_of
from rosoclingo.planning.question import Question
from rosoclingo.planning.solver import PlanSolver

PROGRAMS = {advice: ReactiveProgram.from_text(program_text(advice)) for advice in (False, True)}

#: What comes with each step: places that are wanted, and whether the action before has failed.
NEWS = st.tuples(st.lists(st.integers(-4, 5), max_size=3), st.booleans())


def solver_of(advice=True, **options):
    return PlanSolver(PROGRAMS[advice], plan_time=0.0, **options)


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
    """The same plan with so many idle steps after the present one: later actions come as much later."""
    later = Plan(frozenset(plan.actions - at(plan, 0, step)), plan.horizon)
    for _ in range(idle):
        later = later.delayed()
    return Plan(later.actions | at(plan, 0, step), plan.horizon + idle)


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples * 2 // 5)
@given(st.booleans(), st.lists(NEWS, min_size=1, max_size=4), st.integers(0, 3), st.none() | st.integers(0, 30))
def test_improved_plans_are_plans_that_leave_past_and_present_alone(advice, news, idle, looks):
    walk, solver, done = Walk(), solver_of(advice), set()
    for wanted, fails in news:
        update = walk.update(wanted, fails, done, None)
        solver.update(update)
        plan = worse(solver.log.plan, walk.step, idle)
        solver.restore(solver.log.adopt(plan))
        key = solver.log.key
        while (result := solver.improve(stop_after(looks))) is not None:
            better = Plan.from_result(result)
            assert better == solver.log.plan
            assert better.horizon < plan.horizon
            assert at(better, 0, walk.step) == at(plan, 0, walk.step)
            assert walk.allows(result.horizon, frozenset(at(better, walk.step, result.horizon)))
            plan = better
        assert solver.log.plan == plan
        assert solver.log.key == key, "nothing is taken but the plan"
        done = at(plan, walk.step, walk.step)
        if looks is None:
            next_step = Walk(walk.step + 1, walk.facts, walk.done | done)
            assert next_step.least(walk.step, plan.horizon) == plan.horizon


# ---- Together with predicted updates ---------------------------------------------------------------------------------

#: Actions fail where something else than their parameter is returned; a robot on a line, or two of them.
LINE = """
#program base. at(0,0).
#program cumulative(t).
#external _request/2. #external _return/3.
{ _action_lib(go,X+1,t); _action_lib(go,X-1,t); _action_lib(rest,now,t) } 1 :- at(X,t-1), wanted(Y,t).
failed(t) :- _action_lib(A,X,t), _return(A,Y,t), X != Y.
moved(t) :- _action_lib(go,X,t), not failed(t).
at(X,t) :- _action_lib(go,X,t), not failed(t).
at(X,t) :- at(X,t-1), not moved(t).
wanted(X,t) :- _request(X,t+1).
wanted(X,t) :- wanted(X,t-1), not at(X,t-1).
#program volatile(t).
:- wanted(X,t), not at(X,t).
#program base.
#show _action_lib/3.
"""
#: Nothing can be done in the first steps.
LATE = LINE + "#program cumulative(t). :- _action_lib(A,X,t), t < 4."
PLACES = tuple(f"{place}" for place in range(-3, 5))
MAIL = tuple(f"goal(office{a},office{b},{{}})" for a in range(1, 5) for b in range(1, 5) if a != b)
GOALS = {"line": PLACES, "late": PLACES, "mailbot": MAIL, **{name: goals for name, (_, goals) in SOUND.items()}}


@lru_cache(maxsize=None)
def program_of(name):
    if name == "mailbot":
        return shipped("mailbot.lp", "office.lp")
    return ReactiveProgram.from_text({"line": LINE, "late": LATE}.get(name) or SOUND[name][0])


def roomy(name, horizon, **options):
    """A solver that finds longer plans than there are, since so many steps are ground before anything is asked."""
    solver = PlanSolver(program_of(name), plan_time=0.0, **options)
    solver.restore(History().with_entries(AcceptedUpdate(None, horizon)))
    return solver


def news(solver, goals=(), fails=False):
    """The update by which the next step begins: what was planned was done, and may have failed; goals may be new."""
    step = solver.step
    done = sorted(at(solver.log.plan, step, step)) if solver.log.plan else []
    told = [parse_atom(f"_return({one.arguments[0]},broken,{step})") if fails else success_of(one) for one in done]
    wanted = [parse_atom(f"_request({goal},{step + 2})") for goal in goals]
    items = (Closed(step, step), *map(commitment, done), *map(fact, [*wanted, *told]), Over(step))
    return StreamUpdate(step + 1, 40, items)


def assert_answer(solver, result):
    """Assert that the result is an answer of the program as a fresh solver grounds it that reads the whole history."""
    fresh = PlanSolver(solver.program, plan_time=0.0)
    fresh.restore(History.parse(solver.log.text()))
    snapshot = fresh.snapshot
    assert snapshot.step == result.step
    grounding = Grounding(solver.program, snapshot, max(result.horizon, snapshot.horizon))
    plan = Plan.from_result(result).actions
    open_actions = grounding.actions(solver.program.first_step, grounding.horizon)
    given = [(one, one in plan) for one in open_actions]
    assert snapshot.min_horizon <= result.horizon
    reply = grounding.ask(Question(result.horizon, result.horizon, given), lambda: False)
    assert reply.satisfiable
    assert Plan.from_atoms(reply.answers[0], result.horizon) == Plan.from_atoms(result.answers[-1], result.horizon)
    assert reply.answers[0] <= result.answers[-1]
    assert snapshot.past is not None or reply.answers[0] == result.answers[-1]


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(GOALS))
@settings(max_examples=settings.default.max_examples // 6)
@given(st.data())
def test_improved_plans_are_answers_after_the_whole_history(name, data):
    """Whatever came since the last search: predicted updates, checkpoints, retired steps."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(solver_module, "LEAST_STEPS", data.draw(st.sampled_from([1, 16])))
        improve_at_random(name, data)


def improve_at_random(name, data):
    solver = roomy(name, data.draw(st.integers(8, 16)), log_limit=data.draw(st.sampled_from([2, 100])))
    draw, known = Random(data.draw(st.integers(0, 10**6))), 0
    for _ in range(data.draw(st.integers(3, 8))):
        goals = []
        if draw.random() < 0.4:
            known += 1
            goals = [draw.choice(GOALS[name]).format(known)]
        result = solver.update(news(solver, goals, fails=draw.random() < 0.1))
        if result.outcome is not SolveOutcome.SATISFIABLE:
            return
        assert_answer(solver, result)
        predicted = solver.log.predicted
        if draw.random() < 0.2:
            solver.checkpoint()
        for looks in draw.sample([3, None, None, None], draw.randint(0, 4)):
            plan = solver.log.plan
            solver.restore(solver.log.adopt(worse(plan, solver.step, draw.randint(0, 2))))
            better = solver.improve(stop_after(looks))
            if better is None:
                solver.restore(solver.log.adopt(plan))
                continue
            event("shorter after a predicted update" if predicted else "shorter")
            assert Plan.from_result(better) == solver.log.plan
            assert_answer(solver, better)


@pytest.mark.parametrize("name", ["line", "mailbot"])
def test_predicted_updates_cost_no_search_after_improvement_and_checkpoint(name, searches):
    solver = roomy(name, 24)
    goals = {"line": ["-3", "6"], "mailbot": ["goal(office4,office1,1)", "goal(office1,office4,2)"]}[name]
    solver.update(StreamUpdate(1, 60, tuple(fact(parse_atom(f"_request({goal},2)")) for goal in goals)))
    solver.restore(solver.log.adopt(worse(solver.log.plan, 1, 3)))
    better = solver.improve()
    assert better.predicted
    solver.checkpoint()
    searches.clear()
    for _ in range(9):
        result = solver.update(news(solver))
        assert solver.log.predicted
        assert_answer(solver, result)
    assert result.answers == better.answers
    assert len(searches) == 9, "those of the comparison"


def test_improving_goes_on_asking_the_same_grounding_after_predicted_updates(monkeypatch):
    built, make = [], Grounding.__init__
    monkeypatch.setattr(Grounding, "__init__", lambda *given, **named: built.append(1) or make(*given, **named))
    solver = roomy("line", 30)
    solver.update(StreamUpdate(1, 60, tuple(fact(parse_atom(f"_request({one},2)")) for one in (-4, 9))))
    for _ in range(3):
        solver.update(news(solver))
        solver.restore(solver.log.adopt(worse(solver.log.plan, solver.step, 1)))
        built.clear()
        assert solver.improve() is not None
        assert built == []
    solver.restore(solver.log.adopt(worse(solver.log.plan, solver.step, 1)))
    past = (Closed(solver.step, solver.step), *map(commitment, at(solver.log.plan, solver.step, solver.step)))
    solver.restore(solver.log.with_entries(AcceptedUpdate(StreamUpdate(items=past), solver.horizon)))
    assert_answer(solver, solver.improve())
    assert len(built) == 2, "anew, as something else was told, and for the comparison"


def test_idle_steps_that_have_passed_stay_idle():
    """Though the grounding was searched before them, and the plan does nothing before they are over."""
    solver = roomy("line", 20)
    result = solver.update(StreamUpdate(1, 40, (fact(parse_atom("_request(3,2)")),)))
    solver.restore(History.parse(solver.log.text()))  # it knows of no answer that the next update might leave as it is
    solver.restore(
        solver.log.adopt(Plan(frozenset(moved(one, 4) for one in Plan.from_result(result).actions), result.horizon + 4))
    )
    predicted = []
    for step in (2, 3):
        solver.update(StreamUpdate(step, 40, (Closed(step - 1, step - 1),)))
        predicted.append(solver.log.predicted)
    assert predicted == [False, True]
    better = solver.improve()
    assert min(map(cycle_of, Plan.from_result(better).actions)) > 3
    assert_answer(solver, better)


#: The robot jumps at 4 unless its return from cycle 2 has come.
JUMPS = (
    LINE.replace("{ _action_lib(go,X+1,t);", "{ _action_lib(jump,X+2,t); _action_lib(go,X+1,t);")
    + """
#program cumulative(t).
at(X,t) :- _action_lib(jump,X,t), not failed(t).
moved(t) :- _action_lib(jump,X,t), not failed(t).
:- _action_lib(jump,X,t), t != 4.
:- _action_lib(jump,X,t), _return(go,Y,t-2).
"""
)


@pytest.mark.parametrize("told", [True, False])
def test_a_shorter_plan_that_returns_since_the_search_exclude_is_refused(told):
    solver = PlanSolver(ReactiveProgram.from_text(JUMPS), plan_time=0.0)
    solver.update(StreamUpdate(1, 40, (fact(parse_atom("_request(6,2)")),)))
    solver.restore(History.parse(solver.log.text()))  # it knows of no answer that the next update might leave as it is
    solver.restore(
        solver.log.adopt(Plan(frozenset(parse_atom(f"_action_lib(go,{place},{place})") for place in range(1, 7)), 6))
    )
    predicted = []
    for _ in range(2):
        update = news(solver)
        if not told:
            kept = [one for one in update.items if one != fact(parse_atom("_return(go,2,2)"))]
            update = StreamUpdate(update.step, update.bound, tuple(kept))
        result = solver.update(update)
        predicted.append(solver.log.predicted)
    assert predicted == [False, True]
    assert result.horizon == 6
    better = solver.improve()
    if told:
        assert better is None
        assert Plan.from_result(result) == solver.log.plan
    else:
        assert better.horizon == 5
        assert_answer(solver, better)


# ---- When there is nothing to try ------------------------------------------------------------------------------------


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


def idling(solver, further=""):
    """The solver with a plan that idles for two steps."""
    solver.update(parse_update(f"#step 1. _request(3,1). {further} #endstep."))
    solver.restore(solver.log.adopt(worse(solver.log.plan, 1, 2)))
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
    solver = idling(PlanSolver(program, plan_time=0.0, **options), further)
    searches.clear()
    assert solver.improve() is None
    assert searches == []
    other = idling(PlanSolver(ReactiveProgram.from_text(program_text() + LOOP), plan_time=0.0))
    assert other.improve() is not None


def test_nothing_is_asked_of_a_plan_that_is_the_shortest(searches):
    solver = PlanSolver(PROGRAMS[True], plan_time=100.0)
    solver.update(parse_update("#step 1. _request(3,1). #endstep."))
    assert solver.log.plan.shortest
    searches.clear()
    assert solver.improve() is None
    assert searches == []


def test_a_solver_that_has_read_the_history_improves_its_plan():
    first, second = idling(solver_of()), solver_of()
    assert second.improve() is None, "it knows of no plan"
    second.restore(History.parse(first.log.text()))
    assert second.improve().horizon < first.log.plan.horizon


# ---- What comes of it ------------------------------------------------------------------------------------------------


def test_a_better_plan_is_the_answer_from_then_on():
    solver = idling(solver_of())
    began = time.perf_counter()
    result = solver.improve()
    seconds = time.perf_counter() - began
    assert (result.outcome, result.step) == (SolveOutcome.SATISFIABLE, 1)
    assert 3 <= result.horizon < 5
    assert (Plan.from_result(result), result.shortest) == (solver.log.plan, False)
    assert 0.0 <= result.statistics.pop("solve") <= seconds
    assert result.statistics == {"ground": 0.0, "needed": 0.0}


def test_all_idle_steps_go_at_once_with_the_first_that_a_window_fills():
    solver = solver_of()
    solver.update(parse_update("#step 1. _request(40,1). #endstep."))
    plan = solver.log.plan
    idle = {one: sum(cycle_of(one) > last for last in (4, 22, 30)) for one in plan.actions}
    solver.restore(
        solver.log.adopt(Plan(frozenset(moved(one, steps) for one, steps in idle.items()), plan.horizon + 3))
    )
    assert solver.improve().horizon == plan.horizon


def test_the_next_update_goes_on_from_the_better_plan():
    solver = solver_of()
    solver.update(parse_update("#step 1. _request(3,1). #endstep."))
    solver.restore(solver.log.adopt(worse(solver.log.plan, 1, 1)))
    better = Plan.from_result(solver.improve())
    (action,) = at(better, 1, 1)
    result = solver.update(StreamUpdate(2, items=parse_update(f"#step 2. :- not {action}. #endstep.").items))
    assert Plan.from_result(result).rest(2).actions == better.rest(2).actions
    assert result.horizon == 3


@pytest.mark.parametrize("looks", [0, 1, 5])
def test_no_question_is_asked_after_a_stop(looks, monkeypatch):
    solver = solver_of()
    solver.update(parse_update("#step 1. _request(5,1). _request(-4,1). #endstep."))
    plan = worse(solver.log.plan, 1, 2)
    solver.restore(solver.log.adopt(plan))
    stop, stopped, ask = stop_after(looks), [], Grounding.ask

    def look():
        stopped.append(stop())
        return stopped[-1]

    def asked(grounding, question, stopped_now):
        assert True not in stopped
        stopped_now()  # a search that is quick never looks, one that is slow does
        return ask(grounding, question, stopped_now)

    monkeypatch.setattr(Grounding, "ask", asked)
    while (result := solver.improve(look)) is not None:
        plan = Plan.from_result(result)
    assert True in stopped
    assert solver.log.plan == plan


def test_a_stop_ends_the_building_of_a_grounding():
    """The next call builds it then."""
    solver = idling(solver_of())
    plan = solver.log.plan
    solver.restore(solver.log.with_entries(AcceptedUpdate(None, 150)))
    looks = count()
    assert solver.improve(lambda: next(looks) >= 2) is None
    assert next(looks) <= 5, "not one for each piece"
    assert solver.log.plan == plan
    assert solver.improve().horizon < plan.horizon


@pytest.mark.parametrize("looks", [0, 1, 2, 3])
def test_stops_leave_the_improvement_to_the_next_call(looks):
    solver = idling(solver_of())
    plan = solver.log.plan
    for _ in range(5):
        assert solver.improve(stop_after(looks)) is None or looks > 1
    while solver.improve() is not None:
        pass
    assert solver.log.plan.horizon < plan.horizon


def test_the_rest_of_a_plan_is_tried_again_after_the_next_update(searches):
    solver = roomy("line", 16)
    solver.update(StreamUpdate(1, 40, tuple(fact(parse_atom(f"_request({one},2)")) for one in (-2, 4))))
    for _ in range(2):
        while solver.improve() is not None:
            pass
        searches.clear()
        assert solver.improve() is None
        assert searches == []
        solver.update(news(solver))
        assert solver.log.predicted


#: Plants in a corridor are watered, the fern before another one.
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
def test_tasks_change_their_order_as_far_as_the_program_allows(later, horizon):
    solver = PlanSolver(ReactiveProgram.from_text(GARDEN.format(later)), plan_time=0.0)
    solver.solve()
    acts = [one.replace(" ", ",") for one in TO_AND_FRO.split("; ")]
    solver.restore(
        solver.log.adopt(Plan(frozenset(parse_atom(f"_action_lib({one},{n})") for n, one in enumerate(acts, 2)), 13))
    )
    while (result := solver.improve()) is not None:
        assert_answer(solver, result)
    assert solver.log.plan.horizon == horizon
