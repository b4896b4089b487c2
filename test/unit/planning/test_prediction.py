"""Predicted updates are answered without a search, as a search would have answered them."""

import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, StreamUpdate, commitment, parse_atom
from rosoclingo.oclingo.progression.updates import Assert, Closed, Cumulative, Over, Statement, Volatile, Withdraw
from rosoclingo.planning import solver as solver_module
from rosoclingo.planning.history import History, Plan, cycle_of
from rosoclingo.planning.prediction import is_predicted, success_of
from rosoclingo.planning.solver import PlanSolver

#: A robot on a line of places that goes where it is wanted; what it does with returns follows.
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

#: Rules that ask for returns, in ways that matter and in ways that don't.
RULES = [
    FAILS,
    "rests(t) :- _return(go,1,t).\n:- rests(t-1), _action_lib(go,2,t).\n",
    "rests(t) :- _return(go,X,t), at(X,t-2).\n:- rests(t-1), _action_lib(go,X,t).\n",
    "far(t) :- at(3,t).\nfar(t) :- far(t-1).\ntired(t) :- far(t-1), _return(go,X,t).\n#show tired/1.\n",
    "unsure(t) :- _action_lib(go,X,t), not _return(go,X,t), X = 2.\n#show unsure/1.\n",
    "often(t) :- 1 { _return(go,X,t) : at(X,t) }.\n#show often/1.\n",
    "#show told(X,t) : _return(go,X,t), X > 0.\n",
    "{ _action_lib(call,X,t) } :- at(X,t-1), _return(go,X,t-1).\n",
    ":- _action_lib(go,X,t), _action_lib(go,Y,t-1), X < Y, not _return(go,Y,t-1).\n",
]

#: What comes with each step: places that are wanted, and whether the action before has failed.
NEWS = st.lists(st.tuples(st.lists(st.integers(-3, 4), max_size=1), st.booleans()), min_size=1, max_size=8)


def solver_of(text, **options):
    program = ReactiveProgram.from_text(text)
    return PlanSolver(program, **{"plan_time": 5.0, **options})


def due(solver):
    """The actions that the last plan has for the step of the last update."""
    return {one for one in solver.log.plan.actions if cycle_of(one) == solver.step}


def told(solver, fails=False, wanted=(), bound=20, further=()):
    """The update by which the next step begins."""
    step, done = solver.step, sorted(due(solver))
    values = [parse_atom(f"_return(go,no,{step})") if fails else success_of(action) for action in done]
    items = [commitment(one) for one in done] + [Statement(one) for one in values]
    items += [Statement(parse_atom(f"_request({one},{step + 1})")) for one in wanted]
    return StreamUpdate(step + 1, bound, (Closed(step, step), *items, *further))


def asked(solver):
    return solver.update(StreamUpdate(1, 20, (Statement(parse_atom("_request(3,1)")),)))


def searched(solver, log, update, demanded=()):
    """The shortest answer that a solver finds which reads a ``log`` and searches."""
    other = PlanSolver(solver.program)
    other.restore(History.parse(log.text()))
    items = (*update.items, Volatile(), *map(commitment, demanded))
    return other.update(StreamUpdate(update.step, update.bound, items))


@pytest.mark.once
@pytest.mark.slow
@settings(max_examples=40)
@given(st.sets(st.sampled_from(RULES), max_size=4), NEWS, st.sampled_from([None, 0.0, 5.0]))
def test_the_answer_is_one_that_a_search_finds(rules, news, plan_time):
    solver = solver_of(WALK + "".join(sorted(rules)), plan_time=plan_time)
    result = solver.update(StreamUpdate(1, 20))
    for wanted, fails in news:
        if result.outcome is not SolveOutcome.SATISFIABLE:
            return
        before, update = solver.log, told(solver, fails, wanted)
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
def test_success_takes_no_search_as_long_as_something_is_left_to_do(plan_time, searches):
    solver = solver_of(WALK + FAILS, plan_time=plan_time)
    first = asked(solver)
    assert first.horizon == 3
    searches.clear()
    for step in (2, 3):
        result = solver.update(told(solver))
        assert (result.step, result.horizon, result.answers) == (step, 3, first.answers)
        assert result.shortest
        assert (solver.step, solver.snapshot.step) == (step, step)
        assert solver.log.predicted
    assert searches == []
    assert solver.update(told(solver)).horizon == 4
    assert searches != []
    assert not solver.log.predicted


