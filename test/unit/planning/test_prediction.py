"""Predicted updates: they need no search and get the answer that a search would give."""

import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, StreamUpdate, commitment, parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import (
    Assert,
    CloseCycles,
    Cumulative,
    Expire,
    Statement,
    Volatile,
    Withdraw,
)
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.history import History, Plan, cycle_of
from rosoclingo.planning.prediction import is_predicted, success_of
from rosoclingo.planning.solver import PlanSolver

#: A robot on a line that goes to requested places; rules about returns follow.
WALK = """
#program base.
at(0,0).
#program cumulative(t).
#external _request/2. #external _return/3.
{ _action_lib(go,X+1,t); _action_lib(go,X-1,t) } 1 :- at(X,t-1), wanted(Y,t).
at(X,t) :- _action_lib(go,X,t), not failed(t).
at(X,t) :- at(X,t-1), not moved(t).
moved(t) :- _action_lib(go,X,t), not failed(t).
wanted(X,t) :- _request(X,t).
wanted(X,t) :- wanted(X,t-1), not at(X,t-1).
#program volatile(t).
:- wanted(X,t), not at(X,t).
#program base.
#show _action_lib/3.
#program cumulative(t).
"""
FAILS = "failed(t) :- _action_lib(go,X,t), _return(go,Y,t), X != Y.\n"

#: Rules about returns, some of which affect answers.
RULES = [
    FAILS,
    "rests(t) :- _return(go,1,t).\n:- rests(t-1), _action_lib(go,2,t).\n",
    "rests(t) :- _return(go,X,t), at(X,t-2).\n:- rests(t-1), _action_lib(go,X,t).\n",
    "far(t) :- at(3,t).\nfar(t) :- far(t-1).\ntired(t) :- far(t-1), _return(go,X,t).\n#show tired/1.\n",
    "unsure(t) :- _action_lib(go,X,t), not _return(go,X,t), X = 2.\n#show unsure/1.\n",
    "often(t) :- 1 { _return(go,X,t) : at(X,t) }.\n#show often/1.\n",
    "#show seen(X,t) : _return(go,X,t), X > 0.\n",
    "{ _action_lib(call,X,t) } :- at(X,t-1), _return(go,X,t-1).\n",
    ":- _action_lib(go,X,t), _action_lib(go,Y,t-1), X < Y, not _return(go,Y,t-1).\n",
]

#: For each step: requested places, and whether the previous action has failed.
NEWS = st.lists(st.tuples(st.lists(st.integers(-3, 4), max_size=1), st.booleans()), min_size=1, max_size=8)


def solver_of(text, **options):
    program = ReactiveProgram.from_text(text)
    return PlanSolver(program, **{"plan_time": 5.0, **options})


def due(solver):
    """Return the actions of the last plan at the step of the last update."""
    return {one for one in solver.log.plan.actions if cycle_of(one) == solver.step}


def next_update(solver, fails=False, wanted=(), bound=20, further=()):
    """Return the update of the next step: planned actions were executed, with success or failure."""
    step, done = solver.step, sorted(due(solver))
    values = [parse_atom(f"_return(go,no,{step})") if fails else success_of(action) for action in done]
    items = [commitment(one) for one in done] + [Statement(one) for one in values]
    items += [Statement(parse_atom(f"_request({one},{step + 1})")) for one in wanted]
    return StreamUpdate(step + 1, bound, (CloseCycles(step, step), *items, *further))


def statements(*texts):
    return tuple(Statement(parse_atom(text)) for text in texts)


def asked(solver, *items):
    """Request place 3 and return the answer."""
    return solver.update(StreamUpdate(1, 20, (*statements("_request(3,1)"), *items)))


def searched(solver, log, update, demanded=()):
    """Return the shortest answer of a solver that restores ``log`` and searches."""
    other = PlanSolver(solver.program)
    other.restore(History.parse(log.text()))
    items = (*update.items, Volatile(), *map(commitment, demanded))
    return other.update(StreamUpdate(update.step, update.bound, items))


