"""The text below the map in rviz: plan and goals in two columns below a title."""

import pytest

from rosoclingo.nodes.rviz.panel import LETTERS, LINES, goals_text, plan_text
from rosoclingo.oclingo import parse_atom
from rosoclingo.planning.explaining.atom_patterns import pattern_in
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.runs.sentences import PatternSentence, Sentences

TERMS = Sentences()
PLAN = ("move_base,office2", "move_base,office3", "pickup,1", "move_base,office2", "deliver,1")


def actions(words=PLAN):
    return [action_of(parse_atom(f"_action_lib({text},{cycle})")) for cycle, text in enumerate(words, 1)]


def test_rviz_panel_shows_the_plan():
    assert plan_text(actions(), 3, TERMS).splitlines() == [
        "cycle 3: plan",
        "1. move_base office2  done",
        "2. move_base office3  done",
        "3. pickup 1  now",
        "4. move_base office2",
        "5. deliver 1",
    ]
    assert plan_text([], 7, TERMS) == "cycle 7: idle"


def test_rviz_panel_abbreviates_long_plans():
    plan = actions([f"pickup,{number}" for number in range(1, 13)])
    beginning = plan_text(plan, 1, TERMS).splitlines()
    assert (len(beginning), beginning[1], beginning[-1]) == (9, "1. pickup 1  now", "... 5 more")
    middle = plan_text(plan, 4, TERMS).splitlines()
    assert (len(middle), middle[1], middle[-1]) == (9, "3. pickup 3  done", "... 3 more")
    end = plan_text(plan, 12, TERMS).splitlines()
    assert (len(end), end[1], end[-1]) == (9, "5. pickup 5  done", "12. pickup 12  now")


def test_rviz_panel_lists_open_goals_first():
    goals = [
        ("g(1)", 3, "g(1) is met"),
        ("g(2)", 1, "g(2) is accepted"),
        ("g(3)", 5, "g(3) there is no such place"),
        ("g(4)", 0, "at most 8 goals are planned for at a time"),
        ("g(5)", 0, ""),
    ]
    assert goals_text(goals, TERMS).splitlines() == [
        "goals: 3 open, 2 ended",
        "g(2): under way",
        "g(4): queued (at most 8 goals are planned",
        "    for at a time)",
        "g(5): new",
        "g(3): rejected (there is no such place)",
        "g(1): done",
    ]
    assert goals_text([], TERMS) == "goals: none"


def test_rviz_panel_shows_the_sentences_of_the_program():
    patterns = [PatternSentence(pattern_in("goal(_,To,Id)"), "Bring {Id} to {To}")]
    sentences = Sentences({"move_base": "drives to {}"}, patterns, {"office2": "Anna's office"})
    assert plan_text(actions()[:1], 1, sentences) == "cycle 1: plan\n1. drives to Anna's office  now"
    rejected = ("goal(office2,office1,3)", 5, "the program rejects goal(office2,office1,3): office2 is closed")
    assert goals_text([rejected], sentences).splitlines() == [
        "goals: 0 open, 1 ended",
        "Bring 3 to office1: rejected (Anna's office",
        "    is closed)",
    ]


@pytest.mark.parametrize(("count", "length"), [(LINES, 1), (LINES + 1, 30), (100, 5000)])
def test_rviz_panel_goals_use_the_available_lines(count, length):
    goals = [(f"g({'x' * length},{number})", 4, "because " * length) for number in range(count)]
    heading, *lines = goals_text(goals, TERMS).splitlines()
    assert heading == f"goals: 0 open, {count} ended"
    assert 1 <= len(lines) <= LINES
    assert max(map(len, lines)) <= LETTERS
    reported = sum(not line.startswith((" ", "...")) for line in lines)
    if reported < count:
        assert lines[-1] == f"... {count - reported} more"
