"""Answers of translated programs; the expected answers follow from the manual and grammar of gringo 3."""

import pytest
from gringo3_answers import answers, optima, solve, translated

from rosoclingo.oclingo.gringo3 import Dialect, translate_program


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        # separators
        ("d(1..2). e(2..3). { p(X) : d(X) : e(X), q(X) : e(X) : not d(X) }. #hide. #show p/1. #show q/1.",
         ["", "p(2)", "p(2) q(3)", "q(3)"]),
        # a condition in a body ends at the comma
        ("d(1..2). { p(1), p(2), s }. ok :- p(X) : d(X), s. #hide. #show ok/0.", ["", "", "", "", "", "", "", "ok"]),
        ("d(1..2). { p(1), p(2) }. ok :- not p(X) : d(X) : X != 2. #hide. #show ok/0.", ["", "", "ok", "ok"]),
        # weights: every instance counts
        ("{ a }. c(1..2,x). ok :- 2 [ a : c(_,x) ] 2. #hide. #show ok/0.", ["", "ok"]),
        ("{ a }. c(1..2,x). ok :- 2 { a : c(_,x) } 2. #hide. #show ok/0.", ["", ""]),
        ("{ p(1), p(2) }. ok :- 3 [ p(1;2), p(1) ]. #hide. #show ok/0.", ["", "", "", "ok"]),
        ("d(1..3). 2 [ p(X) : d(X) = X ] 3. #hide d/1.", ["p(1) p(2)", "p(2)", "p(3)"]),
        ("d(1..4). s(N) :- N := { d(X) : X > 1 }. #hide d/1.", ["s(3)"]),
        ("d(2..4). s(A,B) :- A = #min [ d(X)=X ], B = #max [ d(X) : X < 4 = X ]. #hide d/1.", ["s(2,3)"]),
        # comparisons around aggregates
        ("1 == { a, b, c }.", ["a", "b", "c"]),
        ("{ a, b }. ok :- #max [ a=1, b=2 ] < 2. #hide. #show ok/0. #show b/0.", ["b", "b", "ok", "ok"]),
        ("d(1..4). s(N) :- d(N), N > { d(X) : X > 1 }. #hide d/1.", ["s(4)"]),
        ("{ a, b }. ok :- 2 == #avg [ a=1, b=3 ]. #hide. #show ok/0. #show a/0. #show b/0.",
         ["a", "a b ok", "b", "ok"]),
        ("{ a, b }. ok :- #avg [ a=1, b=3 ] >= 2. #hide. #show ok/0. #show a/0. #show b/0.",
         ["a", "a b ok", "b ok", "ok"]),
        # tuples
        ("d(1..3). s(N) :- N := #count { <X #mod 2> : d(X), <> : d(1) }. #hide d/1.", ["s(3)"]),
        ("d(1..3). s(N) :- N = { <0> : d(2), d(2), d(X) : X < 3 }. #hide d/1.", ["s(3)"]),
        ("d(1..3). s(A,B) :- A = #min { <X> : d(X) }, B = #max { <X,a> : d(X) : X < 3 }. #hide d/1.", ["s(1,2)"]),
        # averages and parities
        ("{ a, b }. e :- #even [ a=2, b=3 ]. n :- not #odd [ a=2, b=3 ].", ["a b", "a e n", "b", "e n"]),
        ("c. #even [ a=1, b=2 : c ].", ["b c", "c"]),
        # pools: a conjunction in a body, one rule per option in a head
        ("p(a,1;2). q(1;2,x;y). r(1,2;;3,4).", ["p(a,1) p(a,2) q(1,x) q(1,y) q(2,x) q(2,y) r(1,2) r(3,4)"]),
        ("p(1,2). p(2,3). t(X,Z) :- p(X,Y;;Y,Z). #hide p/2.", ["t(1,3)"]),
        ("{ p(1), p(2), q }. ok :- p(1;2) : not r, q. #hide. #show ok/0.", [*[""] * 7, "ok"]),
        # intervals: one rule per value, except under conditions and in disjunctions
        ("p(1). ok :- p(1..3). no :- not p(1..3).", ["no ok p(1)"]),
        ("a(1..2) | b.", ["a(1)", "a(2)", "b"]),
        ("p(X) :- X := 1..2. q(X) :- X = 2..3. r :- 1..3 == 2.", ["p(1) p(2) q(2) q(3) r"]),
        # assignments and arithmetic
        ("q(X,Y) :- f(X,Y) := f(1,g).", ["q(1,g)"]),
        ("q(X) :- X = #mod(7,2+2) * #div(9,2) + |1-3|.", ["q(14)"]),
        ("q(6 & 3, 6 ? 3, 6 ^ 3, ~6, -7 / 2, -7 #mod 2, 2 ** 3 ** 2).", ["q(2,7,5,-7,-3,-1,512)"]),
        # domains
        ("f(1..2). #domain f(X). p(X). q :- not r(X).", ["f(1) f(2) p(1) p(2) q"]),
        ("p(1,1). p(1,2). #domain p(X,Y). #domain p(Y,Z). q(Z,X) :- not p(Z,X). #hide p/2.", ["q(2,1)"]),
        ("f(1). #domain f(X). p(X) :- . #hide f/1.", ["p(1)"]),
        # classical negation, disjunction, constraints from #compute
        ("-p | q. :- -p, not r. #hide. #show -p/0. #show q/0.", ["q"]),
        ("{ a, b, c }. #compute 3 { a, not b }.", ["a", "a c"]),
        ("d(1..2). { p(1), p(2) }. #compute { p(X) : d(X) }. #hide d/1.", ["p(1) p(2)"]),
    ],
)  # fmt: skip
def test_translated_program_has_the_expected_answers(program, expected):
    assert answers(program) == sorted(expected)


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("1 { a, b } 1. #minimize [ a=2, b=1 ].", ["b"]),
        # equal literals count twice in brackets and once in braces
        ("1 { a, b } 1. #minimize [ a, a, b=1, b=2 ].", ["a"]),
        # later statements have priority, and statements of equal priority add up
        ("1 { a, b } 1. #minimize { a }. #minimize { b }.", ["a"]),
        ("1 { a, b } 1. #minimize [ a@1 ]. #minimize [ a@1, b=1@1 ].", ["b"]),
        ("1 { a, b } 1. #minimize { not a @ 3, not b @ 4 }.", ["b"]),
        # tuples, and weak constraints: each instance counts
        ("1 { a, b } 1. #minimize { <2,x> : a, <1,y> : b, <1,x> : b }.", ["a", "b"]),
        ("1 { a, b } 1. :~ a. <2> :~ b.", ["b"]),
        ("1 { a, b } 1. :~ a. <1:2> :~ b. <3:1>", ["b"]),
        ("1 { a, b } 1. d(1..2). :~ a : d(X), 1 == { b : d(Y), a }. :~ not d(_), b. #hide d/1.", ["b"]),
        ("1 { a, b } 1. d(1..2). #domain d(X). :~ a, d(X). <X #mod 2 : 1> :~ b. <2> #hide d/1.", ["a"]),
    ],
)
def test_translated_program_has_the_expected_optima(program, expected):
    assert optima(translated(program)) == sorted(expected)


