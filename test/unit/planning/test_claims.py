"""A program's claim that there is no plan, however many steps it may have: believed as long as nothing is told."""

from itertools import combinations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_atom, parse_update
from rosoclingo.planning.solver import PlanSolver

BOUND = 60

#: Rooms 0 to 4 in a row; the door behind room D is shut from the cycle after it is told, until it is told to be open.
ROW = """
#program base.
room(0..4).
at(0,0).
#program cumulative(t).
#external _request/2. #external _shut/2. #external _opened/2.
wanted(X,t) :- _request(go(X),t+1).
wanted(X,t) :- wanted(X,t-1), not reached(X,t-1), not dropped(X,t).
dropped(X,t) :- _request(cancel(X),t).
reached(X,t) :- wanted(X,t), at(X,t).
shut(D,t) :- _shut(D,t-1).
shut(D,t) :- shut(D,t-1), not _opened(D,t-1).
{ _action_lib(move,R+(-1;1),t) : at(R,t-1) } 1.
:- _action_lib(move,R,t), not room(R).
:- _action_lib(move,R,t), at(S,t-1), shut(D,t), D = (R+S-1)/2.
at(R,t) :- _action_lib(move,R,t).
at(R,t) :- at(R,t-1), not _action_lib(move,S,t) : S = -1..5.
#program volatile(t).
:- wanted(X,t), not reached(X,t).
"""
CLAIM = """
#program cumulative(t).
cut(X,t) :- wanted(X,t), at(R,t-1), shut(D,t), R <= D, D < X.
cut(X,t) :- wanted(X,t), at(R,t-1), shut(D,t), X <= D, D < R.
_steps(#sup,t) :- cut(X,t).
"""
SETTINGS = pytest.mark.parametrize("options", [{}, {"plan_time": 0.0}], ids=["shortest", "soon"])


def solver_of(claims, **options):
    program = ReactiveProgram.from_text(ROW + (CLAIM if claims else ""))
    return PlanSolver(program, **options)


def told(solver, step, facts):
    return solver.update(parse_update(f"#step {step} : {BOUND}. #closed {step - 1}. {facts} #endstep."))


@SETTINGS
def test_it_is_believed_before_many_steps_are_ground(options):
    horizons = []
    for claims in (True, False):
        solver = solver_of(claims, **options)
        result = told(solver, 1, "_request(go(3),2). _shut(1,0).")
        assert result.outcome is SolveOutcome.UNSATISFIABLE
        assert not result.permanent
        assert result.horizon >= 1 + BOUND, "as though all were searched"
        horizons.append(solver.horizon)
    assert horizons[0] < 12
    assert horizons[1] >= 1 + BOUND


@SETTINGS
def test_what_is_told_next_is_judged_anew(options):
    solver = solver_of(True, **options)
    assert told(solver, 1, "_request(go(3),2). _shut(1,0).").outcome is SolveOutcome.UNSATISFIABLE
    assert told(solver, 2, "").outcome is SolveOutcome.UNSATISFIABLE
    opened = told(solver, 3, "_opened(1,2).")
    assert opened.outcome is SolveOutcome.SATISFIABLE
    assert opened.horizon >= 5
    shut_again = told(solver, 4, "_shut(2,3).")
    assert shut_again.outcome is SolveOutcome.UNSATISFIABLE
    assert told(solver, 5, "_request(cancel(3),5).").outcome is SolveOutcome.SATISFIABLE


@SETTINGS
def test_what_was_told_of_a_later_step_counts(options):
    solver = solver_of(True, **options)
    result = told(solver, 1, "_request(go(3),2). _shut(1,0). _opened(1,20).")
    assert result.outcome is SolveOutcome.SATISFIABLE
    assert result.horizon >= 22


FACTS = st.one_of(
    st.builds("_shut({},{})".format, st.integers(0, 3), st.integers(0, 5)),
    st.builds("_opened({},{})".format, st.integers(0, 3), st.integers(0, 8)),
    st.builds("_request(go({}),{})".format, st.integers(0, 4), st.integers(2, 6)),
    st.builds("_request(cancel({}),{})".format, st.integers(0, 4), st.integers(1, 6)),
)
STREAMS = st.lists(st.lists(FACTS, max_size=3, unique=True), min_size=1, max_size=4)


@SETTINGS
@settings(max_examples=settings.default.max_examples // 4)
@given(news=STREAMS)
def test_answers_are_those_without_it(options, news):
    claiming, other = solver_of(True, **options), solver_of(False, **options)
    for step, facts in enumerate(news, 1):
        text = " ".join(f"{fact}." for fact in facts)
        ours, theirs = (told(one, step, text) for one in (claiming, other))
        assert ours.outcome is theirs.outcome
        if not options:
            assert ours.horizon == theirs.horizon


@settings(max_examples=settings.default.max_examples // 8)
@given(news=STREAMS)
def test_what_would_be_is_told_as_without_it(news):
    verdicts = []
    for claims in (True, False):
        solver = solver_of(claims)
        for step, facts in enumerate(news, 1):
            told(solver, step, " ".join(f"{fact}." for fact in facts))
        update = parse_update(f"#step {len(news)} : {BOUND}. #endstep.")
        assumable = frozenset(parse_atom(fact) for facts in news for fact in facts)
        some = [frozenset(few) for count in range(3) for few in combinations(sorted(assumable)[:4], count)]
        verdicts.append([solver.inquire(update, assumable, disabled).satisfiable for disabled in some])
    assert verdicts[0] == verdicts[1]
