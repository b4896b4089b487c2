"""Online progressions: parsing, printing, and errors with line and column."""

import clingo
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo import (
    Assert,
    Cumulative,
    Forget,
    Literal,
    ProgressionError,
    Retract,
    Statement,
    StreamUpdate,
    Volatile,
    commitment,
    fact,
    parse_atom,
    parse_term,
    parse_update,
    parse_updates,
)
from rosoclingo.oclingo.progression.terms import MAX_DEPTH
from rosoclingo.oclingo.progression.updates import CloseCycles, Expire, Reset, Withdraw

IDENTIFIERS = st.from_regex(r"_{0,2}[a-z][A-Za-z0-9_']{0,5}", fullmatch=True).filter(lambda name: name != "not")
LEAVES = st.one_of(
    st.integers(-(2**31), 2**31 - 1).map(clingo.Number),
    st.builds(clingo.Function, IDENTIFIERS, st.just([]), st.booleans()),
    st.sampled_from([clingo.Infimum, clingo.Supremum]),
    st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=5).map(clingo.String),
)
TERMS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.builds(clingo.Function, IDENTIFIERS, st.lists(inner, min_size=1, max_size=3), st.booleans()),
        st.lists(inner, max_size=3).map(lambda arguments: clingo.Function("", arguments)),
    ),
    max_leaves=8,
)
ATOMS = st.builds(clingo.Function, IDENTIFIERS, st.lists(TERMS, max_size=3), st.booleans())
LITERALS = st.builds(Literal, ATOMS, st.booleans())
STATEMENTS = st.builds(Statement, st.one_of(st.none(), ATOMS), st.lists(LITERALS, max_size=3).map(tuple))
NUMBERS = st.integers(0, 2**31 - 1)
ITEMS = st.one_of(
    STATEMENTS,
    st.just(Cumulative()),
    st.builds(Volatile, st.one_of(st.none(), NUMBERS)),
    st.builds(Assert, TERMS),
    st.builds(Retract, TERMS),
    st.builds(Forget, NUMBERS, NUMBERS),
    st.builds(CloseCycles, NUMBERS, NUMBERS),
    st.builds(Expire, NUMBERS),
    st.builds(Withdraw, ATOMS),
    st.just(Reset()),
)
UPDATES = st.one_of(
    st.builds(StreamUpdate, NUMBERS, st.one_of(st.none(), NUMBERS), st.lists(ITEMS, max_size=5).map(tuple)),
    st.builds(StreamUpdate, st.none(), st.none(), st.lists(ITEMS, max_size=5).map(tuple)),
)


@given(UPDATES)
def test_parse_update_inverts_str_of_updates(update):
    assert parse_update(str(update)) == update


@pytest.mark.slow
@given(st.lists(UPDATES, max_size=3))
def test_parse_updates_reads_several_updates(updates):
    assert parse_updates("".join(map(str, updates))) == updates


@given(TERMS, ATOMS)
def test_parsers_of_terms_and_atoms_invert_str(term, atom):
    assert parse_term(str(term)) == term
    assert parse_atom(str(atom)) == parse_atom(f" {atom} . ") == atom


@pytest.mark.parametrize(
    ("text", "term"),
    [
        ("0" * 30 + "1234567890", clingo.Number(1234567890)),
        (r'"a\\nb"', clingo.String("a\\nb")),
        (r'"\n\"\\"', clingo.String('\n"\\')),
        ("(1,)", clingo.Function("", [clingo.Number(1)])),
        (
            "f((1,2),3)",
            clingo.Function("f", [clingo.Function("", [clingo.Number(1), clingo.Number(2)]), clingo.Number(3)]),
        ),
    ],
)
def test_parse_term_reads_every_form(text, term):
    assert parse_term(text) == term