NOW, THEN = parse_atom("_action_lib(go,1,1)"), parse_atom("_action_lib(go,2,2)")
AS_PLANNED = (Closed(1, 1), commitment(NOW), Statement(success_of(NOW)))


@pytest.mark.parametrize(
    ("step", "items", "expected"),
    [
        (2, AS_PLANNED, True),
        (2, (Over(1), Cumulative(), *AS_PLANNED), True),
        (3, AS_PLANNED, False),
        (None, AS_PLANNED, False),
        (2, AS_PLANNED[:2], True),
        (2, AS_PLANNED[1:], False),
        (2, (Closed(0, 1), *AS_PLANNED), False),
        (2, (AS_PLANNED[0], AS_PLANNED[2]), False),
        (2, (*AS_PLANNED, commitment(THEN)), False),
        (2, (*AS_PLANNED, Statement(success_of(THEN))), False),
        (2, (*AS_PLANNED, Withdraw(THEN)), False),
        (2, (*AS_PLANNED, Statement(success_of(NOW), (commitment(THEN).body[0],))), False),
    ],
)
def test_an_answer_goes_on_where_the_step_was_done_as_planned(step, items, expected):
    plan, predicted = Plan(frozenset([NOW, THEN]), 2), frozenset([success_of(NOW)])
    assert is_predicted(plan, predicted, 1, StreamUpdate(step, None, items)) is expected
    assert not is_predicted(Plan(frozenset([NOW]), 2), predicted, 1, StreamUpdate(step, None, items)), (
        "nothing is left to do"
    )


def test_what_is_not_foreseen_is_searched(searches):
    """A failure, something wanted, and what holds for one update or is asserted."""
    volatile = (Volatile(), Statement(None, (commitment(parse_atom("at(1,1)")).body[0],)))
    cases = [{"fails": True}, {"wanted": [1]}, {"further": volatile}]
    cases.append({"further": (Assert(parse_atom("x")), Statement(parse_atom("_request(3,2)")))})
    for case in cases:
        solver = solver_of(WALK + FAILS)
        asked(solver)
        searches.clear()
        assert solver.update(told(solver, **case)).outcome is SolveOutcome.SATISFIABLE
        assert searches != []


def test_a_log_that_went_on_otherwise_is_searched(searches):
    """The answer is that of the log after which it was given."""
    solver, wanted = solver_of(WALK + FAILS), [parse_atom("_request(3,1)"), parse_atom("_request(-1,1)")]
    both = solver.update(StreamUpdate(1, 20, tuple(map(Statement, wanted))))
    before, update = solver.log, told(solver)
    solver.restore(solver.log.withdraw(frozenset(wanted[1:])))
    searches.clear()
    assert solver.update(update).outcome is SolveOutcome.SATISFIABLE
    assert searches != []
    solver.restore(before)
    assert solver.update(update).answers == both.answers


@pytest.mark.parametrize("options", [{"models": 0}, {"oclingo_strings": True}])
def test_other_solvers_foresee_nothing(options):
    assert asked(solver_of(WALK + FAILS, **options)).predicted == frozenset()


def test_nothing_is_foreseen_of_an_answer_that_lapses():
    items = (Statement(parse_atom("_request(3,1)")), Volatile(), commitment(parse_atom("at(1,1)")))
    assert solver_of(WALK + FAILS).update(StreamUpdate(1, 20, items)).predicted == frozenset()


@pytest.mark.parametrize(
    "text",
    [
        (WALK + FAILS).replace("#show _action_lib/3.", ""),
        WALK + FAILS + "#show _return/3.",
        WALK + FAILS + "#minimize { 1,X,t : at(X,t) }.",
    ],
)
def test_nothing_is_foreseen_where_answers_tell_more_or_less_than_actions(text):
    assert asked(solver_of(text)).predicted == frozenset()


def walked(solver, steps):
    """So many updates that are predicted, each of which lets what lies before it be over."""
    for _ in range(steps):
        solver.update(told(solver, further=[Over(solver.step)]))


def reader_of(solver, **options):
    """Another solver that has read the log as a text."""
    other = solver_of(WALK + FAILS, **options)
    other.restore(History.parse(solver.log.text()))
    return other


