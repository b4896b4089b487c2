"""Snapshots: values, messages and the fold (see also test_history.py and test_stream_updates.py)."""

import json
from dataclasses import fields

import pytest

from rosoclingo.oclingo import Assert, commitment, fact, parse_atom, parse_term, parse_update
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE
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
        TimedStatement(DENIAL, Assert(parse_term('x("y")')), 4),
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
