"""Which steps are decided for good, looked at in a grounding, and what a stream loses where that is told wrongly."""

import pytest
from test_solver import atoms, play, solver_of

from rosoclingo.oclingo import ReactiveProgram, SolveOutcome, parse_atom
from rosoclingo.oclingo.solving import compaction, solver
from rosoclingo.oclingo.solving.fixed_atoms import look
from rosoclingo.oclingo.solving.grounding import Grounding

MARKS = "#theory marks { term { - : 1, unary }; &mark/0 : term, any }. "
FACTS = "#program cumulative(t). p(t). q(t) :- p(t-1), not r(t). { r(t) }. :- not r(t)."


@pytest.fixture(autouse=True)
def at_once(monkeypatch):
    """Retire whatever can be retired with every update, step by step."""
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 1)
    monkeypatch.setattr(solver, "BLOCK", 1)


def undecided(text, blocks, before, settled=9, start=1):
    """Return the first step that is not decided of a program that is grounded in the given blocks."""
    grounding = Grounding(ReactiveProgram.from_text(text), (), set(), shortest=True)
    for last in blocks:
        grounding.ground_to(last)
    grounding.settle(min(settled, blocks[-1]))
    return look(grounding, start, before).first


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
def test_a_step_that_holds_something_open_is_not_decided(rule):
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
def test_where_rules_do_not_tell_all_nothing_is_decided(text, first):
    assert undecided(f"#iinit {first}. {text}", (first, 2, 3), 4, start=first) == first


def test_of_a_contradiction_nothing_is_told():
    grounding = Grounding(ReactiveProgram.from_text("{ a ; b }. b :- a. :- a, b. :- not a. " + FACTS), (), set(), True)
    grounding.ground_to(3)
    fixed = look(grounding, 1, 3)
    assert (fixed.first, fixed.values, fixed.literals) == (1, {}, {})


def test_what_is_told_is_what_was_fixed_when_it_was_looked_at():
    text = "{ a }. " + FACTS.replace("p(t).", "p(t). :- a, t = 3. :- s(t+1). { s(t+1) }.")
    grounding = Grounding(ReactiveProgram.from_text(text), (), set(), shortest=True)
    grounding.ground_to(2)
    fixed = look(grounding, 1, 2)
    first, values = fixed.first, dict(fixed.values)
    grounding.ground_to(3)
    assert grounding.search(1, lambda: False, 3, 3).satisfiable
    assert (fixed.first, fixed.values) == (first, values)


@pytest.mark.parametrize("offset", range(-3, 4))
@pytest.mark.parametrize("name", ["t", "T"])
def test_the_ends_of_horizons_keep_no_step_open(name, offset):
    cycle = f"{name}+{offset}"
    text = f"{{ _action_lib(go,x,{cycle}) }} :- now(T), T = t. :- _action_lib(_,_,{cycle}), now(T), T = t."
    for settled in (3, 4, 5):
        found = undecided(f"#program cumulative(t). now(t). {text}", (1, 2, 3, 4, 5), 6, settled)
        assert found == min(settled - offset, 5) + 1


def test_constraints_on_what_base_leaves_open_hold_for_good():
    text = "{ a ; b }. #program cumulative(t). :- t = 1, #sum { 1,x : a ; 1,y : b } > 1. #program volatile(t)."
    stream = solver_of(text, shortest=True, models=0)
    for step in (1, 2, 3, 4):
        stream.forget_before(step)
        assert len(play(stream, f"#step {step}.").answers) == 3


def test_a_definition_that_lapses_later_is_still_seen():
    stream = solver_of(
        "#program cumulative(t). #external e(t). late(t) :- e(t-4). #program volatile(t).", shortest=True
    )
    play(stream, "#step 1. #volatile : 9. e(1).")
    for step in (2, 3, 4, 5):
        stream.forget_before(step)
        found = atoms(play(stream, f"#step {step}."))
    assert found == ["e(1)", "late(5)"]


def test_a_stream_that_has_come_to_a_contradiction_keeps_it():
    stream = solver_of("#program cumulative(t). 1 { _action_lib(go,x,t) } 1. #program volatile(t).", shortest=True)
    play(stream, "#step 1.")
    stream.close_cycle(1, [])
    stream.forget_before(2)
    assert play(stream, "#step 2 : 0.").outcome is SolveOutcome.UNSATISFIABLE


def test_a_projection_in_base_of_what_has_a_name_can_be_told():
    """clingo projects ``_`` under ``not`` by a rule of its own for every atom that it knows."""
    text = "#external q/2. #program cumulative(t). p(t) :- not q(_,t+1)."
    grounding = Grounding(ReactiveProgram.from_text(text), [parse_atom("q(a,3)")], set(), shortest=True)
    grounding.ground_to(3)
    assert look(grounding, 1, 4).first == 1, "q(a,3) is open"
    grounding.atoms.close(parse_atom("q(a,3)"))
    assert look(grounding, 1, 4).first == 4


def test_what_clingo_says_of_a_program_is_not_said_again(capfd):
    grounding = Grounding(ReactiveProgram.from_text(FACTS + " c(X) :- X = 2/(t-2)."), (), set(), shortest=True)
    grounding.ground_to(3)
    assert look(grounding, 1, 4).first == 4
    assert capfd.readouterr() == ("", "")