@pytest.mark.once
@pytest.mark.slow
@settings(max_examples=40)
@given(st.sets(st.sampled_from(RULES), max_size=4), NEWS, st.sampled_from([None, 0.0, 5.0]))
def test_predicted_answer_agrees_with_a_search(rules, news, plan_time):
    solver = solver_of(WALK + "".join(sorted(rules)), plan_time=plan_time)
    result = solver.update(StreamUpdate(1, 20))
    for wanted, fails in news:
        if result.outcome is not SolveOutcome.SATISFIABLE:
            return
        before, update = solver.log, next_update(solver, fails, wanted)
        result = solver.update(update)
        if solver.log.predicted:
            event("predicted")
            rest = solver.log.plan.rest(update.step).actions
            found = searched(solver, before, update, rest)
            assert found.outcome is SolveOutcome.SATISFIABLE
            assert found.horizon <= result.horizon
            assert found.answers[0] == result.answers[0]
            if result.shortest:
                assert searched(solver, before, update).horizon == result.horizon


@pytest.mark.parametrize("plan_time", [None, 5.0])
def test_success_needs_no_search_while_actions_remain(plan_time, searches):
    solver = solver_of(WALK + FAILS, plan_time=plan_time)
    first = asked(solver, *statements("_return(go,1)"))
    assert (first.horizon, len(first.warnings)) == (3, 1)
    searches.clear()
    for step in (2, 3):
        result = solver.update(next_update(solver))
        assert (result.step, result.horizon, result.answers) == (step, 3, first.answers)
        assert (result.shortest, result.warnings) == (True, ())
        assert result.statistics == dict.fromkeys(first.statistics, 0.0)
        assert (solver.step, solver.snapshot.step) == (step, step)
        assert solver.log.predicted
    assert searches == []
    assert solver.update(next_update(solver)).horizon == 4
    assert searches != []
    assert not solver.log.predicted


NOW, THEN = parse_atom("_action_lib(go,1,1)"), parse_atom("_action_lib(go,2,2)")
AS_PLANNED = (CloseCycles(1, 1), commitment(NOW), Statement(success_of(NOW)))


@pytest.mark.parametrize(
    ("step", "items", "expected"),
    [
        (2, AS_PLANNED, True),
        (2, (Expire(1), Cumulative(), *AS_PLANNED), True),
        (3, AS_PLANNED, False),
        (None, AS_PLANNED, False),
        (2, AS_PLANNED[:2], True),
        (2, AS_PLANNED[1:], False),
        (2, (CloseCycles(0, 1), *AS_PLANNED), False),
        (2, (AS_PLANNED[0], AS_PLANNED[2]), False),
        (2, (*AS_PLANNED, commitment(THEN)), False),
        (2, (*AS_PLANNED, Statement(success_of(THEN))), False),
        (2, (*AS_PLANNED, Withdraw(THEN)), False),
        (2, (*AS_PLANNED, Statement(success_of(NOW), (commitment(THEN).body[0],))), False),
        (2, (*AS_PLANNED[:2], Statement(parse_atom("_return(go,no,1)"))), False),
        (2, (*AS_PLANNED, Statement(parse_atom("_request(1,2)"))), False),
        (2, (*AS_PLANNED, Volatile(), Statement(None, commitment(THEN).body)), False),
        (2, (*AS_PLANNED, Assert(parse_atom("x"))), False),
    ],
)
def test_update_is_predicted_after_a_successful_step(step, items, expected):
    plan, returns = Plan(frozenset([NOW, THEN]), 2), frozenset([success_of(NOW)])
    assert is_predicted(plan, returns, 1, StreamUpdate(step, None, items)) is expected
    assert not is_predicted(Plan(frozenset([NOW]), 2), returns, 1, StreamUpdate(step, None, items)), "no action remains"


def test_prediction_belongs_to_one_history(searches):
    solver = solver_of(WALK + FAILS)
    both = asked(solver, *statements("_request(-1,1)"))
    before, update = solver.log, next_update(solver)
    solver.restore(solver.log.withdraw(frozenset([parse_atom("_request(-1,1)")])))
    searches.clear()
    assert solver.update(update).outcome is SolveOutcome.SATISFIABLE
    assert searches != []
    solver.restore(before)
    assert solver.update(update).answers == both.answers


