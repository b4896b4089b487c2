"""Warnings about odd programs: each is given once, with its place and a fix, and the program is usable."""

import pytest

from rosoclingo.oclingo import ProgramError, ReactiveProgram, ReactiveSolver, parse_update

STEPS = "#program cumulative(t).\n#external e(t).\n#program volatile(t).\n"


def remarks(text, constants=None):
    return ReactiveProgram.from_text(text, "f.lp", constants).warnings


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        (
            "holds(a,1). b :- hold(X,1).\n",
            "f.lp:1:18: no rule and no #external defines hold/2: it is never true (did you mean holds/2",
        ),
        ("a :- 1 { b(X) : c(X) }.\nb(1).\n", "f.lp:1:17: no rule and no #external defines c/1"),
        (
            "#show place/2.\nplaced(1,2).\n",
            "f.lp:1:1: no rule and no #external defines place/2: it is never true (did you mean placed/2",
        ),
        ("a :- _return(b,c,1).\n", "f.lp:1:6: no rule and no #external defines _return/3"),
    ],
)
def test_program_warns_about_undefined_predicates(text, remark):
    (found,) = [one for one in remarks(text + STEPS) if "defines" in one]
    assert found.startswith(remark)


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


@pytest.mark.parametrize(
    ("text", "messages"),
    [
        (
            "#program cumulative(s).\np(X,s) :- not q(X).\n#program volatile(k).\nr(k,X).\n"
            ":- not p(X,_),  % first\n  p(_,k). #external e(X). a.  #external\n  f(Y,k) : q(X).\nq(1).\n",
            [
                "unsafe variable X in p(X,s) :- not q(X).",
                "unsafe variable X in r(k,X).",
                "unsafe variable X in :- not p(X,_), p(_,k).",
                "unsafe variable X in #external e(X).",
                "unsafe variable Y in #external f(Y,k) : q(X).",
            ],
        ),
    ],
)
def test_unsafe_variables_are_reported_with_original_text(text, messages):
    with pytest.raises(ProgramError) as caught:
        ReactiveProgram.from_text(text, "f.lp")
    assert [fault.message for fault in caught.value.faults] == messages
    assert "condition" in caught.value.faults[-1].remedy


def test_program_warns_about_unknown_constants():
    text = "#const capacity = 3.\nroom(r1).\n" + STEPS
    assert remarks(text, {"capacity": "4", "r1": "r2"}) == []
    assert remarks(text, {"capcity": "4"}) == [
        "constant capcity: the program has no #const capcity (did you mean capacity?)",
    ]
    assert "(it has none)" in remarks(STEPS, {"x": "4"})[0]


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
