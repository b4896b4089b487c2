"""What steps see of one another: which may be ground together, and what they could use of open signatures."""

import clingo
import pytest

from rosoclingo.oclingo import ReactiveProgram

SIGNATURE = ("m", 2, True)

STEPS = "d(1..2). #external m/1. #cumulative t. x(t) :- m(t+9). "


def domain(rules):
    program = ReactiveProgram.from_text("#external m/2. d(1..2). f(1..3,a). #cumulative t. " + rules)
    return program.domains[SIGNATURE].text.splitlines() if SIGNATURE in program.domains else None


@pytest.mark.parametrize(
    ("rules", "expected"),
    [
        ("x(D,t) :- m(D,t), d(D).", ["#external m(D,t__+(0)) : d(D)."]),
        ("x(D,t) :- d(D), not y(t), m(f(D,b),t-1), d(E).", ["#external m(f(D,b),t__+(-1)) : d(D)."]),
        ("x(t) :- m(X,t), f(X,Y), Y != a.", ["#external m(X,t__+(0)) : f(X,Y)."]),
        ("x(t) :- m(7,t), d(D).", ["#external m(7,t__+(0))."]),
        # a rule of step t sees what a rule of the step before takes for one of its own: the first to see it counts
        ("x(D,t) :- m(D,t), d(D). x(D,t) :- m(D,t-1), d(D).", ["#external m(D,t__+(0)) : d(D)."]),
        (
            "x(t) :- m(D,t), d(D). #volatile k. :- m(3,k+1).",
            ["#external m(D,t__+(1)) : d(D).", "#external m(3,t__+(1))."],
        ),
        # the step stands in the first argument as well, but not in all rules
        ("x(t) :- m(t,t). x(D,t) :- m(D,t), d(D).", ["#external m(D,t__+(0)) : d(D)."]),
        ("x(D,t) :- d(D), m(D,t), f(E,a) : d(E).", ["#external m(D,t__+(0)) : d(D)."]),
        # what one rule does not tell another may
        ("x(D,t) :- m(D,t). x(D,t) :- m(D,t), d(D).", ["#external m(D,t__+(0)) : d(D)."]),
    ],
)
def test_rules_tell_what_they_could_use(rules, expected):
    assert domain(rules) == expected


@pytest.mark.parametrize(
    "rules",
    [
        "x(D,t) :- m(D,t).",  # any D
        "x(t) :- m(_,t).",
        "x(D,t) :- m(D,t), D < 3.",
        "x(D,t) :- m(D,t), not d(D).",
        "x(D,t) :- m(D,t), d(D+1).",
        "x(D,t) :- m(D,t), e(D,t). #external e(D,t) : d(D).",  # known step by step alone
        "x(D,t) :- m(D,t), f(D,t).",
        "x(D,t) :- m(D,t), f(1,D*D).",
        "x(t) :- m(_,t), f(1,_).",
        "x(D,t) :- m(D,t), -d(D). #base. -d(1).",
        "x(D,t) :- m(D,t), e(D). e(D) :- d(D), D < t.",
        "x(D,t) :- m(D,T), d(D), d(T).",  # at any step
        "x(D,t) :- m(D,t), d(D). x(D,t) :- m(D,1), d(D).",
        "x(D,t) :- m(D,t), d(D). #base. y :- m(1,1).",
        "x(D,t) :- m(t,D), d(D). x(D,t) :- m(D,t), d(D).",
        "x(D,t) :- m(D,t), d(D). m(D,t) :- d(D), D > 1.",  # the program defines some
        "#external m(D,t) : d(D). x(D,t) :- m(D,t), d(D).",  # the program declares them
    ],
)
def test_there_is_no_domain_where_they_do_not_tell(rules):
    assert domain(rules) is None


def test_there_is_no_domain_where_the_step_stands_in_two_places():
    text = "#external w/3. d(1..2). #cumulative t. x(t) :- w(D,t,t-1), d(D)."
    assert not ReactiveProgram.from_text(text).domains


@pytest.mark.parametrize(
    ("rules", "size"),
    [
        ("x(D,t) :- m(D,t), d(D).", 2),
        ("x(D,t) :- m(D,t), d(D). x(X,t) :- m(X,t), f(X,Y).", 2 + 3),
        ("x(D,t) :- m(f(D,X),t), d(D), f(X,Y).", 2 * 3),
        ("x(t) :- m(7,t).", 1),
    ],
)
def test_how_many_atoms_they_could_use(rules, size):
    control = clingo.Control(["--warn=none"])
    control.add("base", [], "d(1..2). f(1..3,a).")
    control.ground([("base", [])])
    program = ReactiveProgram.from_text("#external m/2. d(1..2). f(1..3,a). #cumulative t. " + rules)
    assert program.domains[SIGNATURE].size(control) == size


@pytest.mark.parametrize(
    ("rules", "apart"),
    [
        ("a(t) :- a(t-1), not b(t). { b(t) }.", True),
        ("a(t-1) :- b(t). { b(t) }. c(t) :- a(t-1).", True),
        ("a(t-1) :- b(t). { b(t) }. c(t) :- a(t).", False),  # b(t+1) makes a(t) possible
        ("a(t) :- not b(t+1). { b(t) }.", False),
        ("a(t) :- e(t+1). #external e(t).", False),
        ("a(2*t) :- b(t). { b(t) }. c(t) :- a(t).", False),
        ("a(2*t) :- b(t). { b(t) }.", True),
        ("{ a(t) }. #base. y :- a(1).", True),
        ("a(D,t) :- d(D), not a(D,t-1).", True),
        ("a(T,t) :- b(T), d(t,T). { b(t) }.", False),
        ("a(t,X) :- b(X,t), d(X). { b(t,X) : d(X) }.", False),
        ("{ b(t) }. a(t) :- #count { T : b(T), d(T) } > 1.", False),
    ],
)
def test_steps_are_apart_where_none_sees_what_a_later_one_defines(rules, apart):
    assert ReactiveProgram.from_text(STEPS + rules).steps_apart is apart


@pytest.mark.parametrize(
    ("rules", "apart"),
    [
        ("", True),
        ("a(t).", True),
        ("a(t,X) :- d(X). b(X,t+1) :- d(X).", True),
        ("a(t). #base. a(0).", True),
        ("a(t). a(t+1).", False),
        ("a(2*t).", False),
        ("a(X,t) :- d(X). a(t,X) :- d(X).", False),
        ("a(X) :- m(X).", False),
        ("a :- m(t).", False),
        ("#volatile t. a :- m(t).", False),
    ],
)
def test_heads_are_apart_where_no_two_steps_define_the_same(rules, apart):
    assert ReactiveProgram.from_text(STEPS + rules).heads_apart is apart
