"""Similar names: misspelt ones and those of a series; statements that end too late."""

import lint_programs
import pytest

from rosoclingo.oclingo.program.likeness import is_misspelling, likely_value
from rosoclingo.oclingo.program.sources import Source

END = "\n#program cumulative(t).\n#program volatile(t).\n"


def misspelt(pair):
    """Return the verdicts on a pair of names, in both orders."""
    return {is_misspelling(*names) for names in (pair.split(), pair.split()[::-1])}


@pytest.mark.parametrize(
    "pair",
    [
        "office2 offcie2",
        "kitchen kithen",
        "livingroom living_room",
    ],
)
def test_is_misspelling_finds_misspelt_names(pair):
    assert misspelt(pair) == {True}


@pytest.mark.parametrize(
    "pair",
    [
        "office1 office2", "office office1", "office1 office11", "lamp lamps", "room_a room_b", "a_room b_room",
        "bed red", "left lift", "table table", "north south", "arm_x_1 arm_y_1", "rooma roomb",
    ],
)  # fmt: skip
def test_is_misspelling_accepts_names_of_a_series(pair):
    assert misspelt(pair) == {False}


@pytest.mark.parametrize(
    "text",
    [
        "room(room_a). room(room_b). room(room_c). door(room_a,room_b). :- door(A,B), not room(A).",
        "link(a,b). link(b,c). link(B,A) :- link(A,B). :- link(A,B), link(B,A), A = B.",
        "p(1). q(1). r(1). p(X) ; q(X) :- r(X). p(X) : r(X); q(X).",
        "asleep(1). does(sleep). does(wake). can(sleep). is(asleep) :- asleep(1). :- is(X), does(X), can(X).",
        "near(C',D). near(C,D'). near(C,D) :- near(C',D), near(D,C). :- near(C,C'), near(D',C).",
    ],
)
def test_lint_accepts_similar_names_and_marks(text):
    kinds = {"mark", "misspelt", "exchanged"}
    assert [str(one) for one in lint_programs.lint([Source("a.lp", text + END)]) if one.fault.kind in kinds] == []


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("a :- b\nc :- d.", "1:7: a dot"),
        ("a :- b(X),\n  % so\n\n:- c.", "1:10: a comma"),
        ("a :- b, c.\nd :- e,\n\nf(X,Y) :- g.", "2:7: a comma"),
        ("{ a; b } 1 :- c,\n#show a/0.", "1:16: a comma"),
        ("a(1)\nb(2). c.", "1:5: a dot"),
    ],
)
def test_lint_finds_where_a_statement_should_end(text, place):
    found = [str(one) for one in lint_programs.lint([Source("a.lp", text + END)])]
    assert [one.partition(" is")[0].partition(" stands")[0] for one in found] == [f"a.lp:{place}"]


@pytest.mark.parametrize(
    ("text", "known", "hint"),
    [
        ("att(sink)", ["at(_)", "place(sink)"], "did you mean at(sink)?"),
        ("held", ["held(_)"], "did you mean held(_)?"),
        ("moon", ["at(_)"], "known: at(_)"),
    ],
)
def test_likely_value_ignores_open_arguments(text, known, hint):
    assert likely_value(text, known) == hint
