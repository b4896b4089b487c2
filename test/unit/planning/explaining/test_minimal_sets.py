"""Smallest sets of things that cannot be had together, against all subsets."""

from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.planning.explaining.minimal_sets import Joint, OutOfTimeError, shrink, smallest

THINGS = tuple(range(8))
CONFLICTS = st.sets(st.frozensets(st.sampled_from(THINGS), max_size=4), min_size=1, max_size=6)


def asking(conflicts, asked=None, most=10**6):
    """What cannot be had are the conflicts; the blame is as coarse as can be."""

    def ask(things):
        if asked is not None:
            asked.append(things)
            if len(asked) > most:
                raise OutOfTimeError
        broken = [one for one in conflicts if one <= things]
        return Joint(not broken, things)

    return ask


def is_possible(things, conflicts):
    return not any(one <= frozenset(things) for one in conflicts)


@given(CONFLICTS)
def test_nothing_of_what_is_left_can_be_left_out(conflicts):
    found = shrink(THINGS, asking(conflicts))
    assert found.minimal
    assert not is_possible(found.things, conflicts)
    for one in found.things:
        assert is_possible(set(found.things) - {one}, conflicts)


@given(CONFLICTS)
def test_no_fewer_things_are_impossible_together(conflicts):
    found = smallest(THINGS, asking(conflicts))
    size = next(n for n in range(9) for some in combinations(THINGS, n) if not is_possible(some, conflicts))
    assert found.minimal
    assert found.smallest
    assert len(found.things) == size
    assert not is_possible(found.things, conflicts)
    assert list(found.things) == sorted(found.things)


@given(CONFLICTS, st.integers(0, 12))
def test_what_is_found_in_no_time_is_impossible_all_the_same(conflicts, most):
    found = smallest(THINGS, asking(conflicts, [], most))
    assert not is_possible(found.things, conflicts)
    if found.minimal:
        assert all(is_possible(set(found.things) - {one}, conflicts) for one in found.things)


def test_the_blame_saves_questions():
    asked = []

    def ask(things):
        asked.append(things)
        return Joint(not {3, 90} <= things, frozenset({3, 90}) if {3, 90} <= things else things)

    assert shrink(range(100), ask).things == (3, 90)
    assert len(asked) < 12


def test_fewer_things_can_make_others_impossible():
    """2 alone is impossible, but for 1, without which 0 is impossible too: what is left is looked at again."""

    def ask(things):
        impossible = {0, 1, 2} <= things or things == {2} or things == {1, 2}
        return Joint(not impossible, things)

    found = shrink((0, 1, 2), ask, monotone=False)
    assert found.things == (2,)


@pytest.mark.parametrize("find", [shrink, smallest])
def test_nothing_at_all_may_be_impossible(find):
    assert find(THINGS, lambda things: Joint(False, things)).things == ()
    assert find((), lambda things: Joint(False, things)).things == ()
