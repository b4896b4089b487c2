"""The time arguments of predicates, and the rules that read the step itself."""

import pytest
from clingo import parse_term

from rosoclingo.checking.verifying.time_shift import TimeShift
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature

RULES = """
#program base. later(4). on(a,0).
#program cumulative(t).
#external seen/2.
on(X,t) :- seen(X,t).
on(X,t) :- on(X,t-1), not off(X,t).
off(X,t) :- seen(X,t-1).
count(X,N+1,t) :- count(X,N,t-1).
count(X,1,t) :- on(X,t).
latest(t,t) :- on(X,t).
latest(T,t) :- latest(T,t-1).
soon(T+2,t) :- latest(T,t), later(t-T).
"""


def shift(text):
    program = ReactiveProgram.from_text(RULES + text + "#program volatile(t). :- off(X,t).")
    return TimeShift(program.parts)


@pytest.mark.parametrize(
    ("atom", "moved", "time"),
    [
        ("count(a,4,5)", "count(a,4,3)", 5),
        ("latest(2,5)", "latest(0,3)", 5),
        ("soon(4,5)", "soon(2,3)", 5),
    ],
)
def test_time_shift_moves_times_and_no_other_numbers(atom, moved, time):
    one = shift("")
    assert str(one.shift(parse_term(atom), -2)) == moved
    assert one.time_of(parse_term(atom)) == time
    assert (one.readings, one.unclear) == ([], set())


@pytest.mark.parametrize(
    ("rule", "phases"),
    [
        ("on(z,t) :- on(X,t-1), t > 9.", {2: (2,), 22: (22,)}),
        ("on(z,t) :- on(X,t-1), t \\ 5 = 0.", {2: (5, 2), 22: (5, 2), 24: (5, 4)}),
        ("on(z,t) :- on(X,t-1), latest(T,t), t-T < 9.", {2: (), 22: ()}),
        ("on(z,t) :- on(X,t-1), later(t).", {2: (2,)}),
    ],
)
def test_time_shift_finds_rules_that_read_the_step(rule, phases):
    one, seen = shift(rule + "\n"), frozenset([Signature("on", 2)])
    assert {step: one.phase(step, seen) for step in phases} == phases


def test_time_shift_ignores_rules_without_visible_atoms():
    one = shift("on(z,t) :- count(X,N,t-1), t > 9.\n")
    assert one.phase(3, frozenset([Signature("on", 2)])) == ()
    assert one.phase(3, frozenset([Signature("count", 3)])) == (3,)
