"""Snapshots as messages: serialization to another process or a file keeps every value."""

import json
from dataclasses import fields

import pytest

from rosoclingo.oclingo import fact, parse_atom, parse_term, parse_update
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE, Term
from rosoclingo.oclingo.solving.stream_state import ClosedHeads, ForgottenSteps, TimedStatement
from rosoclingo.planning.snapshot import Past, Snapshot
from rosoclingo.planning.text import snapshot_from_message, snapshot_to_message, symbol_list, symbols_to_text

SAID = '_said("a, b",f("c"))'
PLAIN = fact(parse_atom(SAID))
A, GO = parse_atom("_seen(a)"), parse_atom("_action_lib(go,x,1)")
RULE, DENIAL = parse_update(f"_seen(c) :- {SAID}, not _seen(a). :- _seen(a). #endstep.").items

WITH_ALL = Snapshot(
    step=3,
    horizon=7,
    bound=9,
    min_horizon=6,
    number=5,
    items=(
        ForgottenSteps(0, 2),
        TimedStatement(fact(A), FOREVER, 1),
        TimedStatement(PLAIN, FOREVER, 2),
        ForgottenSteps(2, 3, frozenset([A, PLAIN.head])),
        ClosedHeads(frozenset([A, PLAIN.head])),
        TimedStatement(RULE, 4, 2),
        TimedStatement(PLAIN, UPDATE, 0),
        TimedStatement(DENIAL, Term(parse_term('x("y")')), 4),
        ForgottenSteps(4, 4),
    ),
    closed={1: frozenset([GO, PLAIN.head]), 2: frozenset()},
    keep_from=4,
    past=Past(2, frozenset([A, PLAIN.head]), ((1, GO), (0, PLAIN.head))),
)


@pytest.mark.parametrize("snapshot", [WITH_ALL, Snapshot()])
def test_snapshot_message_keeps_every_value(snapshot):
    assert snapshot_from_message(json.loads(json.dumps(snapshot_to_message(snapshot)))) == snapshot


def test_snapshot_with_all_differs_from_each_default():
    names = [one.name for one in fields(Snapshot) if one.compare]
    assert not [name for name in names if getattr(WITH_ALL, name) == getattr(Snapshot(), name)]


def test_symbols_text_keeps_their_order():
    symbols = [GO, PLAIN.head, A]
    assert symbol_list(symbols_to_text(symbols)) == symbols
    assert symbol_list(symbols_to_text([])) == []
