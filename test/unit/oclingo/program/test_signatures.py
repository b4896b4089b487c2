"""Occurrences of atoms in statements, values of terms, and reachability; clingo is the reference for values."""

import clingo
import pytest
from clingo.ast import parse_string
from hypothesis import example, given
from hypothesis import strategies as st

from rosoclingo.oclingo.program.signatures import (
    Signature,
    atoms_in,
    evaluate,
    term_signature,
)
from rosoclingo.oclingo.reachable import reachable


def statement(text):
    found = []
    parse_string(text, found.append)
    return found[-1]


def marked_atoms(text):
    """Return the atoms of a statement: h marks heads, + positive body atoms, - other atoms."""
    marks = {(True, False): "h", (False, True): "+", (False, False): "-"}
    return sorted(
        marks[head, positive] + str(term_signature(term)) for term, head, positive in atoms_in(statement(text))
    )


@pytest.mark.parametrize(
    ("text", "atoms"),
    [
        ("-a(X) :- b(X), not c, not not d.", "h-a/1 +b/1 -c/0 -d/0"),
        ("a(1;2,3) :- b(1,2;3).", "ha/1 ha/2 +b/1 +b/2"),
        ("#sum { X,a : a(X) : b(X), not c } 3 :- d.", "ha/1 +b/1 -c/0 +d/0"),
        ("&sum { X : a(X) } < 3 :- b.", "+b/0"),
        ("a :- &sum { X : b(X), not c } < 3.", "ha/0 +b/1 -c/0"),
        ("a :- b : c, not d.", "ha/0 +b/0 +c/0 -d/0"),
        ("a :- X = #count { Y : b(Y) }, X < 2.", "ha/0 +b/1"),
        ("#show X : a(X), not b.", "+a/1 -b/0"),
        (":~ a(X), not b. [X]", "+a/1 -b/0"),
    ],
)
def test_occurrences_classify_all_atoms_of_statements(text, atoms):
    assert marked_atoms(text) == sorted(atoms.split())


CONSTANTS = {"n": clingo.Number(3), "word": clingo.Function("text")}
LEAVES = st.one_of(st.integers(-20, 20).map(str), st.sampled_from(["n", "n", "n", "word", "c", '"s"', "-c", "#inf"]))
TERMS = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.builds("({}{}{})".format, inner, st.sampled_from(["+", "-", "*", "/", "\\", "**", "&", "?", "^"]), inner),
        st.builds("{}({})".format, st.sampled_from("-~"), inner),
        inner.map("|{}|".format),
    ),
    max_leaves=5,
)


def value_of(text):
    """Return clingo's value of a term, or None."""
    control = clingo.Control(["-cn=3", "-cword=text", "--warn=none"], logger=lambda code, message: None)
    control.add("base", [], f"v({text}).")
    control.ground([("base", [])])
    return next((one.symbol.arguments[0] for one in control.symbolic_atoms.by_signature("v", 1)), None)


@given(TERMS)
@example("2**n")
def test_evaluate_agrees_with_clingo_on_arithmetic(text):
    """Powers and values beyond 32 bits can be left to clingo."""
    value, expected = evaluate(statement(f"v({text}).").head.atom.symbol.arguments[0], CONSTANTS), value_of(text)
    assert value is None or value == expected
    if expected is not None and expected.type is clingo.SymbolType.Number and abs(expected.number) < 1000:
        assert value == expected or ("**" in text and text != "2**n")


NODES = [Signature(name, 0) for name in "abcdef"]
EDGES = st.lists(st.tuples(st.sampled_from(NODES), st.sampled_from(NODES)), max_size=9)


@given(EDGES, st.sampled_from(NODES))
def test_reachable_agrees_with_a_transitive_closure(edges, source):
    expected = {source}
    for _ in NODES:
        expected |= {head for head, body in edges if body in expected}
    assert reachable([source], lambda one: [head for head, body in edges if body == one]) == expected
