"""Snapshots: how long statements hold, withdrawn facts, and the fold compared with a reference."""

import json
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_streams import ITEMS, PARTS, UPDATES, without_strangers
from solver_reference import ShortestReference
from stream_logs import texts
from stream_play import planner_of, play

from rosoclingo.oclingo import (
    ReactiveProgram,
    SolveOutcome,
    Volatile,
    commitment,
    fact,
    parse_atom,
    parse_term,
    parse_update,
)
from rosoclingo.oclingo.program.update_reader import is_foreseen
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE, Term, lifetime_of
from rosoclingo.oclingo.progression.updates import Assert, Closed, Cumulative, Over, StreamUpdate, Withdraw
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.snapshot import ClosedHeads, Forgotten, Past, Snapshot, Told
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.text import snapshot_from_message, snapshot_to_message

A, B, GO = (parse_atom(text) for text in ("_seen(a)", "_seen(b)", "_action_lib(go,x,1)"))
RULE, DENIAL = parse_update("_seen(c) :- _seen(a). :- _seen(a). #endstep.").items
EXTERNALS = "#cumulative t. #external e(t). c(t) :- e(t). #volatile t."


# ---- The value -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("section", "lifetime"),
    [
        (Cumulative(), FOREVER),
        (Assert(parse_term("x(1)")), Term(parse_term("x(1)"))),
        (Volatile(), UPDATE),
        (Volatile(0), UPDATE),
        (Volatile(1), 7),
        (Volatile(3), 9),
    ],
)
def test_lifetime_of_statements_in_each_section(section, lifetime):
    assert lifetime_of(section, 7) == lifetime


PERMANENT = [Told(one, FOREVER, 1) for one in (fact(A), fact(B), RULE, DENIAL, commitment(GO))]
LAPSING = [Told(fact(A), UPDATE, 2), Told(fact(B), 9, 2), Told(RULE, 9, 2)]


def snapshot():
    return Snapshot(
        step=3,
        horizon=4,
        told=(Forgotten(0, 1), *PERMANENT, Forgotten(1, 2, frozenset([A])), ClosedHeads(frozenset([B])), *LAPSING),
        closed={1: frozenset([GO]), 2: frozenset()},
        past=Past(2, frozenset([A, B]), ((1, A),)),
    )


def test_withdrawn_facts_leave_no_trace_but_what_was_shown():
    less = snapshot().without(frozenset([A, GO]))
    assert list(less.permanent) == [fact(B), RULE, DENIAL]
    assert list(less.lapsing) == [fact(B), RULE]
    others = [one for one in less.told if not isinstance(one, Told)]
    assert others == [one for one in snapshot().told if not isinstance(one, Told)]
    assert less.closed == {1: frozenset(), 2: frozenset()}
    assert less.past == Past(2, frozenset([B]), ((1, A),))
    assert snapshot().without(frozenset()) == snapshot()
    assert replace(snapshot(), past=None).without(frozenset([A])).past is None


def test_size_counts_statements_and_atoms():
    assert snapshot().size == 5 + 3 + 3 + 1


@pytest.mark.parametrize(
    ("told", "steady"),
    [((), True), ((PERMANENT[0], LAPSING[1]), True), ((LAPSING[1], LAPSING[0]), False)],
)
def test_snapshot_is_steady_if_nothing_lapses_with_the_next_update(told, steady):
    assert Snapshot(told=told).is_steady is steady


@pytest.mark.parametrize(
    ("atom", "too_late"),
    [
        ("e(8)", True),
        ("e(9)", False),
        ("held(7)", True),
        ("held(8)", False),
        ("sees(x,7)", True),
        ("sees(x,8)", False),
        ("sees(x,30)", False),
        ("unused(1)", False),
        ("told(3)", False),
        ("other(1)", False),
    ],
)
def test_facts_of_retired_steps_alone_are_too_late(atom, too_late):
    program = ReactiveProgram.from_text(
        "#external sees/2. #external unused/1. #program cumulative(t). day(t). #external e(t). "
        "#external held(T) : day(T), T > t-2. seen(X,t) :- sees(X,T), T > t-2. a(t) :- told(t). #program volatile(t)."
    )
    assert Snapshot(step=12).is_too_late(program, parse_atom(atom)) is False
    assert Snapshot(step=12, past=Past(9, frozenset())).is_too_late(program, parse_atom(atom)) is too_late


DONE, MADE = commitment(GO), fact(parse_atom("_return(go,x,1)"))


@pytest.mark.parametrize(
    ("before", "items", "foreseen"),
    [
        ([], [DONE, MADE], True),
        ([], [Closed(1, 1), Over(1), Cumulative(), DONE, MADE], True),
        ([DONE], [MADE], True),
        ([], [MADE], False),
        ([DONE], [fact(parse_atom("_return(go,failed,1)"))], False),
        ([], [DONE, fact(A)], False),
        ([], [DONE, Withdraw(A)], False),
        ([], [DONE, Volatile()], False),
    ],
)
def test_commitments_and_their_successes_alone_are_foreseen(before, items, foreseen):
    assert is_foreseen(StreamUpdate(2, None, tuple(items)), before) is foreseen


