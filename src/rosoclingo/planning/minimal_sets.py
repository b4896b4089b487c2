"""Minimal unsatisfiable subsets (MUSes), smallest MUSes and minimum diagnoses, for any items and any oracle.

An oracle decides whether a set of items is satisfiable. Every subset of a satisfiable set is satisfiable. Items are
given in order of preference.
"""

from dataclasses import dataclass
from typing import Callable, Dict, FrozenSet, Generic, Iterable, List, Optional, Sequence, Tuple, TypeVar

import clingo

T = TypeVar("T")


class UndecidedError(Exception):
    """An oracle was stopped before it decided."""


@dataclass(frozen=True)  # a generic NamedTuple needs Python 3.11
class Witness(Generic[T]):
    """The reply of an oracle: ``items`` are a satisfiable superset of the given set, or an unsat core of it."""

    satisfiable: bool
    items: FrozenSet[T]


Oracle = Callable[[FrozenSet[T]], Witness[T]]


@dataclass(frozen=True)
class Mus(Generic[T]):
    """An unsatisfiable set of items, in order.

    If it is ``minimal``, every proper subset is satisfiable; if it is ``smallest``, no unsatisfiable set has fewer
    items. False means that the oracle was stopped before this was decided.
    """

    items: Tuple[T, ...]
    minimal: bool = True
    smallest: bool = False


def yes_or_no(test: Callable[[FrozenSet[T]], bool]) -> Oracle[T]:
    """Return an oracle that uses ``test``, which returns whether a set is satisfiable."""
    return lambda items: Witness(test(items), items)


def remember(oracle: Oracle[T], known: List[Witness[T]]) -> Oracle[T]:
    """Return a caching ``oracle``: it answers from the ``known`` replies if they decide a set, and adds new replies."""

    def ask(items: FrozenSet[T]) -> Witness[T]:
        """Return a known reply or a new one."""
        for reply in known:
            if items <= reply.items if reply.satisfiable else reply.items <= items:
                return reply
        known.append(oracle(items))
        return known[-1]

    return ask


def find_mus(items: Sequence[T], oracle: Oracle[T]) -> Mus[T]:
    """Return a MUS of ``items``, which are unsatisfiable.

    MUSes of early items are preferred, as in QuickXplain (Junker 2004): the last item of the MUS is as early as
    possible, then the last but one, and so on. Cores take precedence over this order. Without cores, each item of the
    MUS is the last of a shortest unsatisfiable prefix, found by doubling and bisection. Cores are nearly minimal, so
    the search is deletion-based after the first core. If the oracle raises UndecidedError, the set need not be minimal.
    """
    needed: List[T] = []  # contained in every MUS of the needed items and the rest
    rest, low = list(items), -1  # the needed items and the first ``low`` items of the rest are satisfiable
    try:
        core = oracle(frozenset(items)).items
        rest = [one for one in items if one in core]
        narrowed = len(rest) < len(items)
        while rest:
            if low == len(rest) - 1:
                needed.append(rest.pop())
                low = -1
                continue
            size = len(rest) - 1 if narrowed else min(max(low + 1, 2 * low), (low + len(rest)) // 2)
            reply = oracle(frozenset([*needed, *rest[:size]]))
            if reply.satisfiable:
                low = [one in reply.items for one in rest].index(False)
                continue
            rest = [one for one in rest[:size] if one in reply.items]
            if len(rest) < size:
                narrowed, low = True, -1
    except UndecidedError:
        return Mus(_in_order(items, [*needed, *rest]), minimal=False)
    return Mus(_in_order(items, needed))


def find_smallest_mus(items: Sequence[T], oracle: Oracle[T]) -> Mus[T]:
    """Return the smallest MUS of ``items``, which are unsatisfiable; of several, the lexicographically first.

    The method is implicit hitting sets (Ignatiev et al. 2015): a MUS intersects the complement of every satisfiable
    set.
    """
    found = find_mus(items, oracle)
    if not found.minimal:
        return found

    def complement(few: Tuple[T, ...]) -> Optional[FrozenSet[T]]:
        """Return the complement of a maximal satisfiable superset of ``few``, None if there is none."""
        reply = oracle(frozenset(few))
        if not reply.satisfiable:
            return None
        maximal: FrozenSet[T] = grow(reply.items, items, oracle)
        return frozenset(items) - maximal

    try:
        return Mus(_minimum_hitting_set(items, complement), smallest=True)
    except UndecidedError:
        return found


def grow(satisfiable: FrozenSet[T], items: Iterable[T], oracle: Oracle[T]) -> FrozenSet[T]:
    """Extend a ``satisfiable`` subset of ``items`` to a maximal one."""
    for one in items:
        if one not in satisfiable:
            reply = oracle(satisfiable | {one})
            if reply.satisfiable:
                satisfiable = reply.items
    return satisfiable


def find_diagnosis(items: Sequence[T], oracle: Oracle[T]) -> Optional[Dict[T, Mus[T]]]:
    """Return a minimum diagnosis of ``items``: the fewest items whose removal makes the rest satisfiable.

    Of several diagnoses, the lexicographically first is returned. It maps each item to a MUS that contains no other
    item of the diagnosis. None means that the empty set is unsatisfiable. Raises UndecidedError. The method is implicit
    hitting sets (Reiter 1987): a diagnosis intersects every MUS.
    """
    if not oracle(frozenset()).satisfiable:
        return None
    found: List[Mus[T]] = []

    def conflict(few: Tuple[T, ...]) -> Optional[FrozenSet[T]]:
        """Return a MUS that contains none of ``few``, None if there is none."""
        kept = [one for one in items if one not in few]
        if oracle(frozenset(kept)).satisfiable:
            return None
        found.append(find_mus(kept, oracle))
        return frozenset(found[-1].items)

    few = _minimum_hitting_set(items, conflict)
    return {one: next(mus for mus in found if set(few).intersection(mus.items) == {one}) for one in few}


def _minimum_hitting_set(
    items: Sequence[T], find_other: Callable[[Tuple[T, ...]], Optional[FrozenSet[T]]]
) -> Tuple[T, ...]:
    """Return the fewest items that hit all sets; ``find_other`` returns a set that a candidate does not hit."""
    sets: List[FrozenSet[T]] = []
    while True:
        few = _hit(sets, items)
        other = find_other(few)
        if other is None:
            return few
        sets.append(other)


_FEWEST_THEN_FIRST = """
1 { pick(X) : in(S,X) } :- in(S,_).
#minimize { 1@1,X : pick(X); -1@-X,X : pick(X) }.
#show pick/1.
"""


def _hit(sets: Sequence[FrozenSet[T]], items: Sequence[T]) -> Tuple[T, ...]:
    """Return the fewest of ``items`` that hit each of the ``sets``; of several, the lexicographically first."""
    control = clingo.Control(logger=lambda code, text: None)
    numbers = {item: number for number, item in enumerate(items)}
    facts = "".join(f"in({number},{numbers[one]})." for number, some in enumerate(sets) for one in some)
    control.add("base", [], facts + _FEWEST_THEN_FIRST)
    control.ground([("base", [])])
    picked: Tuple[T, ...] = ()
    with control.solve(yield_=True) as handle:
        for model in handle:
            picked = _in_order(items, [items[atom.arguments[0].number] for atom in model.symbols(shown=True)])
    return picked


def _in_order(items: Iterable[T], some: Iterable[T]) -> Tuple[T, ...]:
    chosen = frozenset(some)
    return tuple(one for one in items if one in chosen)
