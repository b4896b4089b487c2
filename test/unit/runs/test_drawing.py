"""The drawings that a program requests on the map."""

import pytest
from published_runs import program_of

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.runs.drawing import Drawing, DrawingKind, drawings_of
from rosoclingo.runs.recorded_run import RunProgram

LABELS = {"a", "b", "c", "room(1,2)"}
TEXT = """
#program base.
_draws(path,way). _draws(gate,blocked,"shut by {}"). _draws(stands,thing). _draws(holds,carried).
_draws(dirty,mark). _draws(warm,mark,"{} degrees"). _draws(me,robot). _draws(free,open).
path(a,b). path(X,c) :- path(a,X). path(a,nowhere). path(b;c).
#program cumulative(t).
#external _request/2.
"""
PATH = Drawing(DrawingKind.WAY, ("a", "b"), "")


def drawings(text):
    return drawings_of(RunProgram.of("run", ReactiveProgram.from_text(text), {}))


@pytest.fixture(scope="module")
def declared():
    return drawings(TEXT)


@pytest.mark.parametrize(
    ("atom", "drawn"),
    [
        ("gate(wind,b,a,now)", Drawing(DrawingKind.BLOCKED, ("b", "a"), "shut by wind")),
        ("gate(a,b,c,now)", Drawing(DrawingKind.BLOCKED, ("a", "b"), "shut by")),
        ("free(a,room(1,2))", Drawing(DrawingKind.OPEN, ("a", "room(1,2)"), "")),
        ('stands("a cup",room(1,2),now)', Drawing(DrawingKind.THING, ("room(1,2)",), "a cup")),
        ("stands(a,now)", Drawing(DrawingKind.THING, ("a",), "stands")),
        ("holds(cup,b,now)", Drawing(DrawingKind.CARRIED, (), "cup")),
        ("dirty(b,now)", Drawing(DrawingKind.MARK, ("b",), "dirty")),
        ("warm(21,c,now)", Drawing(DrawingKind.MARK, ("c",), "21 degrees")),
        ("me(c,now)", Drawing(DrawingKind.ROBOT, ("c",), "")),
    ],
)
def test_drawing_of_an_atom_follows_its_declaration(declared, atom, drawn):
    assert declared.of([atom], LABELS) == [PATH, drawn]


@pytest.mark.parametrize(
    "atom", ["gate(a,now)", "me(now)", "me(elsewhere,now)", "other(a,b)", "gate(a,b", "-gate(a,b)", ""]
)
def test_drawing_with_missing_or_unknown_labels_is_skipped(declared, atom):
    assert declared.of([atom], LABELS) == [PATH]


def test_drawing_of_each_thing_is_unique_and_uses_labels(declared):
    assert declared.of(["stands(cup,a,now)", "stands(cup,now,a)"], LABELS)[1:] == [
        Drawing(DrawingKind.THING, ("a",), "cup")
    ]
    assert declared.of(["stands(cup,a,now)"], {"b"}) == []
    assert declared.of([], {"a", "b"}) == [PATH]


@pytest.mark.parametrize(
    ("fact", "fault"),
    [
        ("_draws(x)", "write _draws(Predicate,Kind) or _draws(Predicate,Kind,Text)"),
        ("_draws(x,nothing)", "nothing is not a kind: write one of way, open, blocked, thing, carried, mark, robot"),
        ("_draws(x,way,text)", 'the text has to be a string, write "text"'),
    ],
)
def test_drawing_declaration_that_is_malformed_is_reported(fact, fault):
    found = drawings_of(program_of(f"{fact}. x(a,b). _draws(y,mark). y(a)."))
    assert found.faults == (f"{fact} draws nothing: {fault}",)
    assert found.of([], LABELS) == [Drawing(DrawingKind.MARK, ("a",), "y")]


def test_drawing_ignores_a_program_that_cannot_be_read():
    assert drawings_of(program_of("_draws(x,way). x(a,b). ((")).of(["x(a,b)"], LABELS) == []


def test_drawing_of_initial_facts_ends_with_the_first_belief():
    found = drawings(TEXT + "stands(cup,a,0). #program cumulative(t). stands(cup,b,t) :- t > 1.")
    assert found.of([], LABELS)[1:] == [Drawing(DrawingKind.THING, ("a",), "cup 0")]
    assert found.of(["stands(cup,b,now)"], LABELS) == [PATH, Drawing(DrawingKind.THING, ("b",), "cup")]
    assert found.of([], LABELS) == [PATH]
