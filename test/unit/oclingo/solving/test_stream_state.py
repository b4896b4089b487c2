"""The state of a stream: how long statements hold, what a copy shares, and the state without some facts."""

import json

import pytest
from plain_walk import RUN

from rosoclingo.oclingo import (
    ReactiveProgram,
    ReactiveSolver,
    Volatile,
    commitment,
    fact,
    parse_atom,
    parse_term,
    parse_update,
)
from rosoclingo.oclingo.progression.updates import Assert, Closed, Cumulative, Over, StreamUpdate, Withdraw
from rosoclingo.oclingo.solving.state_text import state_from_message, state_to_message
from rosoclingo.oclingo.solving.stream_state import (
    FOREVER,
    UPDATE,
    Lapsing,
    Past,
    StreamState,
    Term,
    is_foreseen,
    lifetime_of,
)

A, B, GO = (parse_atom(text) for text in ("_seen(a)", "_seen(b)", "_action_lib(go,x,1)"))
RULE, DENIAL = parse_update("_seen(c) :- _seen(a). :- _seen(a). #endstep.").items


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
def test_how_long_statements_hold(section, lifetime):
    assert lifetime_of(section, 7) == lifetime


def state():
    return StreamState(
        step=3,
        horizon=4,
        permanent=[fact(A), fact(B), RULE, DENIAL, commitment(GO)],
        lapsing=[Lapsing(fact(A), UPDATE), Lapsing(fact(B), 9), Lapsing(RULE, 9)],
        waiting=[Lapsing(fact(A), UPDATE), Lapsing(fact(B), 9)],
        open_atoms=[A, B],
        forgotten={B},
        closed_cycles={1: frozenset([GO]), 2: frozenset()},
        past=Past(2, frozenset([A, B]), ((1, A),)),
    )


def test_rules_are_what_has_head_and_body():
    assert list(state().rules()) == [RULE, RULE]


def test_a_state_without_some_facts():
    whole = state()
    less = whole.less(frozenset([A, GO]))
    assert less.permanent == [fact(B), RULE, DENIAL]
    assert less.lapsing == [Lapsing(fact(B), 9), Lapsing(RULE, 9)]
    assert less.waiting == [Lapsing(fact(B), 9)]
    assert less.open_atoms == [B]
    assert less.closed_cycles == {1: frozenset(), 2: frozenset()}
    assert less.past == Past(2, frozenset([B]), ((1, A),)), "what was shown was shown"
    assert whole == state()
    whole.past = None
    assert whole.less(frozenset([A])).past is None


def test_a_copy_shares_nothing_that_changes():
    whole = state()
    copy = whole.copy()
    assert copy == whole
    for things in (copy.permanent, copy.open_atoms):
        things.clear()
    copy.forgotten.add(A)
    copy.closed_cycles[3] = frozenset()
    copy.lapsing.pop()
    copy.told.add("odd")
    copy.waiting.pop()
    assert whole == state()


def test_a_fresh_state_has_forgotten_and_retired_nothing():
    fresh = StreamState(step=0, horizon=0)
    assert (fresh.forgets_done, fresh.keep_from, fresh.past, fresh.cyclic, fresh.bound) == (0, 0, None, False, None)


def test_the_size_of_a_state_counts_its_statements_and_atoms():
    whole = state()
    assert whole.size == 5 + 3 + 2 + 2 + 1
    assert whole.less(frozenset([A, GO])).size == 3 + 2 + 1 + 1 + 1


@pytest.mark.parametrize(
    ("changed", "steady"),
    [
        ({}, True),
        ({"cyclic": True}, False),
        ({"lapsing": [Lapsing(fact(A), 9)]}, True),
        ({"lapsing": [Lapsing(fact(A), 9), Lapsing(fact(A), UPDATE)]}, False),
        ({"waiting": [Lapsing(fact(A), UPDATE), Lapsing(fact(A), FOREVER)]}, False),
    ],
)
def test_a_state_is_steady_where_nothing_lapses_with_the_next_update(changed, steady):
    assert StreamState(step=1, horizon=1, **changed).is_steady is steady


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
def test_commitments_and_the_returns_of_what_was_done_are_foreseen_and_nothing_else(before, items, foreseen):
    assert is_foreseen(StreamUpdate(2, None, tuple(items)), before) is foreseen


def solver_of(text):
    return ReactiveSolver(ReactiveProgram.from_text(text))


@pytest.mark.parametrize("first", ["", "#iinit 0.", "#iinit -2."])
def test_a_stream_begins_where_its_log_says(first):
    solver = solver_of(f"{first} #cumulative t. #volatile t.")
    state, log = solver.state, solver.log
    assert (state.step, state.horizon, state.keep_from) == (log.step, log.horizon, log.over) == (1, 1, 0)
    assert (solver.solve().step, solver.horizon) == (1, 1)


def test_the_program_forgets_from_its_first_step_on():
    solver = solver_of("#iinit -2. #cumulative t. #external e(t). #forget t : t-1. #volatile t.")
    solver.solve()
    result = solver.update(parse_update("e(-2). e(-1). e(0). e(1). #endstep."))
    assert [sorted(map(str, answer)) for answer in result.answers] == [["e(1)"]]
    assert [warning.split()[1] for warning in result.warnings] == ["e(-2)", "e(-1)", "e(0)"]


def test_the_program_forgets_what_base_declares_as_what_step_1_does():
    solver = solver_of("#external door. #cumulative t. #forget t : t-2. #volatile t.")
    solver.update(parse_update("#step 2 : 0. door. #endstep."))
    assert solver.update(parse_update("#step 3 : 0. #endstep.")).answers == (frozenset([parse_atom("door")]),)
    solver = solver_of("#external door. #cumulative t. #forget t : t-2. #volatile t.")
    solver.update(parse_update("#step 3 : 0. #endstep."))
    result = solver.update(parse_update("door. #endstep."))
    assert [warning.split()[1] for warning in result.warnings] == ["door"]
    assert result.answers == (frozenset(),)


def test_states_travel_as_messages():
    program = ReactiveProgram.from_text(RUN + '#program cumulative(t).\n#external e(S,t) : S = ("a b";-1;f(x)).\n')
    solver = ReactiveSolver(program, shortest=True, oclingo_strings=False)
    for text in (
        '#step 1. _request(2,2). e("a b",1). e(f(x),1) :- not e(-1,1). e(-1,9). #volatile : 9. :- e(-1,1).',
        "#step 2. #assert : x(1). e(-1,2). #volatile. :- at(5,2). #forget 1.",
    ):
        solver.update(parse_update(text + " #endstep."))
    solver.close_cycle(1, [parse_atom("_action_lib(go,1,1)")])
    state = solver.state.copy()
    state.past = Past(2, frozenset([parse_atom("at(0,1)")]), ((1, parse_atom("at(0,1)")),))
    twin = state_from_message(json.loads(json.dumps(state_to_message(state))))
    assert twin == state
    asked = frozenset([parse_atom("_request(2,2)")])
    assert not any(statement.concerns(asked) for statement in twin.less(asked).permanent)
