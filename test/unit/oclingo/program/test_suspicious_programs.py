"""Warnings about odd programs: each is given once, with its place and a fix, and the program is usable."""

import pytest

from rosoclingo.oclingo import ProgramError, ReactiveProgram, ReactiveSolver, parse_update

STEPS = "#program cumulative(t).\n#external e(t).\n#program volatile(t).\n"


def remarks(text):
    return ReactiveProgram.from_text(text, "f.lp").warnings


@pytest.mark.parametrize(
    "text",
    [
        "#defined hold/2.\nb :- hold(X,1).\n",
        "a :- f.\n#external f.\n",
        "#external f/1.\na :- f(1).\n#show.\n#show a/0.\n",
        "{ a }. b :- not a. -c. d :- -c.\n",
    ],
)
def test_program_does_not_warn_about_defined_predicates(text):
    assert remarks(text + STEPS) == []


def test_undefined_operations_are_reported_when_loading():
    text = "q(a).\n" + STEPS + "#program cumulative(s).\np(s) :- q(X), X = s/0.\n"
    (found,) = remarks(text)
    assert found.startswith("f.lp:6:19: undefined operation (s/0): clingo omits the instances that need it")
    assert ReactiveSolver(ReactiveProgram.from_text(text, "f.lp")).solve().warnings == (), "and not again"


def test_unsafe_variables_are_reported_with_original_text():
    text = """#program cumulative(s).
p(X,s) :- not q(X).
#program volatile(k).
r(k,X).
:- not p(X,_),  % first
  p(_,k). #external e(X). a.  #external
  f(Y,k) : q(X).
q(1).
"""
    with pytest.raises(ProgramError) as caught:
        ReactiveProgram.from_text(text, "f.lp")
    assert [fault.message for fault in caught.value.faults] == [
        "unsafe variable X in p(X,s) :- not q(X).",
        "unsafe variable X in r(k,X).",
        "unsafe variable X in :- not p(X,_), p(_,k).",
        "unsafe variable X in #external e(X).",
        "unsafe variable Y in #external f(Y,k) : q(X).",
    ]
    assert "condition" in caught.value.faults[-1].remedy


def play(solver, text):
    return solver.update(parse_update(text + " #endstep.")).warnings


def test_unused_facts_are_reported_only_once():
    solver = ReactiveSolver(ReactiveProgram.from_text("{ c }.\n" + STEPS))
    (warning,) = play(solver, "#step 1. ee(1). e(1).")
    assert warning.startswith("No rule and no #external of the program mentions ee/1")
    assert warning.endswith("(did you mean e/1?).")
    assert play(solver, "#step 2. ee(2).") == ()
    assert play(solver, "x(1). e(2) :- x(1). -c.") == ()
    assert play(solver, "x(2).") == ()
    assert len(play(solver, "zzz.")) == 1
    assert play(solver, "y(1) :- c.") == (), "a rule has a body to depend on"
    assert len(play(solver, "y(2).")) == 1
