"""Minimal unsatisfiable subsets and minimum diagnoses, compared with brute force on small random instances."""

from contextlib import suppress
from itertools import combinations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.planning.minimal_sets import (
    Mus,
    UndecidedError,
    Witness,
    find_diagnosis,
    find_mus,
    find_smallest_mus,
    grow,
    remember,
    yes_or_no,
)

THINGS = tuple("abcdefg")
CONFLICTS = st.lists(st.frozensets(st.sampled_from(THINGS), max_size=4), min_size=1, max_size=6)
ORACLES = pytest.mark.parametrize("tells", ["yes or no", "a loose core", "a core and a model"])


def satisfiable(things, conflicts):
    return not any(one <= frozenset(things) for one in conflicts)


def oracle_of(conflicts, tells="yes or no"):
    """Return an oracle for these conflicts; ``tells`` selects the quality of its cores and models.

    A model prefers the last things, which the algorithms prefer least.
    """

    def ask(things):
        broken = [one for one in conflicts if one <= things]
        if tells == "yes or no":
            return Witness(not broken, things)
        if broken:
            return Witness(False, broken[0] if "model" in tells else frozenset().union(*broken))
        model = set(things)
        for one in reversed(THINGS) if "model" in tells else ():
            model |= {one} if satisfiable(model | {one}, conflicts) else set()
        return Witness(True, frozenset(model))

    return ask


def noting(oracle):
    """Return the oracle with a list of its questions."""
    asked = []
    return (lambda things: asked.append(set(things)) or oracle(things)), asked


def limited(oracle, questions):
    """Return the oracle limited to a number of ``questions``."""
    left = iter(range(questions))

    def ask(things):
        if next(left, None) is None:
            raise UndecidedError
        return oracle(things)

    return ask


def subsets(things):
    """Return all subsets, ordered by size and then lexicographically."""
    return [some for size in range(len(things) + 1) for some in combinations(things, size)]


def is_mus(things, conflicts):
    smaller = (set(things) - {one} for one in things)
    return not satisfiable(things, conflicts) and all(satisfiable(one, conflicts) for one in smaller)


@ORACLES
@given(CONFLICTS)
def test_find_mus_returns_a_mus_of_first_things(tells, conflicts):
    found = find_mus(THINGS, oracle_of(conflicts, tells))
    assert found == Mus(tuple(sorted(found.items)))
    assert is_mus(found.items, conflicts)
    if tells == "yes or no":
        muses = [some for some in subsets(THINGS) if is_mus(some, conflicts)]
        assert found.items == min(muses, key=lambda mus: mus[::-1])


@ORACLES
@given(CONFLICTS)
def test_find_smallest_mus_returns_the_first_of_them(tells, conflicts):
    first = next(some for some in subsets(THINGS) if not satisfiable(some, conflicts))
    assert find_smallest_mus(THINGS, oracle_of(conflicts, tells)) == Mus(first, smallest=True)


@ORACLES
@given(CONFLICTS)
def test_find_diagnosis_returns_the_first_smallest_one(tells, conflicts):
    conflicts = [one for one in conflicts if one]
    found = find_diagnosis(THINGS, oracle_of(conflicts, tells))
    enough = [some for some in subsets(THINGS) if satisfiable(set(THINGS) - set(some), conflicts)]
    assert tuple(found) == enough[0]
    for one, mus in found.items():
        assert mus.minimal
        assert is_mus(mus.items, conflicts)
        assert set(mus.items) & set(found) == {one}, "each conflict explains one element of the diagnosis"


@ORACLES
@given(CONFLICTS, st.data())
def test_grow_returns_a_maximal_satisfiable_set(tells, conflicts, data):
    seeds = [some for some in subsets(THINGS) if satisfiable(some, conflicts)]
    if seeds:
        seed = frozenset(data.draw(st.sampled_from(seeds)))
        found = grow(seed, THINGS, oracle_of(conflicts, tells))
        assert seed <= found
        assert satisfiable(found, conflicts)
        assert not any(satisfiable(found | {one}, conflicts) for one in set(THINGS) - found)


@ORACLES
@pytest.mark.parametrize("find", [find_mus, find_smallest_mus])
@given(conflicts=CONFLICTS, questions=st.integers(0, 12))
def test_mus_found_with_few_questions_is_unsatisfiable(tells, find, conflicts, questions):
    found = find(THINGS, limited(oracle_of(conflicts, tells), questions))
    assert not satisfiable(found.items, conflicts)
    assert list(found.items) == sorted(found.items)
    if found.minimal:
        assert is_mus(found.items, conflicts)
    if found.smallest:
        assert not any(len(one) < len(found.items) for one in conflicts)


@given(CONFLICTS, st.integers(0, 12))
def test_find_diagnosis_with_few_questions_is_complete(conflicts, questions):
    oracle = oracle_of(conflicts)
    with suppress(UndecidedError):
        found, complete = (find_diagnosis(THINGS, one) for one in (limited(oracle, questions), oracle))
        assert (found and list(found)) == (complete and list(complete))


@ORACLES
@given(CONFLICTS)
def test_remember_changes_no_answer_and_repeats_nothing(tells, conflicts):
    oracle, asked = noting(oracle_of(conflicts, tells))
    remembering = remember(oracle, [])
    for some in [*subsets(THINGS), *reversed(subsets(THINGS))]:
        answer = remembering(frozenset(some))
        assert answer.satisfiable == satisfiable(some, conflicts)
        assert frozenset(some) <= answer.items if answer.satisfiable else answer.items <= frozenset(some)
        assert satisfiable(answer.items, conflicts) == answer.satisfiable
    assert len(asked) == len(set(map(frozenset, asked))) <= 2 ** len(THINGS)


@pytest.mark.parametrize(
    ("number", "conflict", "tells", "most"),
    [
        (1000, (3, 700), "yes or no", 29),
        (1000, (3, 700), "a core and a model", 3),
    ],
)
def test_find_mus_asks_few_questions_among_many(number, conflict, tells, most):
    oracle, asked = noting(oracle_of([frozenset(conflict)], tells))
    assert find_mus(range(number), oracle) == Mus(tuple(conflict))
    assert len(asked) <= most


def test_find_diagnosis_returns_none_if_nothing_helps():
    assert find_diagnosis(THINGS, yes_or_no(lambda things: False)) is None
    assert find_diagnosis(THINGS, yes_or_no(lambda things: True)) == {}
