"""Which steps are decided for good, as a grounding shows, and what a stream would lose by a wrong verdict."""

import pytest
from stream_play import atoms, planner_of, play

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, fact, parse_atom
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.planning.fixed_atoms import look
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Question
from rosoclingo.planning.snapshot import Snapshot, Told

MARKS = "#theory marks { term { - : 1, unary }; &mark/0 : term, any }. "
FACTS = "#program cumulative(t). p(t). q(t) :- p(t-1), not r(t). { r(t) }. :- not r(t)."


def grounded(text, *blocks, settled=1, told=()):
    """A grounding of a program that has grown block by block."""
    program = ReactiveProgram.from_text(text)
    first, *rest = blocks
    grounding = Grounding(program, Snapshot(horizon=first, settled=settled, told=told), first)
    for last in rest:
        grounding.grow_to(last)
    grounding.settle()
    return grounding


def undecided(text, blocks, before, settled=9, start=1):
    """Return the first step that is not decided of a program that is ground in the given blocks."""
    return look(grounded(text, *blocks, settled=min(settled, blocks[-1])), start, before).first


@pytest.mark.parametrize(
    ("blocks", "before", "first"),
    [
        ((1, 2, 3), 4, 4),
        ((1, 2, 3), 3, 3),
        ((1, 3, 5), 6, 6),
        ((1, 3, 5), 5, 4),
        ((3,), 3, 1),
        ((3,), 2, 1),
        ((1,), 9, 2),
    ],
)
def test_blocks_are_decided_as_a_whole(blocks, before, first):
    assert undecided(FACTS, blocks, before) == first


@pytest.mark.parametrize(
    "rule",
    [
        "{ p(3) } :- t = 3.",
        "#external e(3) : t = 3.",
        ":- t = 3, #sum { 1,x : a ; 1,y : b } > 1.",
        "c(t) :- t = 3, a.",
    ],
)
def test_step_with_an_open_atom_is_not_decided(rule):
    assert undecided(f"{{ a ; b }}. #program cumulative(t). s(t). {rule} #program volatile(t).", (1, 2, 3, 4), 5) == 3


@pytest.mark.parametrize(
    "text",
    [
        "#program cumulative(t). #edge (t,t+1). #program volatile(t).",
        MARKS + "#program cumulative(t). s(t) :- &mark. #program volatile(t).",
        MARKS + "&mark. #program cumulative(t). s(t). #program volatile(t).",
    ],
)
@pytest.mark.parametrize("first", [1, 0, -3])
def test_nothing_is_decided_with_edges_or_theory_atoms(text, first):
    assert undecided(f"#iinit {first}. {text}", (first, 2, 3), 4, start=first) == first


def test_nothing_is_fixed_in_a_contradiction():
    fixed = look(grounded("{ a ; b }. b :- a. :- a, b. :- not a. " + FACTS, 3), 1, 3)
    assert (fixed.first, fixed.values, fixed.literals) == (1, {}, {})


def test_later_steps_leave_what_was_read_as_it_is():
    text = "{ a }. " + FACTS.replace("p(t).", "p(t). :- a, t = 3. :- s(t+1). { s(t+1) }.")
    grounding = grounded(text, 2)
    fixed = look(grounding, 1, 2)
    first, values = fixed.first, dict(fixed.values)
    grounding.grow_to(3)
    assert grounding.ask(Question(3, 3), lambda: False).satisfiable
    assert (fixed.first, fixed.values) == (first, values)


@pytest.mark.parametrize("offset", range(-3, 4))
@pytest.mark.parametrize("name", ["t", "T"])
def test_ends_of_horizons_keep_no_step_open(name, offset):
    cycle = f"{name}+{offset}"
    text = f"{{ _action_lib(go,x,{cycle}) }} :- now(T), T = t. :- _action_lib(_,_,{cycle}), now(T), T = t."
    for settled in (3, 4, 5):
        found = undecided(f"#program cumulative(t). now(t). {text}", (1, 2, 3, 4, 5), 6, settled)
        assert found == min(settled - offset, 5) + 1


@pytest.mark.usefixtures("compacts_at_once")
def test_constraints_on_choices_of_base_hold_for_good():
    text = "{ a ; b }. #program cumulative(t). :- t = 1, #sum { 1,x : a ; 1,y : b } > 1. #program volatile(t)."
    stream = planner_of(text, models=0)
    for step in (1, 2, 3, 4):
        assert len(play(stream, f"#step {step}. #over {step}.").answers) == 3


@pytest.mark.usefixtures("compacts_at_once")
def test_definition_that_lapses_later_is_still_seen():
    stream = planner_of("#program cumulative(t). #external e(t). late(t) :- e(t-4). #program volatile(t).")
    play(stream, "#step 1. #volatile : 9. e(1).")
    for step in (2, 3, 4, 5):
        found = atoms(play(stream, f"#step {step}. #over {step}."))
    assert found == ["e(1)", "late(5)"]


@pytest.mark.usefixtures("compacts_at_once")
def test_stream_keeps_a_contradiction():
    stream = planner_of("#program cumulative(t). 1 { _action_lib(go,x,t) } 1. #program volatile(t).")
    play(stream, "#step 1.")
    assert play(stream, "#step 2 : 0. #closed 1. #over 2.").outcome is SolveOutcome.UNSATISFIABLE


@pytest.mark.parametrize(
    ("section", "end", "permanent"),
    [("#volatile.", "", False), ("#assert : r.", "#retract : r.", False), ("", "", True)],
)
def test_contradiction_lasts_if_its_statements_do(section, end, permanent):
    stream = planner_of("{ a }. #cumulative t. #volatile t.")
    result = play(stream, f"#step 1 : 0. {section} :- a. :- not a.")
    assert (result.outcome, result.permanent) == (SolveOutcome.UNSATISFIABLE, permanent)
    expected = SolveOutcome.UNSATISFIABLE if permanent else SolveOutcome.SATISFIABLE
    assert play(stream, f"#step 2 : 0. {end}").outcome is expected


def test_projection_in_base_of_named_atoms_is_read():
    """clingo projects ``_`` under ``not`` by a rule of its own for every atom that it knows."""
    text, atom = "#external q/2. #program cumulative(t). p(t) :- not q(_,t+1).", fact(parse_atom("q(a,3)"))
    assert look(grounded(text, 3, told=(Told(atom, 5, 0),)), 1, 4).first == 1, "q(a,3) is open"
    assert look(grounded(text, 3, told=(Told(atom, FOREVER, 0),)), 1, 4).first == 4


def test_remarks_of_clingo_are_not_repeated(capfd):
    assert look(grounded(FACTS + " c(X) :- X = 2/(t-2).", 3), 1, 4).first == 4
    assert capfd.readouterr() == ("", "")
