"""Smallest sets of things that cannot be had together, found by asking.

Each answer tells more than yes or no: where some things cannot be had together, which of them are to blame, and where
they can, what else of all can be had with them.
"""

from dataclasses import dataclass
from typing import Callable, FrozenSet, Generic, List, Sequence, Set, Tuple, TypeVar

import clingo

T = TypeVar("T")


class OutOfTimeError(Exception):
    """A question was not answered in the time there is."""


@dataclass(frozen=True)  # a generic NamedTuple needs Python 3.11
class Joint(Generic[T]):
    """Whether things can be had together.

    Where they can, ``things`` are all that can be had with what this answer has found; else those of the things asked
    for that are to blame.
    """

    possible: bool
    things: FrozenSet[T]


Ask = Callable[[FrozenSet[T]], Joint[T]]


@dataclass(frozen=True)
class Minimum(Generic[T]):
    """Things that cannot be had together, in the order of all.

    ``minimal`` tells that they can be without any one of them, ``smallest`` that no fewer things would do; otherwise
    that was not found out in time.
    """

    things: Tuple[T, ...]
    minimal: bool = True
    smallest: bool = False


def shrink(things: Sequence[T], ask: Ask[T], monotone: bool = True) -> Minimum[T]:
    """Leave things out, which cannot be had together, until they can be without any one.

    Many are left out at once as long as that does, from the last one on. Where it is not ``monotone``, so that having
    fewer things can make others impossible, it begins again until nothing changes.
    """
    kept = list(things)
    try:
        before = len(kept) + 1
        while len(kept) < before and (before > len(things) or not monotone):
            before = len(kept)
            _leave_out(kept, ask)
    except OutOfTimeError:
        return Minimum(tuple(kept), minimal=False)
    return Minimum(tuple(kept))


def _leave_out(things: List[T], ask: Ask[T]) -> None:
    """Leave out of ``things`` what is of no need; they are always as few as is known to be impossible."""
    size, end = max(1, len(things) // 2), len(things)
    while end > 0:
        start = max(0, end - size)
        before, after = things[:start], things[end:]
        reply = ask(frozenset(before + after))
        if not reply.possible:
            before = [one for one in before if one in reply.things]
            things[:] = before + [one for one in after if one in reply.things]
            end, size = len(before), 2 * size
        elif size > 1:
            size //= 2
        else:
            end = start


def smallest(things: Sequence[T], ask: Ask[T]) -> Minimum[T]:
    """The fewest of ``things``, which cannot be had together, that cannot either; having fewer makes more possible.

    After Ignatiev et al. (2015): each set of things that can be had tells that one of the others is to blame, so the
    fewest that meet all such others are a bound from below, and the answer once they cannot be had together.
    """
    found = shrink(things, ask)
    if not found.minimal:
        return found
    others: List[FrozenSet[T]] = []
    try:
        while True:
            few = _meeting(others, things)
            if len(few) >= len(found.things):
                return Minimum(found.things, smallest=True)
            reply = ask(frozenset(few))
            if not reply.possible:
                return Minimum(few, smallest=True)
            possible: FrozenSet[T] = grown(frozenset([*reply.things, *few]), things, ask)
            others.append(frozenset(things) - possible)
    except OutOfTimeError:
        return found


def grown(possible: FrozenSet[T], things: Sequence[T], ask: Ask[T]) -> FrozenSet[T]:
    """Add to things that can be had together as many as can be."""
    for one in things:
        if one not in possible:
            reply = ask(possible | {one})
            if reply.possible:
                possible |= reply.things | {one}
    return possible


_FEWEST = """
1 { pick(X) : in(S,X) } :- in(S,_).
#minimize { 1@2,X : pick(X); X@1,X : pick(X) }.
#show pick/1.
"""


def _meeting(sets: Sequence[FrozenSet[T]], things: Sequence[T]) -> Tuple[T, ...]:
    """The fewest of ``things`` of which each of the sets holds one; of several the first ones."""
    control = clingo.Control(logger=lambda code, text: None)
    numbers = {thing: number for number, thing in enumerate(things)}
    facts = "".join(f"in({number},{numbers[one]})." for number, some in enumerate(sets) for one in some)
    control.add("base", [], facts + _FEWEST)
    control.ground([("base", [])])
    picked: Set[int] = set()
    with control.solve(yield_=True) as handle:
        for model in handle:
            picked = {atom.arguments[0].number for atom in model.symbols(shown=True)}
    return tuple(thing for thing in things if numbers[thing] in picked)
