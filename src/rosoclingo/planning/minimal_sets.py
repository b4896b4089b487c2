"""Minimal unsatisfiable subsets (MUSes), smallest MUSes and minimum diagnoses, for any things and any oracle.

An oracle tells whether a set of things is satisfiable. Every subset of a satisfiable set is satisfiable. Things are in
the order of preference.
"""

from dataclasses import dataclass
from typing import Callable, Dict, FrozenSet, Generic, Iterable, List, Optional, Sequence, Tuple, TypeVar

import clingo

T = TypeVar("T")


class UndecidedError(Exception):
    """An oracle has not answered in time."""


@dataclass(frozen=True)  # a generic NamedTuple needs Python 3.11
class Witness(Generic[T]):
    """What an oracle returns for a set: ``things`` are a satisfiable superset of it, or an unsat core."""

    satisfiable: bool
    things: FrozenSet[T]


Oracle = Callable[[FrozenSet[T]], Witness[T]]


@dataclass(frozen=True)
class Mus(Generic[T]):
    """An unsatisfiable set of things, in order.

    If it is ``minimal``, it is satisfiable without any one of them; if it is also ``smallest``, no unsatisfiable set
    has fewer things. False means that the time was over before that was known.
    """

    things: Tuple[T, ...]
    minimal: bool = True
    smallest: bool = False


def yes_or_no(test: Callable[[FrozenSet[T]], bool]) -> Oracle[T]:
    """Return the oracle for a ``test`` that only tells whether a set is satisfiable."""
    return lambda things: Witness(test(things), things)


def remember(oracle: Oracle[T], known: List[Witness[T]]) -> Oracle[T]:
    """Return an oracle that asks another one only if nothing follows from the ``known`` answers, which it extends."""

    def ask(things: FrozenSet[T]) -> Witness[T]:
        """Return the known or new answer."""
        for answer in known:
            if things <= answer.things if answer.satisfiable else answer.things <= things:
                return answer
        known.append(oracle(things))
        return known[-1]

    return ask


def find_mus(things: Sequence[T], oracle: Oracle[T]) -> Mus[T]:
    """Return a MUS of ``things``, which are unsatisfiable.

    MUSes of early things are preferred: the last thing of the MUS is as early as possible, then the last but one, and
    so on, as in QuickXplain (Junker 2004). Cores take precedence over this order. Without a core, each thing of the MUS
    is the last of a shortest unsatisfiable prefix, found by doubling and bisection. Cores are nearly minimal: after the
    first, the search is deletion-based. The set is not minimal if the oracle is undecided.
    """
    needed: List[T] = []  # in every MUS of these and the rest
    rest, low = list(things), -1  # satisfiable: the needed ones with the first ``low`` of the rest
    try:
        core = oracle(frozenset(things)).things
        rest = [one for one in things if one in core]
        narrowed = len(rest) < len(things)
        while rest:
            if low == len(rest) - 1:
                needed.append(rest.pop())
                low = -1
                continue
            size = len(rest) - 1 if narrowed else min(max(low + 1, 2 * low), (low + len(rest)) // 2)
            answer = oracle(frozenset([*needed, *rest[:size]]))
            if answer.satisfiable:
                low = [one in answer.things for one in rest].index(False)
                continue
            rest = [one for one in rest[:size] if one in answer.things]
            if len(rest) < size:
                narrowed, low = True, -1
    except UndecidedError:
        return Mus(_in_order(things, [*needed, *rest]), minimal=False)
    return Mus(_in_order(things, needed))


def find_smallest_mus(things: Sequence[T], oracle: Oracle[T]) -> Mus[T]:
    """Return the smallest MUS of ``things``, which are unsatisfiable; of several the lexicographically first.

    By implicit hitting sets (Ignatiev et al. 2015): a MUS holds something of the complement of every satisfiable set.
    """
    found = find_mus(things, oracle)
    if not found.minimal:
        return found

    def complement(few: Tuple[T, ...]) -> Optional[FrozenSet[T]]:
        """Return the complement of a maximal satisfiable set with these few things, None if they are unsatisfiable."""
        answer = oracle(frozenset(few))
        if not answer.satisfiable:
            return None
        maximal: FrozenSet[T] = grow(answer.things, things, oracle)
        return frozenset(things) - maximal

    try:
        return Mus(_minimum_hitting_set(things, complement), smallest=True)
    except UndecidedError:
        return found


def grow(satisfiable: FrozenSet[T], things: Iterable[T], oracle: Oracle[T]) -> FrozenSet[T]:
    """Return a maximal satisfiable subset of ``things`` that includes a ``satisfiable`` one."""
    for one in things:
        if one not in satisfiable:
            answer = oracle(satisfiable | {one})
            if answer.satisfiable:
                satisfiable = answer.things
    return satisfiable


def find_diagnosis(things: Sequence[T], oracle: Oracle[T]) -> Optional[Dict[T, Mus[T]]]:
    """Return the fewest ``things`` without which the others are satisfiable; of several the lexicographically first.

    Each of them comes with a MUS that holds none of the others. None if even the empty set is unsatisfiable. Raises
    UndecidedError. By implicit hitting sets (Reiter 1987): a diagnosis holds something of every MUS.
    """
    if not oracle(frozenset()).satisfiable:
        return None
    found: List[Mus[T]] = []

    def conflict(few: Tuple[T, ...]) -> Optional[FrozenSet[T]]:
        """Return a MUS without these few things, None if there is none."""
        kept = [one for one in things if one not in few]
        if oracle(frozenset(kept)).satisfiable:
            return None
        found.append(find_mus(kept, oracle))
        return frozenset(found[-1].things)

    few = _minimum_hitting_set(things, conflict)
    return {one: next(mus for mus in found if set(few).intersection(mus.things) == {one}) for one in few}


def _minimum_hitting_set(
    things: Sequence[T], find_other: Callable[[Tuple[T, ...]], Optional[FrozenSet[T]]]
) -> Tuple[T, ...]:
    """Return the fewest things that hit all sets, where ``find_other`` returns a set that a choice does not hit."""
    sets: List[FrozenSet[T]] = []
    while True:
        few = _hit(sets, things)
        other = find_other(few)
        if other is None:
            return few
        sets.append(other)


_FEWEST_THEN_FIRST = """
1 { pick(X) : in(S,X) } :- in(S,_).
#minimize { 1@1,X : pick(X); -1@-X,X : pick(X) }.
#show pick/1.
"""


def _hit(sets: Sequence[FrozenSet[T]], things: Sequence[T]) -> Tuple[T, ...]:
    """Return the fewest of ``things`` that hit each of the ``sets``; of several the lexicographically first."""
    control = clingo.Control(logger=lambda code, text: None)
    numbers = {thing: number for number, thing in enumerate(things)}
    facts = "".join(f"in({number},{numbers[one]})." for number, some in enumerate(sets) for one in some)
    control.add("base", [], facts + _FEWEST_THEN_FIRST)
    control.ground([("base", [])])
    picked: Tuple[T, ...] = ()
    with control.solve(yield_=True) as handle:
        for model in handle:
            picked = _in_order(things, [things[atom.arguments[0].number] for atom in model.symbols(shown=True)])
    return picked


def _in_order(things: Iterable[T], some: Iterable[T]) -> Tuple[T, ...]:
    chosen = frozenset(some)
    return tuple(one for one in things if one in chosen)
