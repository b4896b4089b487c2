"""Improving plans: actions up to the present step stay, and a stop at any time leaves a valid plan."""

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
from rosoclingo.oclingo.progression.updates import CloseCycles, Expire
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import AcceptedUpdate, History, Plan, cycle_of
from rosoclingo.planning.prediction import success_of
from rosoclingo.planning.question import Question
from rosoclingo.planning.solver import PlanSolver

pytestmark = pytest.mark.usefixtures("reorder_effort")

PROGRAMS = {advice: ReactiveProgram.from_text(program_text(advice)) for advice in (False, True)}

#: For each step: requested places, and whether the previous action has failed.
NEWS = st.tuples(st.lists(st.integers(-4, 5), max_size=3), st.booleans())


def solver_of(advice=True, **options):
    return PlanSolver(PROGRAMS[advice], plan_time=0.0, **options)


def stop_after(looks):
    """Return a stop callback that returns true after ``looks`` polls (None: never)."""
    numbers = count()
    return lambda: looks is not None and next(numbers) >= looks


def at(plan, first, last):
    return {one for one in plan.actions if first <= cycle_of(one) <= last}


def moved(action, steps):
    kind, what, cycle = action.arguments
    return parse_atom(f"_action_lib({kind},{what},{cycle.number + steps})")


def adopt(solver, actions, horizon):
    """Let the solver adopt a plan of these actions (atoms or texts), not proven to be shortest."""
    plan = Plan(frozenset(parse_atom(one) if isinstance(one, str) else one for one in actions), horizon)
    solver.restore(solver.log.adopt(plan))
    return plan


def idle(solver, steps):
    """Let the solver adopt its plan with all future actions delayed by ``steps``."""
    plan, step = solver.log.plan, solver.step
    actions = [one if cycle_of(one) <= step else moved(one, steps) for one in plan.actions]
    return adopt(solver, actions, plan.horizon + steps)


def improve_fully(solver):
    while solver.improve() is not None:
        pass


