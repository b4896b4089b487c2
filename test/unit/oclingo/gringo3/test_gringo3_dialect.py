"""Detecting the dialect of a text: gringo 3 or clingo 5."""

import pytest

from rosoclingo.oclingo.gringo3 import Dialect, translate, translate_program

GRINGO3 = [
    "{ a, b }.",
    "{ a : b : c }.",
    ":- a : b, c : d.",
    "1 [ a=1 ] 2.",
    "p(X) :- X := 1.",
    "p(a,1;;b,2).",
    "#hide.",
    "#domain p(X).",
    "p(X #mod 2) :- q(X).",
    ":- X = #count { not a }.",
    "#external p(X) : q(X) : r(X).",
    "#minimize { a : b : c }.",
    ":- 1 < #sum { <X> : p(X) }.",
    ":~ a. <2:1>",
]
CLINGO5 = [
    ":- a; b.",
    "a ; b.",
    "{ a ; b }.",
    ":- a : b, c; d.",
    "{ a } = 1.",
    ":- 1 != #count { X : a }.",
    ":- not &sum { x } <= 3.",
    "&diff { a - b } <= 3.",
    ":- X == #sum { 1 : a }.",
    ":- X = #sum { Y : p(Y) }.",
    ":~ a. [1@2]",
    "#external p(X) : q(X), r(X).",
    "#show X : p(X).",
    "#show p(X) : q(X), r.",
    "#minimize { 1,X : p(X) }.",
    ":- not not a.",
    ":- 1 < X < 3, p(X).",
    "#defined p/1.",
    "#script (python) x = 1. #end.",
    "#theory t { x { - : 1, unary }; &a/0 : x, head }.",
]
EITHER = [
    "p(1..3).",
    "p(a;b).",
    "1 { p(X) : q(X) } 1 :- r.",
    "a :- b, not c, X < 3, X = Y + 1.",
    ":- p(X) : q(X).",
    "a | b.",
    "#const n = 3.",
    "#cumulative t.",
    "#forget t : t - 3.",
    "#program step(t).",
    "#external p(X;Y) : q(X).",
    'p("a : b : c").',
    "q(#inf).".replace("#inf", "#infimum"),
    "p(X) :- X = #count { p(Y) : q(Y) }.".replace("#count ", ""),
    "1 <= { a } < 2 :- not 1 == { b }, X > { c } >= Y, { d } == X.",
]
CONFLICT = [
    ":- a : b, c.",
    "{ a : b, c }.",
    ":- p(X;Y), q(X), r(Y).",
    "p(a,1;2).",
    "a(1..2) | b.",
    "a(1..2) : b.",
    "#show p/1.",
    "#show p(X) : q(X).",
    "#minimize { a : b }.",
    ":- X = #count { p(Y) : q(Y) }.",
    "#external p(left;right, t).",
    "{ p(1;2) : q(X;Y) }.",
]


@pytest.mark.parametrize("text", GRINGO3)
def test_dialect_of_gringo_3_statements_is_detected(text):
    assert translate(text, "x.lp").dialect is Dialect.GRINGO3


@pytest.mark.parametrize("text", [*CLINGO5, *EITHER])
def test_translate_leaves_statements_of_clingo_5_unchanged(text):
    result = translate(text, "x.lp", Dialect.GRINGO3)
    assert (result.text, result.warnings) == (text, ())


@pytest.mark.parametrize("text", CONFLICT)
def test_translate_resolves_ambiguous_statements_by_dialect(text):
    assert translate(text, "x.lp").text == text
    assert translate(text, "x.lp", Dialect.GRINGO3).text != text


CONFLICTING = ":- a : b, c.\n"
AS_GRINGO3 = ":- a : b; c.\n"


@pytest.mark.parametrize(
    ("more", "gringo3"),
    [
        ("#cumulative t.\n", True),
        ("#base.\n", True),
        ("#iinit 0.\n", True),
        ("#program base.\n", False),
        ("#cumulative t.\nx :- y; z.\n", False),
        ("#hide.\nx :- y; z.\n#cumulative t.\n", True),
        ("#hide.\nx :- y; z.\n#program base.\n", False),
        ("% dialect: gringo 3\nx :- y; z.\n", True),
        ("% dialect: clingo 5\n#cumulative t.\n", False),
        ("x.\n", False),
    ],
)
def test_ambiguous_statement_follows_the_rest_of_its_file(more, gringo3):
    result = translate(more + CONFLICTING, "x.lp")
    assert (AS_GRINGO3 if gringo3 else CONFLICTING) in result.text


def test_translate_converts_gringo_3_statements_in_any_file():
    text = "#program base.\nx :- a; b.\nf(1). #domain f(X).\nq(X) :- g, X := 1.\n#hide x/0.\n:- a : b, c.\n"
    lines = translate(text, "x.lp").text.splitlines()
    assert lines[:-1] == [
        "#program base.",
        "x :- a; b.",
        "f(1). ",
        "q(X) :- g, X = 1, f(X).",
        "#show. #show f/1. #show q/1.",
        ":- a : b, c.",
    ]
    assert translate(text + "% dialect: clingo 5", "x.lp").text == text + "% dialect: clingo 5"


def test_ambiguous_file_is_clingo_5_with_a_warning():
    result = translate("x.\n" + CONFLICTING, "x.lp")
    assert result.text == "x.\n" + CONFLICTING
    (warning,) = result.warnings
    assert warning.startswith("x.lp:2:9: gringo 3 reads this line as ':- a : b; c.'; read as clingo 5")


@pytest.mark.parametrize("text", ["p(1). #show p/1.", "p(1).", "a :- b; c."])
def test_translate_does_not_warn_about_unambiguous_text(text):
    assert translate(text, "x.lp").warnings == ()


def test_ambiguous_file_follows_the_other_files():
    results = translate_program([("a.lp", CONFLICTING), ("b.lp", "#hide.")])
    assert results[0].text.startswith(AS_GRINGO3)
    results = translate_program([("a.lp", CONFLICTING), ("b.lp", ":- x; y.")], Dialect.GRINGO3)
    assert results[0].text == CONFLICTING


def test_translation_with_ambiguous_text_names_its_dialect():
    once = translate("#cumulative t.\n{ a : b : c }.", "x.lp").text
    assert once == "#cumulative t.\n{ a : b, c }.\n% dialect: clingo 5\n"
    assert translate(once, "x.lp", Dialect.GRINGO3).text == once