FAR = "far(t) :- at(-1,t). tired(t) :- far(t-1), _return(go,X,t).\n"


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("rule", "returns", "certain"),
    [
        ("", 3, 3),
        (FAILS, 3, 3),
        (FAR, 3, 1),  # at(-1,t) is impossible before step 1
        ("tired(t) :- far(t-1), _return(go,X,t).\n", 3, 3),
        ("rests(t) :- _return(go,2,t).\n", 2, 2),
        ("odd(t) :- not _return(go,2,t), at(2,t).\n", 2, 2),
        ("odd(t) :- _return(go,_,t-1), at(3,t-1).\n", 2, 2),
        ("often(t) :- 1 { _return(go,X,t) : at(X,t) }.\n", 0, 0),
        ("#show seen(X,t) : _return(go,X,t).\n", 0, 0),
        ("#show _return/3.\n", 0, 0),
        ("#minimize { 1,X,t : at(X,t) }.\n", 0, 0),
    ],
)
def test_returns_are_predicted_that_change_no_answer(rule, returns, certain):
    for plan_time in (5.0, None):
        assert len(asked(solver_of(WALK + rule, plan_time=plan_time)).predicted) == certain
    found = asked(solver_of(WALK + rule, plan_time=0.0))
    assert len(found.predicted) == (certain if found.shortest else returns)


@pytest.mark.parametrize(
    ("text", "options", "items", "returns"),
    [
        (WALK, {}, "", [1, 2, 3]),
        (WALK, {"models": 0}, "", []),
        (WALK, {}, "#volatile. :- not at(1,1).", []),
        (WALK, {}, "odd(1) :- _return(go,1,1).", [2, 3]),
        (WALK.replace("#external _return/3.", "#external _return(go,2,t)."), {}, "", [2]),
        (WALK.replace("#show _action_lib/3.", ""), {}, "", []),
    ],
)
def test_returns_are_predicted_for_single_plain_answers(text, options, items, returns):
    result = asked(solver_of(text + FAILS, **options), *parse_update(f"{items} #endstep.").items)
    assert result.predicted == {parse_atom(f"_return(go,{place},{place})") for place in returns}


def test_uncertain_returns_after_a_shortest_plan_are_searched(searches):
    """They can permit a shorter plan."""
    solver = solver_of(WALK + FAR, plan_time=None)
    asked(solver)
    predicted = []
    for _ in range(2):
        assert solver.update(next_update(solver)).shortest
        predicted.append(solver.log.predicted)
    assert predicted == [True, False]


def test_improved_plan_predicts_uncertain_returns_too(searches):
    solver = solver_of(WALK + FAR)
    assert len(asked(solver).predicted) == 1
    plan = solver.log.plan
    last = max(plan.actions, key=cycle_of)
    solver.restore(solver.log.adopt(Plan(plan.actions - {last} | {parse_atom("_action_lib(go,3,5)")}, 5)))
    better = solver.improve()
    assert Plan.from_result(better).actions == plan.actions
    assert better.predicted == {success_of(action) for action in plan.actions}
    searches.clear()
    result = solver.update(next_update(solver))
    assert (result.answers, result.shortest) == (better.answers, False)
    assert searches == []


def test_long_history_of_predicted_updates_is_compacted(compacts_at_once, monkeypatch, searches):
    """A reader grounds few steps, and its answers show the same executed actions."""
    monkeypatch.setattr(solver_module, "LONG_PREDICTED", 4)

    def walk(solver, steps):
        for _ in range(steps):
            solver.update(next_update(solver, further=[Expire(solver.step)]))

    def reader_of(solver):
        other = solver_of(WALK + FAILS)
        other.restore(History.parse(solver.log.text()))
        return other

    solver, same = solver_of(WALK + FAILS), solver_of(WALK + FAILS, log_limit=100)
    for one in (solver, same):
        one.update(StreamUpdate(1, 20, statements("_request(8,1)")))
    searches.clear()
    walk(solver, 3)
    solver.compact()
    assert solver.log.length == 4, "the history is still short"
    walk(solver, 2)
    solver.compact(lambda: True)
    assert solver.log.length == 6, "compaction was stopped"
    assert reader_of(solver).snapshot.past is None
    assert searches == []
    solver.compact()
    assert solver.log.length == 0
    assert len(searches) == 1, "one search for the predicted answer, with all actions assumed"
    walk(solver, 1)
    assert len(searches) == 1, "the next update is still predicted"
    walk(same, 6)
    other = reader_of(solver)
    assert other.snapshot.past.first == 5
    for fails in (True, False, True):
        update = next_update(solver, fails)
        results = [one.update(update) for one in (solver, other, same)]
        assert len({(one.horizon, one.answers) for one in results}) == 1
