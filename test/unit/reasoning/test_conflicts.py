"""Minimal conflicts and least choices, compared with all subsets of small random instances."""

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.reasoning.conflicts import Conflict, UndecidedError, choose, find_conflict, first_found, remembering

THINGS = tuple("abcdefg")
CONFLICTS = st.lists(st.frozensets(st.sampled_from(THINGS), min_size=1, max_size=4), max_size=6)


def met_by(conflicts):
    """A test of things of which no conflict may be whole."""
    return lambda things: not any(conflict <= set(things) for conflict in conflicts)


def counted(met):
    """The same test, and the list of what it was asked for."""
    asked = []
    return (lambda things: asked.append(things) or met(things)), asked


def subsets(things):
    return [some for size in range(len(things) + 1) for some in combinations(things, size)]


@given(CONFLICTS.filter(bool))
def test_a_conflict_cannot_be_had_and_each_part_of_it_can(conflicts):
    met, asked = counted(met_by(conflicts))
    found = find_conflict(THINGS, met)
    assert THINGS not in asked, "that they cannot be had is known"
    assert found.minimal
    assert not met(found.things)
    assert all(met(part) for part in subsets(found.things) if part != found.things)


@given(CONFLICTS)
def test_a_choice_is_one_of_the_smallest(conflicts):
    met = met_by(conflicts)
    choice = choose(THINGS, remembering(met, {}))
    dropped = [thing for thing, _ in choice]
    enough = [some for some in subsets(THINGS) if met([thing for thing in THINGS if thing not in some])]
    assert met([thing for thing in THINGS if thing not in dropped])
    assert len(dropped) == len(enough[0])
    for thing, conflict in choice:
        assert thing in conflict.things
        assert not met(conflict.things)
        assert all(met(part) for part in subsets(conflict.things) if part != conflict.things)


@given(CONFLICTS.filter(bool), st.integers(0, 12))
def test_what_is_found_in_time_is_a_conflict(conflicts, tests):
    met, left = met_by(conflicts), [tests]

    def limited(things):
        left[0] -= 1
        if left[0] < 0:
            raise UndecidedError
        return met(things)

    found = find_conflict(THINGS, limited)
    assert not met(found.things)
    assert not found.minimal or all(met(part) for part in subsets(found.things) if part != found.things)
    assert found.minimal or left[0] < 0


def test_the_first_things_are_given_up():
    met = met_by([frozenset("bd"), frozenset("cd")])
    assert [thing for thing, _ in choose(("a", "b", "c", "d"), met)] == ["d"]
    assert [thing for thing, _ in choose(("a", "b"), met_by([frozenset("ab")]))] == ["a"]


def test_few_tests_where_the_first_is_at_fault():
    asked = []

    def met(things):
        asked.append(things)
        return "a" not in things

    assert find_conflict(THINGS, met) == Conflict(("a",))
    assert asked == [("a",)]


def test_few_tests_among_many():
    asked = []

    def met(things):
        asked.append(things)
        return not {700, 3} <= set(things)

    assert find_conflict(range(1000), met) == Conflict((3, 700))
    assert len(asked) < 30


def test_a_conflict_that_is_known_is_not_looked_for_again():
    met, asked = counted(met_by([frozenset("bc"), frozenset("de"), frozenset("fg")]))
    assert len(choose(THINGS, met)) == 3
    wholes = [things for things in asked if set(things) in ({"b", "c"}, {"d", "e"}, {"f", "g"})]
    assert len(wholes) == 3


def test_nothing_helps():
    assert choose(("a", "b"), lambda things: False) is None


def test_undecided_choice():
    def met(things):
        raise UndecidedError

    with pytest.raises(UndecidedError):
        choose(("a",), met)


def test_remembering():
    asked = []
    met = remembering(lambda things: asked.append(things) or True, {frozenset("c"): False})
    assert met(("a", "b"))
    assert met(("b", "a"))
    assert met(("b",))
    assert not met(("a", "c"))
    assert not met(("c",))
    assert asked == [("a", "b")]


@pytest.mark.parametrize(
    ("gives", "found"),
    [("a", "a"), (" a", "a"), ("?a", "a"), ("ab?", "a"), ("", None), ("  ", None), ("? ", "?"), (" ?", "?")],
)
def test_the_first_that_gives_something(gives, found):
    def find(one):
        if one == "?":
            raise UndecidedError
        return one.strip() or None

    if found == "?":
        with pytest.raises(UndecidedError):
            first_found(gives, find)
    else:
        assert first_found(gives, find) == found
