"""Dependencies between steps: which steps can be grounded together."""

import pytest

from rosoclingo.oclingo import ReactiveProgram

STEPS = "d(1..2). #external m/1. #cumulative t. x(t) :- m(t+9). "


@pytest.mark.parametrize(
    ("rules", "apart"),
    [
        ("a(t) :- a(t-1), not b(t). { b(t) }.", True),
        ("a(t-1) :- b(t). { b(t) }. c(t) :- a(t).", False),  # b(t+1) makes a(t) possible
        ("a(t) :- e(t+1). #external e(t).", False),
        ("{ a(t) }. #base. y :- a(1).", True),
        ("a(T,t) :- b(T), d(t,T). { b(t) }.", False),
        ("{ b(t) }. a(t) :- #count { T : b(T), d(T) } > 1.", False),
    ],
)
def test_steps_apart_means_independence_of_later_steps(rules, apart):
    assert ReactiveProgram.from_text(STEPS + rules).steps_apart is apart


@pytest.mark.parametrize(
    ("rules", "apart"),
    [
        ("a(t,X) :- d(X). b(X,t+1) :- d(X).", True),
        ("a(t). a(t+1).", False),
        ("a(X,t) :- d(X). a(t,X) :- d(X).", False),
        ("a :- m(t).", False),
    ],
)
def test_heads_apart_means_one_step_per_atom(rules, apart):
    assert ReactiveProgram.from_text(STEPS + rules).heads_apart is apart
