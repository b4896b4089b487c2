"""Snapshots: values and the fold; test_history.py compares the fold with a reference on random streams."""

from dataclasses import replace

import pytest
from stream_logs import texts
from stream_play import WALK, planner_of, play

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, commitment, fact, parse_atom, parse_update
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE
from rosoclingo.oclingo.solving.stream_state import ClosedHeads, ForgottenSteps, TimedStatement
from rosoclingo.planning.snapshot import Past, Snapshot

A, B, GO = (parse_atom(text) for text in ("_seen(a)", "_seen(b)", "_action_lib(go,x,1)"))
RULE, DENIAL = parse_update("_seen(c) :- _seen(a). :- _seen(a). #endstep.").items
PERMANENT = [TimedStatement(one, FOREVER, 1) for one in (fact(A), fact(B), RULE, DENIAL, commitment(GO))]
LAPSING = [TimedStatement(fact(A), UPDATE, 2), TimedStatement(fact(B), 9, 2), TimedStatement(RULE, 9, 2)]
OTHERS = [ForgottenSteps(0, 1), ForgottenSteps(1, 2, frozenset([A])), ClosedHeads(frozenset([B]))]
SNAPSHOT = Snapshot(
    step=3,
    horizon=4,
    items=(*OTHERS[:1], *PERMANENT, *OTHERS[1:], *LAPSING),
    closed={1: frozenset([GO]), 2: frozenset()},
    past=Past(2, frozenset([A, B]), ((1, A),)),
)
EXTERNALS = "#cumulative t. #external e(t). c(t) :- e(t). #volatile t."


def ignored(result):
    """The heads that were not declared external."""
    return [warning.split()[1] for warning in result.warnings]


def test_snapshot_without_facts_keeps_only_their_shown_atoms():
    found = SNAPSHOT.without_facts(frozenset([A, GO]))
    assert list(found.permanent) == [fact(B), RULE, DENIAL]
    assert list(found.lapsing) == [fact(B), RULE]
    assert [one for one in found.items if not isinstance(one, TimedStatement)] == OTHERS
    assert found.closed == {1: frozenset(), 2: frozenset()}
    assert found.past == Past(2, frozenset([B]), ((1, A),))
    assert SNAPSHOT.without_facts(frozenset()) == SNAPSHOT
    assert replace(SNAPSHOT, past=None).without_facts(frozenset([A])).past is None


def test_snapshot_size_counts_statements_and_atoms():
    assert SNAPSHOT.size == 5 + 3 + 3 + 1


def test_snapshot_is_steady_if_nothing_lapses_next():
    assert Snapshot(items=(PERMANENT[0], LAPSING[1])).is_steady
    assert not Snapshot(items=(LAPSING[1], LAPSING[0])).is_steady


@pytest.mark.parametrize(
    ("atom", "too_late"),
    [
        ("e(8)", True),
        ("e(9)", False),
        ("held(7)", True),
        ("held(8)", False),
        ("sees(x,7)", True),
        ("sees(x,8)", False),
        ("unused(1)", False),
        ("told(3)", False),
    ],
)
def test_facts_of_compacted_steps_alone_are_too_late(atom, too_late):
    program = ReactiveProgram.from_text(
        "#external sees/2. #external unused/1. #program cumulative(t). day(t). #external e(t). "
        "#external held(T) : day(T), T > t-2. seen(X,t) :- sees(X,T), T > t-2. a(t) :- told(t). #program volatile(t)."
    )
    assert Snapshot(step=12).is_too_late(program, parse_atom(atom)) is False
    assert Snapshot(step=12, past=Past(9, frozenset())).is_too_late(program, parse_atom(atom)) is too_late


# ---- The fold --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("first", ["", "#iinit 0.", "#iinit -2."])
def test_first_snapshot_is_at_step_one(first):
    solver = planner_of(f"{first} #cumulative t. #volatile t.")
    snapshot, log = solver.snapshot, solver.log
    assert (snapshot.step, snapshot.horizon, snapshot.keep_from) == (log.step, log.horizon, log.keep_from) == (1, 1, 0)
    assert (solver.solve().step, solver.horizon) == (1, 1)


