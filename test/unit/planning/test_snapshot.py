"""Snapshots: values, messages and the fold (see also test_history.py and test_stream_updates.py)."""

import json
from dataclasses import fields, replace

import pytest
from stream_play import planner_of

from rosoclingo.oclingo import ReactiveProgram, commitment, fact, parse_atom, parse_term, parse_update
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE, Term
from rosoclingo.oclingo.solving.stream_state import ClosedHeads, ForgottenSteps, TimedStatement
from rosoclingo.planning.snapshot import Past, Snapshot
from rosoclingo.planning.text import snapshot_from_message, snapshot_to_message

A, B, GO = (parse_atom(text) for text in ("_seen(a)", '_said("a, b",f("c"))', "_action_lib(go,x,1)"))
RULE, DENIAL = parse_update(f"_seen(c) :- {B}, not _seen(a). :- _seen(a). #endstep.").items
OTHERS = [
    ForgottenSteps(0, 2),
    ForgottenSteps(2, 3, frozenset([A, B])),
    ClosedHeads(frozenset([A, B])),
    ForgottenSteps(4, 4),
]
SNAPSHOT = Snapshot(
    step=3,
    horizon=7,
    bound=9,
    min_horizon=6,
    number=5,
    items=(
        OTHERS[0],
        *(TimedStatement(one, FOREVER, 1) for one in (fact(A), fact(B), RULE, commitment(GO))),
        *OTHERS[1:3],
        TimedStatement(fact(A), UPDATE, 0),
        TimedStatement(fact(B), 4, 2),
        TimedStatement(DENIAL, Term(parse_term('x("y")')), 4),
        OTHERS[3],
    ),
    closed={1: frozenset([GO, B]), 2: frozenset()},
    keep_from=4,
    past=Past(2, frozenset([A, B]), ((1, A), (0, B))),
)


@pytest.mark.parametrize("snapshot", [SNAPSHOT, Snapshot()])
def test_snapshot_message_keeps_every_value(snapshot):
    assert snapshot_from_message(json.loads(json.dumps(snapshot_to_message(snapshot)))) == snapshot
    names = [one.name for one in fields(Snapshot) if one.compare]
    assert not [name for name in names if getattr(SNAPSHOT, name) == getattr(Snapshot(), name)], "values to lose"


def test_snapshot_without_facts_keeps_only_their_shown_atoms():
    found = SNAPSHOT.without_facts(frozenset([A, GO]))
    assert list(found.permanent) == [fact(B), RULE]
    assert list(found.lapsing) == [fact(B), DENIAL]
    assert [one for one in found.items if not isinstance(one, TimedStatement)] == OTHERS
    assert found.closed == {1: frozenset([B]), 2: frozenset()}
    assert found.past == Past(2, frozenset([B]), ((1, A), (0, B)))
    assert SNAPSHOT.without_facts(frozenset()) == SNAPSHOT
    assert replace(SNAPSHOT, past=None).without_facts(frozenset([A])).past is None


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


@pytest.mark.parametrize("first", ["", "#iinit 0.", "#iinit -2."])
def test_first_snapshot_is_at_step_one(first):
    solver = planner_of(f"{first} #cumulative t. #volatile t.")
    snapshot, log = solver.snapshot, solver.log
    assert (snapshot.step, snapshot.horizon, snapshot.keep_from) == (log.step, log.horizon, log.keep_from) == (1, 1, 0)
    assert (solver.solve().step, solver.horizon) == (1, 1)
