"""A stream's state as plain values: nothing of it is lost on the way to another process or a file."""

import json
from dataclasses import fields

from rosoclingo.oclingo import fact, parse_atom, parse_term, parse_update
from rosoclingo.oclingo.progression.strings import strings_apart
from rosoclingo.oclingo.solving.state_text import state_from_message, state_to_message, symbol_list, symbols_to_text
from rosoclingo.oclingo.solving.stream_state import FOREVER, UPDATE, Lapsing, Past, StreamState, Term

SAID = '_said("a, b",f("c"))'
(APART,) = strings_apart(parse_update(f"{SAID}. #endstep.")).items
A, GO = parse_atom("_seen(a)"), parse_atom("_action_lib(go,x,1)")
RULE, DENIAL = parse_update(f"_seen(c) :- {SAID}, not _seen(a). :- _seen(a). #endstep.").items


def state_with_all():
    return StreamState(
        step=3,
        horizon=7,
        bound=9,
        permanent=[fact(A), APART, RULE, DENIAL],
        lapsing=[Lapsing(APART, UPDATE), Lapsing(RULE, 4), Lapsing(DENIAL, Term(parse_term('x("y")')))],
        waiting=[Lapsing(fact(A), FOREVER), Lapsing(APART, 5)],
        open_atoms=[GO, APART.head, A],
        forgotten={A, APART.head},
        forgets_done=2,
        closed_cycles={1: frozenset([GO, APART.head]), 2: frozenset()},
        keep_from=4,
        past=Past(2, frozenset([A, APART.head]), ((1, GO), (0, APART.head))),
        cyclic=True,
        settled=6,
        tried=5,
        told={"_seen/1", "what was odd"},
    )


def read_back(state):
    return state_from_message(json.loads(json.dumps(state_to_message(state))))


def test_every_value_of_a_state_comes_back():
    state, fresh = state_with_all(), StreamState(step=0, horizon=0)
    same = [one.name for one in fields(StreamState) if getattr(state, one.name) == getattr(fresh, one.name)]
    assert same == [], "each has to be another one than what a state without it has"
    assert read_back(state) == state
    assert read_back(fresh) == fresh


def test_strings_that_are_apart_stay_apart_from_those_that_are_not():
    state = StreamState(step=1, horizon=1, permanent=[APART, fact(parse_atom(SAID))])
    apart, plain = read_back(state).permanent
    assert (apart, plain) == (APART, fact(parse_atom(SAID)))
    assert apart != plain


def test_symbols_come_back_in_order():
    symbols = [GO, APART.head, A, parse_atom(SAID)]
    assert symbol_list(symbols_to_text(symbols)) == symbols
    assert symbol_list(symbols_to_text([])) == []
