"""The steps whose rules can match an atom: a superset of those that clingo grounds, limited by comparisons."""

import clingo
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.oclingo import ReactiveProgram, parse_atom

STEPS, VALUES = range(1, 9), [*map(str, range(-3, 12)), "a", '"text"', "f(3)", "#sup"]
NUMBERS = st.integers(-4, 9)
TERMS = st.recursive(
    st.one_of(st.sampled_from(["t", "T", "n", "t", "T"]), NUMBERS.map(str)),
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(lambda one: "({}{}{})".format(*one)),
        inner.map("-({})".format),
    ),
    max_leaves=4,
)
OPERATORS = st.sampled_from(["<", "<=", ">", ">=", "=", "!="])


def seen(comparison):
    """Return the pairs of T and step for which clingo grounds a rule with the comparison."""
    control = clingo.Control(["--warn=none", "-cn=3"], logger=lambda code, text: None)
    control.add("base", [], " ".join(f"d({value})." for value in VALUES))
    control.add("step", ["t"], f"hit(T,t) :- d(T), {comparison}.")
    control.ground([("base", []), *(("step", [clingo.Number(step)]) for step in STEPS)])
    return {tuple(one.symbol.arguments) for one in control.symbolic_atoms.by_signature("hit", 2)}


def could_see(comparison):
    """Return the pairs of T and step that the program reports without grounding."""
    text = f"#program cumulative(t).\n#external d/1.\nhit(T,t) :- d(T), {comparison}.\n#program volatile(t).\n"
    program = ReactiveProgram.from_text(text, constants={"n": "3"})
    atoms = [parse_atom(f"d({value})") for value in VALUES]
    pairs = [(atom, step) for atom in atoms for step in STEPS if program.can_see([atom], step, step)]
    return {(atom.arguments[0], clingo.Number(step)) for atom, step in pairs}


@given(st.tuples(TERMS, OPERATORS, TERMS))
def test_can_see_includes_all_atoms_that_clingo_grounds(sides):
    text = " ".join(sides)
    assert seen(text) <= could_see(text)


@pytest.mark.parametrize(
    ("comparison", "age"),
    [
        ("0 <= t-T < n", 2),
        ("-(T-t) <= 1", 1),
        ("t < T+5, t < T+2", 1),
    ],
)
def test_can_see_is_limited_by_comparisons(comparison, age):
    numbers = {pair for pair in could_see(comparison) if pair[0].type is clingo.SymbolType.Number}
    assert numbers == {
        (clingo.Number(value), clingo.Number(step)) for value in range(-3, 12) for step in STEPS if step - value <= age
    }


@pytest.mark.parametrize(
    ("written", "atom", "steps"),
    [
        ("d(t)", "d(3)", {3}),
        ("d(T,t)", "d(x,2)", {2}),
        ("d(f(t))", "d(f(3))", set(STEPS)),  # arguments of terms are not inspected: any step matches
        ("d(f(1,2))", "d(f(1))", set()),
        ("d(-f(1))", "d(-g(1))", set()),
    ],
)
def test_can_see_matches_atoms_with_body_patterns(written, atom, steps):
    text = f"#program cumulative(t).\n#external d/1. #external d/2.\nhit(t) :- {written}.\n#program volatile(t).\n"
    program = ReactiveProgram.from_text(text.replace("T", "_"), constants={"n": "3"})
    assert {step for step in STEPS if program.can_see([parse_atom(atom)], step, step)} == steps
