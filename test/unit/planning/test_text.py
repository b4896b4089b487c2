"""Snapshots as plain values: nothing of them is lost on the way to another process or a file."""

import json
from dataclasses import fields

from rosoclingo.oclingo import fact, parse_atom, parse_term, parse_update
from rosoclingo.oclingo.progression.lifetimes import FOREVER, UPDATE, Term
from rosoclingo.oclingo.progression.strings import strings_apart
from rosoclingo.planning.snapshot import ClosedHeads, Forgotten, Past, Snapshot, Told
from rosoclingo.planning.text import snapshot_from_message, snapshot_to_message, symbol_list, symbols_to_text

SAID = '_said("a, b",f("c"))'
(APART,) = strings_apart(parse_update(f"{SAID}. #endstep.")).items
A, GO = parse_atom("_seen(a)"), parse_atom("_action_lib(go,x,1)")
RULE, DENIAL = parse_update(f"_seen(c) :- {SAID}, not _seen(a). :- _seen(a). #endstep.").items

WITH_ALL = Snapshot(
    step=3,
    horizon=7,
    bound=9,
    settled=6,
    number=5,
    told=(
        Forgotten(0, 2),
        Told(fact(A), FOREVER, 1),
        Told(APART, FOREVER, 2),
        Forgotten(2, 3, frozenset([A, APART.head])),
        ClosedHeads(frozenset([A, APART.head])),
        Forgotten(1, 1),
        Told(RULE, 4, 2),
        Told(APART, UPDATE, 0),
        Told(DENIAL, Term(parse_term('x("y")')), 4),
        Forgotten(4, 4),
    ),
    closed={1: frozenset([GO, APART.head]), 2: frozenset()},
    keep_from=4,
    past=Past(2, frozenset([A, APART.head]), ((1, GO), (0, APART.head))),
)


def read_back(snapshot):
    return snapshot_from_message(json.loads(json.dumps(snapshot_to_message(snapshot))))


def test_every_value_of_a_snapshot_comes_back():
    same = [
        one.name
        for one in fields(Snapshot)
        if one.compare and getattr(WITH_ALL, one.name) == getattr(Snapshot(), one.name)
    ]
    assert same == [], "each value differs from the default"
    assert read_back(WITH_ALL) == WITH_ALL
    assert read_back(Snapshot()) == Snapshot()


def test_strings_of_oclingo_stay_apart_from_others():
    snapshot = Snapshot(told=(Told(APART, FOREVER, 1), Told(fact(parse_atom(SAID)), FOREVER, 1)))
    apart, plain = read_back(snapshot).permanent
    assert (apart, plain) == (APART, fact(parse_atom(SAID)))
    assert apart != plain


def test_symbols_come_back_in_order():
    symbols = [GO, APART.head, A, parse_atom(SAID)]
    assert symbol_list(symbols_to_text(symbols)) == symbols
    assert symbol_list(symbols_to_text([])) == []
