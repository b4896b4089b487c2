"""Atoms of open signatures that are declared with the steps that could use them: same answers, fewer groundings."""

from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stream_logs import texts

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update
from rosoclingo.oclingo.solving import reactive_grounding, transaction

ROBOT = """
#external moved/2. #external seen/2. d(l). d(r).
#cumulative t.
1 { go(D,t) : d(D) } 1.
:- moved(D,t-1), not go(D,t-1), d(D).
hit(t) :- seen(D,t+1), go(D,t), d(D).
more(t) :- moved(D,t), seen(D,t-1), d(D).
#volatile t.
:- not seen(l,t+1), not seen(r,t+1), t > 2.
"""
PROGRAM = ReactiveProgram.from_text(ROBOT)
STATEMENTS = st.builds(
    "{}({},{}){}.".format,
    st.sampled_from(["moved", "seen"]),
    st.sampled_from("lrx"),
    st.integers(-1, 5),
    st.sampled_from(["", " :- go(l,2)", " :- not seen(r,2)"]),
)
SECTIONS = st.sampled_from(["", "#volatile.", "#volatile : 2.", "#assert : a.", "#cumulative.", "#forget 1..3."])
ITEMS = st.lists(st.one_of(STATEMENTS, STATEMENTS, SECTIONS), max_size=4).map(" ".join)


def play(updates):
    solver = ReactiveSolver(PROGRAM, models=0, horizon_limit=8)
    results = [solver.update(parse_update(one)) for one in updates]
    return [(one.outcome, one.horizon, texts(one), one.warnings) for one in results]


@pytest.mark.slow
@given(st.lists(st.tuples(st.integers(0, 3), ITEMS), min_size=1, max_size=5))
def test_answers_are_those_of_a_solver_that_grounds_anew_step_by_step(items):
    updates = [f"#step {step} : 2. {text} #endstep." for step, text in items]
    with mock.patch.object(reactive_grounding, "DOMAIN_LIMIT", -1), mock.patch.object(reactive_grounding, "BLOCK", 1):
        expected = play(updates)
    assert play(updates) == expected


@pytest.fixture
def groundings(monkeypatch):
    made, build = [], transaction.build_grounding

    def built(*args, **options):
        made.append(args)
        return build(*args, **options)

    monkeypatch.setattr(transaction, "build_grounding", built)
    return made


def test_what_a_domain_tells_grounds_nothing_anew(groundings):
    play(["#step 4. seen(l,5). #endstep.", "moved(l,1). seen(r,2). #endstep.", "#step 5. moved(r,3). #endstep."])
    assert len(groundings) == 1


@pytest.mark.parametrize(
    ("text", "told", "follows"),
    [
        ("#external moved/2. #cumulative t. go(D,t) :- moved(D,t).", "moved(x,1).", "go(x,1)"),
        ("#external m/3. d(1..11). #cumulative t. go(A,t) :- m(A,B,t), d(A), d(B).", "m(4,5,1).", "go(4,1)"),
    ],
    ids=["in no domain", "in a large domain"],
)
def test_what_is_not_declared_with_the_steps_grounds_anew(groundings, text, told, follows):
    solver = ReactiveSolver(ReactiveProgram.from_text(text))
    solver.update(parse_update("#step 3. #endstep."))
    assert follows in min(texts(solver.update(parse_update(f"{told} #endstep."))))
    assert len(groundings) == 2


def test_an_atom_is_declared_with_the_first_step_that_could_see_it():
    rules = "a(t) :- s(D,t+1), d(D). b(t) :- s(D,t-1), d(D)."
    solver = ReactiveSolver(ReactiveProgram.from_text("#external s/2. d(l). #cumulative t. " + rules))
    solver.update(parse_update("#step 4. #endstep."))
    assert {"a(1)", "b(3)"} <= min(texts(solver.update(parse_update("s(l,2). #endstep."))))