# ---- The fold --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("first", ["", "#iinit 0.", "#iinit -2."])
def test_first_snapshot_is_at_step_one(first):
    solver = planner_of(f"{first} #cumulative t. #volatile t.", models=0)
    snapshot, log = solver.snapshot, solver.log
    assert (snapshot.step, snapshot.horizon, snapshot.keep_from) == (log.step, log.horizon, log.over) == (1, 1, 0)
    assert (solver.solve().step, solver.horizon) == (1, 1)


def test_program_forgets_from_its_first_step_on():
    solver = planner_of("#iinit -2. #cumulative t. #external e(t). #forget t : t-1. #volatile t.", models=0)
    solver.solve()
    result = play(solver, "e(-2). e(-1). e(0). e(1).")
    assert texts(result) == {frozenset(["e(1)"])}
    assert [warning.split()[1] for warning in result.warnings] == ["e(-2)", "e(-1)", "e(0)"]


def test_program_forgets_what_base_declares_as_what_step_1_does():
    text = "#external door. #cumulative t. #forget t : t-2. #volatile t."
    solver = planner_of(text, models=0)
    play(solver, "#step 2 : 0. door.")
    assert texts(play(solver, "#step 3 : 0.")) == {frozenset(["door"])}
    solver = planner_of(text, models=0)
    play(solver, "#step 3 : 0.")
    result = play(solver, "door.")
    assert [warning.split()[1] for warning in result.warnings] == ["door"]
    assert texts(result) == {frozenset()}


@pytest.mark.parametrize(("section", "end"), [("#assert : x.", "#retract : x."), ("#volatile.", ""), ("", "")])
def test_forgetting_spares_what_lapsing_statements_define(section, end):
    solver = planner_of(EXTERNALS, models=0)
    play(solver, f"#step 2 : 0. {section} e(1). #forget 1.")
    play(solver, f"#step 3 : 0. {end}")
    for _ in range(2):
        assert texts(play(solver, "#step 3 : 0. e(1).")) == {frozenset(["e(1)", "c(1)"])}


def test_several_updates_define_a_head_before_its_step():
    solver = planner_of("{ a }. { b }. " + EXTERNALS, models=0)
    for text in ("#step 1 : 0. e(3) :- a.", "#step 2 : 0. e(3) :- b.", "#step 3 : 0. :- a."):
        result = play(solver, text)
    assert texts(result) == {frozenset(), frozenset(["b", "e(3)", "c(3)"])}
    assert [warning.split()[1] for warning in play(solver, "e(3) :- not b.").warnings] == ["e(3)"]


CLOSE_STEPS = st.lists(st.integers(1, 3), min_size=1, max_size=5).map(sorted)
MANY = st.lists(ITEMS, min_size=2, max_size=8).map(tuple)
STREAMS = st.one_of(
    st.lists(UPDATES, min_size=1, max_size=5),
    st.builds(
        lambda steps, items: [StreamUpdate(*pair) for pair in zip(steps, [0, 1, 0, 2, 0], items)],
        CLOSE_STEPS,
        st.lists(MANY, min_size=5, max_size=5),
    ),
)


@pytest.mark.slow
@given(PARTS, STREAMS)
def test_fold_and_grounding_equal_the_reference(parts, updates):
    """The statements in force, what is forgotten, and all answers of the least horizon; also after a round trip."""
    reference, program = ShortestReference(parts), ReactiveProgram.from_text(parts.text())
    solver = PlanSolver(program, models=0, idles=False)
    for update in updates:
        update = without_strangers(parts, update)
        satisfiable, answers, horizon, ignored = reference.update(update)
        result = solver.update(update)
        context = parts.text(), list(map(str, updates)), str(update)
        assert (result.outcome is SolveOutcome.SATISFIABLE) == satisfiable, context
        assert texts(result) == answers, context
        assert len(result.answers) == len(answers)
        if result.permanent:
            return
        assert result.horizon == horizon, context
        if not satisfiable:
            reference.end_at(solver.horizon)
        assert solver.horizon == reference.horizon
        assert sum("declared external" in warning for warning in result.warnings) <= ignored
        snapshot = solver.snapshot
        assert snapshot_from_message(json.loads(json.dumps(snapshot_to_message(snapshot)))) == snapshot
        grounding = Grounding(program, snapshot, snapshot.horizon)
        assert {str(one.statement) for one in grounding.in_force} == in_force(reference, grounding), context
        forgotten = {str(one) for one in grounding.false}
        assert forgotten | reference.closed == reference.forgotten | reference.closed, context


def in_force(reference, grounding):
    """The statements of the reference, less those whose head is given as a fact of an open predicate."""
    given = {
        str(one) for one in grounding.snapshot.facts_without(frozenset()) if grounding.program.is_open_signature(one)
    }
    held = [one.statement for one in reference.held if not one.waiting]
    return {str(one) for one in held if not (one.body and str(one.head) in given)}
