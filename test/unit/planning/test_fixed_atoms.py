"""Up to which step all atoms are fixed, as a grounding shows."""

import pytest

from rosoclingo.oclingo import ReactiveProgram, fact, parse_atom
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.planning.fixed_atoms import fixed_atoms
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.snapshot import Snapshot, TimedStatement

MARKS = "#theory marks { term { - : 1, unary }; &mark/0 : term, any }. "
FACTS = "#program cumulative(t). p(t). q(t) :- p(t-1), not r(t). { r(t) }. :- not r(t)."


def first_open(text, blocks, before, told=()):
    """The first step that is not fixed of a program that has grown block by block."""
    first, *rest = blocks
    snapshot = Snapshot(horizon=first, items=told)
    grounding = Grounding(ReactiveProgram.from_text(text), snapshot, first)
    for last in rest:
        grounding.grow_to(last)
    return fixed_atoms(grounding, before, set()).first


@pytest.mark.parametrize(
    ("blocks", "before", "first"),
    [
        ((1, 2, 3), 4, 4),
        ((1, 2, 3), 3, 3),
        ((1, 3, 5), 6, 6),
        ((1, 3, 5), 5, 4),
        ((3,), 3, 1),
        ((1,), 9, 2),
    ],
)
def test_blocks_are_fixed_as_a_whole(blocks, before, first):
    assert first_open(FACTS, blocks, before) == first


@pytest.mark.parametrize(
    "rule",
    [
        "{ p(3) } :- t = 3.",
        "#external e(3) : t = 3.",
        ":- t = 3, #sum { 1,x : a ; 1,y : b } > 1.",
        "c(t) :- t = 3, a.",
    ],
)
def test_step_with_an_open_atom_is_not_fixed(rule):
    text = f"{{ a ; b }}. #program cumulative(t). s(t). {rule}"
    assert first_open(text, (1, 2, 3, 4), 5) == 3


@pytest.mark.parametrize(
    "text",
    [
        "#program cumulative(t). #edge (t,t+1). #program volatile(t).",
        MARKS + "#program cumulative(t). s(t) :- &mark. #program volatile(t).",
        MARKS + "&mark. #program cumulative(t). s(t). #program volatile(t).",
    ],
)
@pytest.mark.parametrize("first", [1, -3])
def test_nothing_is_fixed_with_edges_or_theory_atoms(text, first):
    assert first_open(f"#iinit {first}. {text}", (first, 2, 3), 4) == first


def test_nothing_is_fixed_in_a_contradiction():
    assert first_open("{ a ; b }. b :- a. :- a, b. :- not a. " + FACTS, (3,), 4) == 1


@pytest.mark.usefixtures("compacts_at_once")
@pytest.mark.parametrize("offset", [-3, 0, 1, 3])
@pytest.mark.parametrize("name", ["t", "T"])
def test_ends_of_horizons_keep_no_step_open(name, offset):
    cycle = f"{name}+{offset}"
    text = f"{{ _action_lib(go,x,{cycle}) }} :- now(T), T = t. :- _action_lib(_,_,{cycle}), now(T), T = t."
    program = ReactiveProgram.from_text(f"#program cumulative(t). now(t). {text}")
    for settled in (3, 4, 5):
        grounding = Grounding(program, Snapshot(horizon=5, min_horizon=settled), 5)
        assert fixed_atoms(grounding, 6, set()).first == min(settled - offset, 5) + 1


def test_projection_in_base_of_named_atoms_is_read():
    """clingo projects ``_`` under ``not`` by a rule of its own for every atom that it knows."""
    text, atom = "#external q/2. #program cumulative(t). p(t) :- not q(_,t+1).", fact(parse_atom("q(a,3)"))
    assert first_open(text, (3,), 4, told=(TimedStatement(atom, 5, 0),)) == 1, "q(a,3) is open"
    assert first_open(text, (3,), 4, told=(TimedStatement(atom, FOREVER, 0),)) == 4


def test_remarks_of_clingo_are_not_repeated(capfd):
    assert first_open(FACTS + " c(X) :- X = 2/(t-2).", (3,), 4) == 4
    assert capfd.readouterr() == ("", "")