def test_program_forgets_from_its_first_step_on():
    solver = planner_of("#iinit -2. #cumulative t. #external e(t). #forget t : t-1. #volatile t.")
    solver.solve()
    result = play(solver, "e(-2). e(-1). e(0). e(1).")
    assert texts(result) == {frozenset(["e(1)"])}
    assert ignored(result) == ["e(-2)", "e(-1)", "e(0)"]


@pytest.mark.parametrize(("updates", "open_"), [(["#step 2 : 0. door.", "#step 3 : 0."], True), (["#step 3."], False)])
def test_program_forgets_base_like_the_first_step(updates, open_):
    solver = planner_of("#external door. #cumulative t. #forget t : t-2. #volatile t.")
    for text in updates:
        result = play(solver, text)
    assert texts(result) == {frozenset(["door"] if open_ else [])}
    assert ignored(play(solver, "door.")) == ([] if open_ else ["door"])


@pytest.mark.parametrize(("section", "end"), [("#assert : x.", "#retract : x."), ("#volatile.", ""), ("", "")])
def test_forgetting_spares_heads_of_lapsing_statements(section, end):
    solver = planner_of(EXTERNALS)
    play(solver, f"#step 2 : 0. {section} e(1). #forget 1.")
    play(solver, f"#step 3 : 0. {end}")
    for _ in range(2):
        assert texts(play(solver, "#step 3 : 0. e(1).")) == {frozenset(["e(1)", "c(1)"])}


def test_statements_of_a_window_hold_to_its_end():
    solver = planner_of(EXTERNALS)
    play(solver, "#step 2 : 0. #volatile : 2. e(1).")
    assert [texts(play(solver, f"#step {step} : 0.")) for step in (3, 4)] == [
        {frozenset(["e(1)", "c(1)"])},
        {frozenset()},
    ]


def test_several_updates_define_a_head_before_its_step():
    solver = planner_of("{ a }. { b }. " + EXTERNALS, models=0)
    for text in ("#step 1 : 0. e(3) :- a.", "#step 2 : 0. e(3) :- b.", "#step 3 : 0. :- a."):
        result = play(solver, text)
    assert texts(result) == {frozenset(), frozenset(["b", "e(3)", "c(3)"])}
    assert ignored(play(solver, "e(3) :- not b.")) == ["e(3)"]


def test_retracting_an_unknown_term_is_ignored():
    result = play(planner_of(EXTERNALS), "#step 1. #retract : x.")
    assert result.warnings == ("Term x has not been asserted. The retraction is ignored.",)


# ---- Closed cycles ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("cycle", ["t-2", "t-1", "t", "t+1", "t+2"])
def test_closed_cycle_gets_no_action_at_later_steps(cycle):
    solver = planner_of(f"#cumulative t. {{ _action_lib(go,x,{cycle}) }}. #volatile t.", models=0)
    result = play(solver, "#step 5. #closed 3.")
    assert len(result.answers) > 1
    assert not any(parse_atom("_action_lib(go,x,3)") in answer for answer in result.answers)


@pytest.mark.parametrize(("done", "late"), [("", "12"), (":- not _action_lib(go,x,1).", "2")])
def test_returns_may_come_for_the_last_cycle_with_actions(done, late):
    """And for the last cycle."""
    text = "#cumulative t. #external _return(go,x,t). { _action_lib(go,x,t) }. #volatile t."
    solver = planner_of(text)
    play(solver, f"#step 2. #closed 1. {done}")
    result = play(solver, "#step 4. #closed 2..3. _return(go,x,1). _return(go,x,2). _return(go,x,3).")
    assert ignored(result) == [f"_return(go,x,{cycle})" for cycle in late]


def test_step_without_bound_ends_that_of_the_last():
    solver = planner_of(WALK)
    found = [play(solver, text).outcome for text in ("#step 1 : 1. _request(4,1).", "#step 1.")]
    assert found == [SolveOutcome.UNSATISFIABLE, SolveOutcome.SATISFIABLE]