@pytest.mark.parametrize(
    "text", ["f()", "f(1,)", "(,)", "f((1,)", "f(1))", "1.", "-(1)", '-"a"', "2147483648", "-2147483649"]
)
def test_parse_term_rejects_invalid_terms(text):
    with pytest.raises(ProgressionError):
        parse_term(text)


SOUP = st.lists(
    st.sampled_from(
        ["#step 1.", "#endstep.", "a(", ")", ",", '"', "%*", "*%", "not", ":-", ".", "-", "9" * 12, "X", "#assert"]
    ),
    max_size=12,
).map(" ".join)


@given(st.one_of(st.text(max_size=60), SOUP))
def test_parser_raises_only_progression_errors(text):
    for read in (parse_updates, parse_update, parse_term, parse_atom):
        error = None
        try:
            read(text)
        except ProgressionError as caught:
            error = caught
        assert error is None or (min(error.line, error.column) >= 1 and str(error).endswith(error.message))


def test_parse_update_reads_every_kind_of_statement():
    update = parse_update(
        "% a line\n#step 1   :   0   . %* a %* nested *% block *% e(1) .  :- not   a . % end\n"
        '-p("a b\\"",f(x,-2)):-a,not b. #volatile:3. :- . #volatile. #cumulative. #forget 1..3. #forget 4.\n'
        "#assert : x(1). p. #retract : y. #end  step."
    )
    assert update == StreamUpdate(
        1,
        0,
        (
            fact(parse_term("e(1)")),
            commitment(parse_term("a")),
            Statement(
                clingo.Function("p", [clingo.String('a b"'), parse_term("f(x,-2)")], False),
                (Literal(parse_term("a")), Literal(parse_term("b"), False)),
            ),
            Volatile(3),
            Statement(None),
            Volatile(),
            Cumulative(),
            Forget(1, 3),
            Forget(4, 4),
            Assert(parse_term("x(1)")),
            fact(parse_term("p")),
            Retract(parse_term("y")),
        ),
    )


def test_second_step_directive_is_ignored_with_a_warning():
    update = parse_update("#step 1 : 2.\n#step 3.\n#endstep.")
    assert (update.step, update.bound) == (1, 2)
    assert len(update.warnings) == 1
    assert "#step 3." in update.warnings[0]


@pytest.mark.parametrize(
    ("text", "place", "words"),
    [
        (
            "#step 1.\ne(X).\n#endstep.",
            (2, 3),
            'X is a variable, since it begins with a capital letter: write a value, such as x or "X"',
        ),
        ("#step 1. Open(1). #endstep.", (1, 10), "Open begins with a capital letter, as only variables do: write open"),
        ("a.\n", (2, 1), "#endstep"),
        ("a b.", (1, 3), "expected '.' to end the statement, found 'b'"),
        ("#foo.", (1, 1), "unknown directive"),
        ("e(2147483648). #endstep.", (1, 3), "32 bits"),
        ('p("abc', (1, 3), "unterminated string"),
        ("a. %* x\n\n *%\n  § ", (4, 3), "unexpected character"),
        ("e(" + "9" * 21 + ").", (1, 3), f"number {'9' * 20}... does not fit"),
        ('a.\nb.\n p("\0").', (3, 4), "invalid character"),
        ('a.\n"." ', (2, 1), "atom"),
        ("  %* x", (1, 3), "unterminated comment"),
        ("p(- .).", (1, 5), "number"),
        ("#step x.", (1, 7), "number"),
        ("p(" * 1000, (1, 2 * MAX_DEPTH + 1), "nested deeper"),
    ],
)
def test_parser_errors_have_line_and_column(text, place, words):
    with pytest.raises(ProgressionError) as caught:
        parse_updates(text)
    assert (caught.value.line, caught.value.column) == place
    assert words in caught.value.message


def test_parse_update_expects_exactly_one_update():
    with pytest.raises(ProgressionError, match="found 2"):
        parse_update("#endstep. #endstep.")
    with pytest.raises(ProgressionError, match="found 0"):
        parse_update("")
