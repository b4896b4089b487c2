"""Snapshots: values and the fold (see also test_history.py and test_stream_updates.py)."""

from dataclasses import replace

import pytest
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


def ignored(result):
    """Return the heads of ignored statements."""
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
        ("heard(3)", False),
    ],
)
def test_only_facts_of_compacted_steps_are_too_late(atom, too_late):
    program = ReactiveProgram.from_text(
        "#external sees/2. #external unused/1. #program cumulative(t). day(t). #external e(t). "
        "#external held(T) : day(T), T > t-2. seen(X,t) :- sees(X,T), T > t-2. a(t) :- heard(t). #program volatile(t)."
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


# ---- Closed cycles ---------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("done", "late"), [("", "12"), (":- not _action_lib(go,x,1).", "2")])
def test_snapshot_accepts_returns_of_the_last_cycles(done, late):
    """The last cycle, and the last cycle with actions."""
    text = "#cumulative t. #external _return(go,x,t). { _action_lib(go,x,t) }. #volatile t."
    solver = planner_of(text)
    play(solver, f"#step 2. #closed 1. {done}")
    result = play(solver, "#step 4. #closed 2..3. _return(go,x,1). _return(go,x,2). _return(go,x,3).")
    assert ignored(result) == [f"_return(go,x,{cycle})" for cycle in late]


def test_step_without_bound_removes_the_previous_bound():
    solver = planner_of(WALK)
    found = [play(solver, text).outcome for text in ("#step 1 : 1. _request(4,1).", "#step 1.")]
    assert found == [SolveOutcome.UNSATISFIABLE, SolveOutcome.SATISFIABLE]
