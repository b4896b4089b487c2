"""Atoms of open signatures: answers are independent of the order of grounding, and regrounding is rare."""

from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stream_logs import texts

from rosoclingo.oclingo import ReactiveProgram, ReactiveSolver, parse_update
from rosoclingo.oclingo.solving import reactive_solver

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
def test_regrounding_in_blocks_changes_no_answer(items):
    updates = [f"#step {step} : 2. {text} #endstep." for step, text in items]
    with mock.patch.object(reactive_solver, "BLOCK", 1):
        expected = play(updates)
    assert play(updates) == expected
