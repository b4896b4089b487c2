"""Closed steps: how little is ground of them, and that the answers stay the same."""

from collections import Counter
from dataclasses import replace
from unittest import mock

import pytest
from hypothesis import given
from hypothesis import strategies as st
from stream_play import planner_of, play

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.planning import grounding
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.solver import PlanSolver

WALK = """
place(1..9). at(5,0).
#external _request/2. #external _wet/2.
#cumulative t.
#external seen(t).
{ _action_lib(go,(A-1;A+1),t) } 1 :- at(A,t-1), not _wet(A,t).
gone(t) :- _action_lib(go,B,t).
at(B,t) :- _action_lib(go,B,t), place(B).
at(A,t) :- at(A,t-1), not gone(t).
been(A,t) :- at(A,t), seen(t).
been(A,t) :- been(A,t-1).
wanted(A,t) :- _request(A,t).
wanted(A,t) :- wanted(A,t-1), not at(A,t-1).
#volatile t.
:- wanted(A,t), not at(A,t).
"""


def walk(solver, places, told=(), bound=20):
    """Be in one of the ``places`` after the other, from cycle 0 on; be told something with each update."""
    for step, (here, place) in enumerate(zip(places, places[1:]), 2):
        done = f":- not _action_lib(go,{place},{step - 1}). " if place != here else ""
        play(
            solver,
            f"#step {step} : {bound}. #closed {step - 1}..{step - 1}. {done}" + " ".join(told[step - 2 : step - 1]),
        )


PROGRAM = ReactiveProgram.from_text(WALK)


def places_of(grounding):
    """In how many places the robot may be after each cycle."""
    return Counter(atom.arguments[1].number for atom in grounding.possible_atoms if atom.name == "at")


def test_closed_steps_are_ground_with_what_has_become_of_them(monkeypatch):
    """In cycle t the robot might have been in t places; it is known in which one it was."""
    monkeypatch.setattr(grounding, "CLOSED_PIECE", 1)
    solver = PlanSolver(PROGRAM)
    walk(solver, [5, 6, 7, 8, 7, 6, 5, 4])
    play(solver, "#step 9 : 20. #closed 8..8. _request(2,8).")
    places = places_of(Grounding(PROGRAM, solver.snapshot, 10))
    assert {cycle: places[cycle] for cycle in range(9)} == dict.fromkeys(range(9), 1)
    assert places[10] > 1


@pytest.mark.parametrize("text", ["p(X) :- _wet(X,t).", "p(t-1) :- _wet(1,t). p(t) :- _wet(2,t)."])
def test_steps_that_define_the_same_atom_are_ground_together(text, monkeypatch):
    """clingo refuses to define an atom again after a search."""
    monkeypatch.setattr(grounding, "CLOSED_PIECE", 1)
    solver = planner_of(f"{WALK} #cumulative t. {text}")
    walk(solver, [5, 5, 5, 5])
    play(solver, "#step 5 : 20. #closed 4..4. _wet(5,6).")
    assert places_of(Grounding(solver.program, solver.snapshot, 5))[2] > 1


FACTS = st.one_of(
    st.builds("seen({}).".format, st.integers(1, 9)),
    st.builds("_wet({},{}).".format, st.integers(3, 7), st.integers(1, 9)),
    st.builds("_request({},{}).".format, st.integers(1, 9), st.integers(1, 9)),
    st.builds("p({0}) :- q({0}). q({0}).".format, st.integers(1, 3)),
    st.builds(":- at({},{}).".format, st.integers(3, 7), st.integers(1, 9)),
    st.builds("#assert : a. _wet({},{}).".format, st.integers(3, 7), st.integers(1, 9)),
)


@given(
    st.lists(st.sampled_from([-1, 0, 1]), min_size=1, max_size=7),
    st.lists(FACTS, max_size=7),
    st.integers(1, 3),
    st.integers(0, 3),
)
def test_answers_are_those_of_steps_ground_together(moves, told, block, over):
    """A late fact may contradict what was done; then there is none."""
    places = [5]
    for move in moves:
        places.append(places[-1] + move)
    solver = PlanSolver(PROGRAM, models=0)
    walk(solver, places, told, bound=2)
    snapshot, found = replace(solver.snapshot, keep_from=over), []
    # a closed cycle tells its actions no sooner if one of them is assumable
    for assumable in (frozenset([parse_atom("unknown")]), frozenset()):
        with mock.patch.object(grounding, "CLOSED_PIECE", block):
            one = Grounding(PROGRAM, snapshot, snapshot.horizon, assumable)
        for last in (snapshot.horizon, snapshot.horizon + 1):
            if last > one.horizon:
                one.grow_to(last)
            found.append(set(one.ask(Question(last, last, models=0), lambda: False).answers))
    assert found[:2] == found[2:]


RETURNS = """
#external _request/2. #external _return/3.
#program cumulative(t).
wanted(A,t) :- _request(A,t+1).
wanted(A,t) :- wanted(A,t-1), not done(A,t-1).
{ _action_lib(go,A,t) : wanted(A,t) } 1.
failed(t) :- _action_lib(go,A,t), _return(go,V,t), V != A.
done(A,t) :- _action_lib(go,A,t), not failed(t).
#program volatile(t).
:- wanted(A,t), not done(A,t).
"""


@pytest.mark.parametrize("built", [False, True])
@pytest.mark.parametrize(("value", "again"), [("failed", True), ("a", False)])
def test_return_is_accepted_with_an_update_that_closes_several_cycles(value, again, built):
    solver = planner_of(RETURNS)
    play(solver, "#step 1 : 9. _request(a,2).")
    if built:
        solver.restore(solver.log)
    result = play(solver, f"#step 4 : 9. #closed 1..3. :- not _action_lib(go,a,1). _return(go,{value},1).")
    assert result.warnings == ()
    assert ("_action_lib(go,a,4)" in map(str, result.answers[0])) == again
    assert play(solver, "#step 5 : 9. #closed 4..4.").warnings == ()
