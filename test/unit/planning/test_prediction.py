"""Predicted updates: they need no search and get the answer that a search would give."""

import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st
from plain_walk import FAILS, LINE, next_update
from stream_logs import copied
from stream_play import play
from workloads import sized

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, StreamUpdate, commitment, parse_atom, parse_update
from rosoclingo.oclingo.progression.updates import Volatile
from rosoclingo.planning.history import History
from rosoclingo.planning.solver import PlanSolver

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


def asked(solver, text=""):
    """Request place 3 and return the answer."""
    return solver.update(parse_update(f"#step 1 : 20. _request(3,1). {text} #endstep."))


def searched(solver, log, update, demanded=()):
    """Return the shortest answer of a solver that restores ``log`` and searches."""
    other = PlanSolver(solver.program)
    other.restore(copied(log))
    items = (*update.items, Volatile(), *map(commitment, demanded))
    return other.update(StreamUpdate(update.step, update.bound, items))


@pytest.mark.slow
@settings(max_examples=sized(20, 40))
@given(st.sets(st.sampled_from(RULES), max_size=4), NEWS, st.sampled_from([None, 0.0, 5.0]))
def test_predicted_answer_agrees_with_a_search(rules, news, plan_time):
    solver = solver_of(LINE + "".join(sorted(rules)), plan_time=plan_time)
    result = solver.update(StreamUpdate(1, 20))
    for wanted, fails in news:
        if result.outcome is not SolveOutcome.SATISFIABLE:
            return
        requests = [f"_request({place},{solver.step + 1})" for place in wanted]
        before, update = solver.log, next_update(solver, *requests, fails=fails)
        is_predicted = solver.predicts(update)
        result = solver.update(update)
        if is_predicted:
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
    solver = solver_of(LINE + FAILS, plan_time=plan_time)
    first = asked(solver, "_return(go,1).")
    assert (first.horizon, len(first.warnings)) == (3, 1)
    searches.clear()
    for step in (2, 3):
        result = solver.update(next_update(solver))
        assert (result.step, result.horizon, result.answers) == (step, 3, first.answers)
        assert (result.shortest, result.warnings) == (True, ())
        assert result.statistics == dict.fromkeys(first.statistics, 0.0)
        assert (solver.step, solver.snapshot.step) == (step, step)
    assert searches == []
    assert solver.update(next_update(solver)).horizon == 4
    assert searches != []


AS_PLANNED = "#closed 1. :- not _action_lib(go,1,1). _return(go,1,1)."


@pytest.mark.parametrize(
    ("update", "expected"),
    [
        (f"#step 2. {AS_PLANNED}", True),
        ("#step 2. #closed 1. :- not _action_lib(go,1,1).", True),
        (AS_PLANNED, False),
        ("#step 2. :- not _action_lib(go,1,1). _return(go,1,1).", False),
        ("#step 2. #closed 0..1. :- not _action_lib(go,1,1). _return(go,1,1).", False),
        ("#step 2. #closed 1. :- not _action_lib(go,1,1). _return(go,no,1).", False),
        (f"#step 2. {AS_PLANNED} :- not _action_lib(go,2,2).", False),
        (f"#step 2. {AS_PLANNED} #withdraw _action_lib(go,2,2).", False),
        (f"#step 2. {AS_PLANNED} _request(1,2).", False),
        (f"#step 2. {AS_PLANNED} #assert : x.", False),
    ],
)
def test_update_is_predicted_after_a_successful_step(update, expected):
    solver = solver_of(LINE + FAILS)
    for place in (2, 1):
        solver.restore(History())
        play(solver, f"#step 1. _request({place},1).")
        assert solver.predicts(parse_update(f"{update} #endstep.")) is (expected and place == 2), "an action remains"


FAR = "far(t) :- at(-1,t). tired(t) :- far(t-1), _return(go,X,t).\n"


@pytest.mark.sampled(8)
@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("rule", "returns", "certain"),
    [
        ("", 3, 3),
        (FAR, 3, 1),  # at(-1,t) is impossible before step 1
        ("rests(t) :- _return(go,2,t).", 2, 2),
        ("odd(t) :- _return(go,_,t-1), at(3,t-1).", 2, 2),
        (":- not not _return(go,X,t), at(X-4,t).", 3, 1),
        # only the literals of actions in the cycle of the return are certain
        ("odd(t) :- _return(A,V,t), at(V-2,t).", 3, 0),
        ("odd(t) :- _return(A,V,t), not _action_lib(A,V,t), at(V,t).", 3, 3),
        ("odd(t) :- _return(A,V,t), _action_lib(A,V-3,t-1).", 3, 1),
        # declarations and heuristics do not affect answers
        ("#external _return(go,X,t) : at(X,t).", 3, 3),
        ("#heuristic at(X,t) : _return(go,X,t). [1,true]", 3, 3),
        # other uses of returns
        *(
            (rule, 0, 0)
            for rule in (
                "odd(t) :- 1 { _return(A,V,t) : none(A,V) }.",
                "odd(t) :- _return(A,V,t+1), none(V).",
                "odd(t) :- _return((go;come),V,t), none(V).",
                "_return(go,1,t) :- none(t).",
                "#external _return(go,V,t) : _return(go,V,t-1), none(V).",
                "#theory marks { term { - : 1, unary }; &mark/0 : term, any }. odd(t) :- &mark, none(t).",
                "#program base. odd :- _return(go,1,1), none(1).",
                "#show odd(X) : _return(go,X,t), none(X).",
                "#minimize { 1,X,t : none(X,t) }.",
            )
        ),
    ],
)
def test_returns_are_predicted_that_change_no_answer(rule, returns, certain):
    """``none`` never holds, so that only the form of a rule prevents predictions."""
    for plan_time in (5.0, None):
        assert len(asked(solver_of(f"{LINE} {rule}", plan_time=plan_time)).predicted) == certain
    found = asked(solver_of(f"{LINE} {rule}", plan_time=0.0))
    assert len(found.predicted) == (certain if found.shortest else returns)


@pytest.mark.parametrize(
    ("text", "options", "items", "returns"),
    [
        (LINE, {}, "", [1, 2, 3]),
        (LINE, {}, "odd(1) :- _return(go,1,1).", [2, 3]),
        (LINE.replace("#external _return/3.", "#external _return(go,2,t)."), {}, "", [2]),
        (LINE.replace("#show _action_lib/3.", ""), {}, "", []),
    ],
)
def test_returns_are_predicted_for_single_plain_answers(text, options, items, returns):
    result = asked(solver_of(text + FAILS, **options), items)
    assert result.predicted == {parse_atom(f"_return(go,{place},{place})") for place in returns}