@pytest.mark.slow
@settings(max_examples=settings.default.max_examples // 4)
@given(st.booleans(), st.lists(NEWS, min_size=1, max_size=4), st.integers(0, 3), st.none() | st.integers(0, 30))
def test_improve_keeps_actions_up_to_the_present(advice, news, steps, looks):
    walk, solver, done = Walk(), solver_of(advice), set()
    for wanted, fails in news:
        solver.update(walk.update(wanted, fails, done, None))
        plan = idle(solver, steps)
        key = solver.log.key
        while (result := solver.improve(stop_after(looks))) is not None:
            better = Plan.from_result(result)
            assert better == solver.log.plan
            assert better.horizon < plan.horizon
            assert at(better, 0, walk.step) == at(plan, 0, walk.step)
            assert walk.allows(result.horizon, frozenset(at(better, walk.step, result.horizon)))
            plan = better
        assert solver.log.plan == plan
        assert solver.log.key == key, "only the plan is appended"
        done = at(plan, walk.step, walk.step)
        if looks is None:
            next_step = Walk(walk.step + 1, walk.facts, walk.done | done)
            assert next_step.least(walk.step, plan.horizon) == plan.horizon


# ---- Together with predicted updates ---------------------------------------------------------------------------------

#: A robot on a line whose actions fail if they return anything except their parameter.
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
#: The first steps have no action.
LATE = LINE + "#program cumulative(t). :- _action_lib(A,X,t), t < 4."
PLACES = tuple(f"{place}" for place in range(-3, 5))
MAIL = tuple(f"goal(office{a},office{b},{{}})" for a in range(1, 5) for b in range(1, 5) if a != b)
GOALS = {"line": PLACES, "late": PLACES, "mailbot": MAIL, **{name: goals for name, (_, goals) in SOUND.items()}}


@lru_cache(maxsize=None)
def program_of(name):
    if name == "mailbot":
        return shipped("mailbot.lp", "office.lp")
    return ReactiveProgram.from_text({"line": LINE, "late": LATE}.get(name) or SOUND[name][0])


def with_horizon(name, horizon, requests=(), **options):
    """Return a solver that finds long plans, as its first grounding has ``horizon`` steps; it has some requests."""
    solver = PlanSolver(program_of(name), plan_time=0.0, **options)
    solver.restore(History().with_entries(AcceptedUpdate(None, horizon)))
    if requests:
        solver.update(StreamUpdate(1, 60, tuple(fact(parse_atom(f"_request({one},2)")) for one in requests)))
    return solver


def news(solver, goals=(), fails=False):
    """Return the update of the next step, with executed or failed actions and new goals."""
    step = solver.step
    done = sorted(at(solver.log.plan, step, step)) if solver.log.plan else []
    returns = [parse_atom(f"_return({one.arguments[0]},broken,{step})") if fails else success_of(one) for one in done]
    wanted = [parse_atom(f"_request({goal},{step + 2})") for goal in goals]
    items = (CloseCycles(step, step), *map(commitment, done), *map(fact, [*wanted, *returns]), Expire(step))
    return StreamUpdate(step + 1, 40, items)


def assert_answer(solver, result):
    """Check that a grounding of the whole history in a new solver has the result as an answer."""
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
def test_improve_respects_the_whole_history(name, data):
    """After any predicted updates, checkpoints and compaction since the last search."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(solver_module, "LEAST_STEPS", data.draw(st.sampled_from([1, 16])))
        improve_at_random(name, data)


def improve_at_random(name, data):
    solver = with_horizon(name, data.draw(st.integers(8, 16)), log_limit=data.draw(st.sampled_from([2, 100])))
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
            idle(solver, draw.randint(0, 2))
            better = solver.improve(stop_after(looks))
            if better is None:
                solver.restore(solver.log.adopt(plan))
                continue
            event("shorter after a predicted update" if predicted else "shorter")
            assert Plan.from_result(better) == solver.log.plan
            assert_answer(solver, better)


def test_predicted_updates_after_improve_need_no_search(searches):
    solver = with_horizon("line", 24, [-3, 6])
    idle(solver, 3)
    better = solver.improve()
    assert better.predicted
    solver.checkpoint()
    searches.clear()
    for _ in range(9):
        result = solver.update(news(solver))
        assert solver.log.predicted
        assert_answer(solver, result)
    assert result.answers == better.answers
    assert len(searches) == 9, "only the comparisons search"


def reread(solver):
    """Let the solver forget its answer, so that the next update is not predicted."""
    solver.restore(History.parse(solver.log.text()))


def test_improve_keeps_past_idle_steps_idle():
    """Although the last search was before these steps and the plan idles in them."""
    solver = with_horizon("line", 20, [3])
    reread(solver)
    plan = solver.log.plan
    adopt(solver, [moved(one, 4) for one in plan.actions], plan.horizon + 4)
    predicted = []
    for step in (2, 3):
        solver.update(StreamUpdate(step, 40, (CloseCycles(step - 1, step - 1),)))
        predicted.append(solver.log.predicted)
    assert predicted == [False, True]
    better = solver.improve()
    assert min(map(cycle_of, Plan.from_result(better).actions)) > 3
    assert_answer(solver, better)


#: The robot can jump at 4 unless there is a return of cycle 2.
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


@pytest.mark.parametrize("returns", [True, False])
def test_improve_refuses_plans_that_returns_exclude(returns):
    """The returns arrived after the last search."""
    solver = PlanSolver(ReactiveProgram.from_text(JUMPS), plan_time=0.0)
    solver.update(StreamUpdate(1, 40, (fact(parse_atom("_request(6,2)")),)))
    reread(solver)
    adopt(solver, [f"_action_lib(go,{place},{place})" for place in range(1, 7)], 6)
    predicted = []
    for _ in range(2):
        update = news(solver)
        lost = () if returns else (fact(parse_atom("_return(go,2,2)")),)
        result = solver.update(StreamUpdate(update.step, 40, tuple(one for one in update.items if one not in lost)))
        predicted.append(solver.log.predicted)
    assert predicted == [False, True]
    assert result.horizon == 6
    better = solver.improve()
    if returns:
        assert better is None
        assert Plan.from_result(result) == solver.log.plan
    else:
        assert better.horizon == 5
        assert_answer(solver, better)


# ---- Without anything to try -----------------------------------------------------------------------------------------


def requested(further="", text="", steps=2, **options):
    """Return a solver with a plan that idles for ``steps`` steps."""
    program = ReactiveProgram.from_text(program_text() + text) if text else PROGRAMS[True]
    solver = PlanSolver(program, **{"plan_time": 0.0, **options})
    solver.update(parse_update(f"#step 1. _request(3,1). {further} #endstep."))
    if steps:
        idle(solver, steps)
    return solver


LOOP = "#program cumulative(t). #external e(t). c(t) :- e(t)."


@pytest.mark.parametrize(
    "options",
    [
        {"models": 0},
        {"text": LOOP, "further": "e(1) :- c(1)."},
        {"plan_time": 100.0, "steps": 0},
    ],
    ids=["many answers", "regrounding for a loop", "the shortest plan"],
)
def test_improve_leaves_plans_it_cannot_shorten(options, searches):
    solver = requested(**options)
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
@pytest.mark.parametrize("walls", [1, 4, 8])
@pytest.mark.parametrize("steps", [0, 2])
def test_improve_lowers_the_cost_of_optimizing_programs(walls, steps):
    """Down to the optimum, which a search without a limit proves; running actions stay."""
    program = ReactiveProgram.from_text(PAINT)
    wanted = " ".join(f"_request(paint({wall},{wall}),2)." for wall in range(1, walls + 1))
    solver = PlanSolver(program, plan_time=0.0)
    solver.update(parse_update(f"#step 1. {wanted} #endstep."))
    adopt(solver, [f"_action_lib(paint,wall({wall},2),{wall})" for wall in range(1, walls + 1)], walls)
    if steps:
        idle(solver, steps)
    plan = solver.log.plan
    while (result := solver.improve()) is not None:
        better = Plan.from_result(result)
        assert (better.horizon, price(better)) < (plan.horizon, price(plan))
        assert at(better, 1, 1) == at(plan, 1, 1)
        plan = better
    (first,) = at(plan, 1, 1)
    best = PlanSolver(program).update(parse_update(f"#step 1. {wanted} :- not {first}. #endstep."))
    assert best.shortest
    assert (plan.horizon, price(plan)) == (best.horizon, price(Plan.from_result(best)))


def test_improve_continues_its_trials_after_an_update(searches):
    solver = with_horizon("line", 16, [-2, 4])
    for _ in range(2):
        improve_fully(solver)
        searches.clear()
        assert solver.improve() is None
        assert searches == []
        solver.update(news(solver))
        assert solver.log.predicted


# ---- Results ---------------------------------------------------------------------------------------------------------


def test_improved_plan_replaces_the_previous_answer():
    solver, reader = requested(text=LOOP), solver_of()
    began = time.perf_counter()
    result = solver.improve()
    seconds = time.perf_counter() - began
    assert (result.outcome, result.step) == (SolveOutcome.SATISFIABLE, 1)
    assert 3 <= result.horizon < 5
    assert (Plan.from_result(result), result.shortest) == (solver.log.plan, False)
    assert 0.0 <= result.statistics.pop("solve") <= seconds
    assert result.statistics == {"ground": 0.0, "needed": 0.0}
    assert reader.improve() is None, "there is no plan to improve"
    reader.restore(History.parse(requested().log.text()))
    assert reader.improve().horizon < 5
    improve_fully(solver)
    better = solver.log.plan
    (action,) = at(better, 1, 1)
    later = solver.update(parse_update(f"#step 2. :- not {action}. #endstep."))
    assert (Plan.from_result(later).rest(2).actions, later.horizon) == (better.rest(2).actions, 3)


@pytest.mark.slow
@pytest.mark.once
def test_improve_removes_all_idle_steps_at_once():
    solver = solver_of()
    solver.update(parse_update("#step 1. _request(40,1). #endstep."))
    plan = solver.log.plan
    gaps = {one: sum(cycle_of(one) > last for last in (4, 22, 30)) for one in plan.actions}
    adopt(solver, [moved(one, steps) for one, steps in gaps.items()], plan.horizon + 3)
    assert solver.improve().horizon == plan.horizon
    improve_fully(solver)


# ---- Stops -----------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("looks", [0, 1, 2, 3, 5])
def test_improve_asks_no_question_after_a_stop(looks, monkeypatch):
    """The next call continues the improvement."""
    solver = requested("_request(-4,1).")
    plan, stop, stopped, ask = solver.log.plan, stop_after(looks), [], Grounding.ask

    def look():
        stopped.append(stop())
        return stopped[-1]

    def asked(grounding, question, stopped_now):
        assert True not in stopped
        stopped_now()  # emulate a slow search: a quick one would not poll the stop
        return ask(grounding, question, stopped_now)

    with monkeypatch.context() as patched:
        patched.setattr(Grounding, "ask", asked)
        while (result := solver.improve(look)) is not None:
            plan = Plan.from_result(result)
    assert True in stopped
    assert solver.log.plan == plan
    improve_fully(solver)
    assert solver.log.plan.horizon == 10


@pytest.mark.slow
@pytest.mark.once
def test_improve_stopped_while_grounding_continues_later():
    solver = requested()
    plan = solver.log.plan
    solver.restore(solver.log.with_entries(AcceptedUpdate(None, 150)))
    looks = count()
    assert solver.improve(lambda: next(looks) >= 2) is None
    assert next(looks) <= 5, "it does not continue piece by piece"
    assert solver.log.plan == plan
    assert solver.improve().horizon < plan.horizon


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
    solver = PlanSolver(ReactiveProgram.from_text(GARDEN.format(later)), plan_time=0.0)
    solver.restore(History().with_entries(AcceptedUpdate(None, 13)))
    acts = [one.replace(" ", ",") for one in TO_AND_FRO.split("; ")]
    adopt(solver, [f"_action_lib({one},{cycle})" for cycle, one in enumerate(acts, 2)], 13)
    while (result := solver.improve()) is not None:
        assert_answer(solver, result)
    assert solver.log.plan.horizon == horizon