def test_a_long_log_of_what_was_foreseen_begins_anew(compacts_at_once, monkeypatch, searches):
    """Who reads it has little to take and to ground, and its answers tell as much of what was done."""
    monkeypatch.setattr(solver_module, "LONG_PREDICTED", 4)
    solver, same = solver_of(WALK + FAILS), solver_of(WALK + FAILS, log_limit=100)
    for one in (solver, same):
        one.update(StreamUpdate(1, 20, (Statement(parse_atom("_request(8,1)")),)))
    walked(solver, 3)
    solver.compact()
    assert solver.log.length == 4, "that is not long"
    walked(solver, 2)
    solver.compact(lambda: True)
    assert solver.log.length == 6, "it was stopped"
    assert reader_of(solver).snapshot.past is None
    solver.compact()
    assert solver.log.length == 0
    searches.clear()
    walked(solver, 1)
    assert searches == [], "what was predicted still is"
    walked(same, 6)
    other = reader_of(solver)
    assert other.snapshot.past.first == 5
    for fails in (True, False, True):
        update = told(solver, fails)
        results = [one.update(update) for one in (solver, other, same)]
        assert len({(one.horizon, one.answers) for one in results}) == 1


def test_a_plan_that_was_improved_is_foreseen(searches):
    """With all returns with which it stays an answer: it is not said to be the shortest."""
    solver = solver_of(WALK + "far(t) :- at(-1,t). tired(t) :- far(t-1), _return(go,X,t).")
    assert len(asked(solver).predicted) == 1
    plan = solver.log.plan
    last = max(plan.actions, key=cycle_of)
    solver.restore(solver.log.adopt(Plan(plan.actions - {last} | {parse_atom("_action_lib(go,3,5)")}, 5)))
    better = solver.improve()
    assert Plan.from_result(better).actions == plan.actions
    assert better.predicted == {success_of(action) for action in plan.actions}
    searches.clear()
    result = solver.update(told(solver))
    assert (result.answers, result.shortest) == (better.answers, False)
    assert searches == []


def test_what_is_answered_without_a_search_took_no_time_and_warns_of_nothing():
    solver = solver_of(WALK + FAILS)
    items = tuple(Statement(parse_atom(text)) for text in ("_request(3,1)", "_return(go,1)"))
    first = solver.update(StreamUpdate(1, 20, items))
    assert len(first.warnings) == 1
    result = solver.update(told(solver))
    assert solver.log.predicted
    assert result.warnings == ()
    assert result.statistics == dict.fromkeys(first.statistics, 0.0)


def test_returns_that_the_program_does_not_take_are_not_foreseen():
    text = (WALK + FAILS).replace("#external _return/3.", "#external _return(go,2,t).")
    assert asked(solver_of(text)).predicted == {parse_atom("_return(go,2,2)")}


def test_after_a_shortest_plan_uncertain_returns_take_a_search(searches):
    """A shorter plan may come in with them."""
    solver = solver_of(WALK + "far(t) :- at(-1,t). tired(t) :- far(t-1), _return(go,X,t).", plan_time=None)
    asked(solver)
    predicted = []
    for _ in range(2):
        assert solver.update(told(solver)).shortest
        predicted.append(solver.log.predicted)
    assert predicted == [True, False]


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("rule", "returns", "certain"),
    [
        ("", 3, 3),
        (FAILS, 3, 3),
        ("far(t) :- at(-1,t). tired(t) :- far(t-1), _return(go,X,t).\n", 3, 1),  # nobody is so far before step 1
        ("tired(t) :- far(t-1), _return(go,X,t).\n", 3, 3),
        ("rests(t) :- _return(go,2,t).\n", 2, 2),
        ("odd(t) :- not _return(go,2,t), at(2,t).\n", 2, 2),
        ("odd(t) :- _return(go,_,t-1), at(3,t-1).\n", 2, 2),
        ("often(t) :- 1 { _return(go,X,t) : at(X,t) }.\n", 0, 0),
        ("#show told(X,t) : _return(go,X,t).\n", 0, 0),
    ],
)
def test_which_returns_of_a_plan_are_foreseen(rule, returns, certain):
    assert len(asked(solver_of(WALK + rule)).predicted) == certain
    assert len(asked(solver_of(WALK + rule, plan_time=None)).predicted) == certain
    found = asked(solver_of(WALK + rule, plan_time=0.0))
    assert len(found.predicted) == (certain if found.shortest else returns)


def test_what_the_stream_asks_for_is_not_foreseen():
    solver, told_first = solver_of(WALK + FAILS), parse_atom("_return(go,1,1)")
    assert told_first in asked(solver).predicted
    rule = Statement(parse_atom("odd(1)"), (commitment(told_first).body[0],))
    solver = solver_of(WALK + FAILS)
    result = solver.update(StreamUpdate(1, 20, (Statement(parse_atom("_request(3,1)")), rule)))
    assert told_first not in result.predicted
    assert len(result.predicted) == 2