@pytest.mark.parametrize(
    ("program", "expected"),
    [
        ("p(1). q(1). #hide p/1.", "q(1)"),
        ("p(1). q(1). #hide. #show p/1.", "p(1)"),
        ("p(1). -q(1). r. #hide p/1. #hide r/0.", "-q(1)"),
        ("p(1..3). q(2). #hide. #show p(X) : q(X).", "p(2)"),
        ("p(1..3). q(2). #hide p(X) : q(X).", "p(1) p(3) q(2)"),
        ("p(1..3,7). q(2). #hide. #show p(2;3,_).", "p(2,7) p(3,7)"),
        ("p(1;;2,3). q. #hide p/1.", "p(2,3) q"),
    ],
)
def test_translated_program_shows_the_expected_atoms(program, expected):
    assert answers(program) == [expected]


def test_hide_affects_no_atoms_of_other_files():
    files = [
        ("one.lp", "#hide p/1. p(1). r(1;2) :- p(1), p(1;1)."),
        ("two.lp", "q(1). s :- q(X), X = 1; X < 2."),
        ("three.lp", "t."),
    ]
    results = translate_program(files)
    assert [result.dialect for result in results] == [Dialect.GRINGO3, Dialect.CLINGO5, Dialect.EITHER]
    assert solve("\n".join(result.text for result in results)) == ["q(1) r(1) r(2) s t"]


def test_domains_constants_and_levels_apply_across_files():
    files = [
        ("one.lp", "#const n = 2. f(1..n). #domain f(X). #minimize { p(1) }."),
        ("two.lp", "1 { p(Y) : f(Y) } 1. q(X). #maximize { p(1) }. #hide f/1."),
    ]
    text = "\n".join(result.text for result in translate_program(files))
    assert optima(text) == ["p(1) q(1) q(2)"]
