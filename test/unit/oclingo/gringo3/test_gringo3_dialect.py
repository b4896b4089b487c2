"""Detecting the dialect of a text: gringo 3 or clingo 5."""

import pytest

from rosoclingo.oclingo.gringo3 import Dialect, translate, translate_program

GRINGO3 = [
    "{ a, b }.",
    ":- a : b, c : d.",
    "p(X) :- X := 1.",
    "p(a,1;;b,2).",
    "#domain p(X).",
    ":- X = #count { not a }.",
    "#external p(X) : q(X) : r(X).",
    ":- 1 < #sum { <X> : p(X) }.",
]
CLINGO5 = [
    "{ a } = 1.",
    ":- 1 != #count { X : a }.",
    "&diff { a - b } <= 3.",
    ":~ a. [1@2]",
    "#external p(X) : q(X), r(X).",
    "#show X : p(X).",
    "#minimize { 1,X : p(X) }.",
    "#defined p/1.",
    "#theory t { x { - : 1, unary }; &a/0 : x, head }.",
]
EITHER = [
    "a :- b, not c, X < 3, X = Y + 1.",
    "#const n = 3.",
    "#forget t : t - 3.",
    'p("a : b : c").',
    "p(X) :- X = #count { p(Y) : q(Y) }.".replace("#count ", ""),
    "1 <= { a } < 2 :- not 1 == { b }, X > { c } >= Y, { d } == X.",
]
CONFLICT = [
    ":- a : b, c.",
    ":- p(X;Y), q(X), r(Y).",
    "a(1..2) | b.",
    "#show p/1.",
    "#minimize { a : b }.",
    ":- X = #count { p(Y) : q(Y) }.",
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
        ("#program base.\n", False),
        ("#hide.\nx :- y; z.\n#cumulative t.\n", True),
        ("% dialect: gringo 3\nx :- y; z.\n", True),
        ("% dialect: clingo 5\n#cumulative t.\n", False),
        ("x.\n", False),
    ],
)
def test_ambiguous_statement_follows_the_rest_of_its_file(more, gringo3):
    result = translate(more + CONFLICTING, "x.lp")
    assert (AS_GRINGO3 if gringo3 else CONFLICTING) in result.text


def test_ambiguous_file_is_clingo_5_with_a_warning():
    result = translate("x.\n" + CONFLICTING, "x.lp")
    assert result.text == "x.\n" + CONFLICTING
    (warning,) = result.warnings
    assert warning.startswith("x.lp:2:9: gringo 3 reads this line as ':- a : b; c.'; read as clingo 5")


def test_ambiguous_file_follows_the_other_files():
    results = translate_program([("a.lp", CONFLICTING), ("b.lp", "#hide.")])
    assert results[0].text.startswith(AS_GRINGO3)
    results = translate_program([("a.lp", CONFLICTING), ("b.lp", ":- x; y.")], Dialect.GRINGO3)
    assert results[0].text == CONFLICTING


def test_translation_with_ambiguous_text_names_its_dialect():
    once = translate("#cumulative t.\n{ a : b : c }.", "x.lp").text
    assert once == "#cumulative t.\n{ a : b, c }.\n% dialect: clingo 5\n"
    assert translate(once, "x.lp", Dialect.GRINGO3).text == once
