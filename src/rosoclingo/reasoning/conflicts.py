"""What of many things cannot be had together, and which to give up: any things, and any test of whether they can.

A test ``met(things)`` tells whether these things can be had together; what can be had stays so with fewer of them. It
may raise UndecidedError when it takes too long. All things are given in order of importance for the result, and subsets
are tested in that order.
"""

from collections import deque
from dataclasses import dataclass
from functools import partial
from typing import Callable, Deque, Dict, FrozenSet, Generic, Iterable, List, Optional, Sequence, Tuple, TypeVar

T = TypeVar("T")
Found = TypeVar("Found")
Met = Callable[[Tuple[T, ...]], bool]


class UndecidedError(Exception):
    """A test came to no result in its time."""


@dataclass(frozen=True)  # a generic NamedTuple needs Python 3.11
class Conflict(Generic[T]):
    """Things that cannot be had together.

    ``minimal`` tells that any fewer of them can; otherwise that was not found out in time.
    """

    things: Tuple[T, ...]
    minimal: bool = True


#: The things to give up, each with a conflict that it is part of.
Choice = List[Tuple[T, Conflict[T]]]


def find_conflict(things: Sequence[T], met: Met[T]) -> Conflict[T]:
    """A minimal conflict within ``things``, which cannot be had together; of several one of the first things.

    It takes about one test for each doubling of the number of things, times the number of things in the conflict.
    Where a test is undecided, the smallest conflict that was found until then is the result.
    """
    found: List[T] = []
    rest = things
    try:
        while not _is_conflict(found, met, known=rest):
            size = least_number(len(rest), partial(_too_many, things, found, rest, met))
            found.append(rest[size - 1])
            rest = rest[: size - 1]
    except UndecidedError:
        return Conflict(_in_order(things, [*found, *rest]), minimal=False)
    return Conflict(_in_order(things, found))


def choose(things: Sequence[T], met: Met[T]) -> Optional[Choice[T]]:
    """The fewest of ``things`` to give up so that the others can be had together; of several choices the first things.

    None where there is no such choice. Raises UndecidedError. After Reiter (1987): a set that meets every conflict,
    found by trying sets in order of size, where each conflict found tells what may be given up next.
    """
    conflicts: List[Conflict[T]] = []
    waiting: Deque[Choice[T]] = deque([[]])
    tried = set()
    while waiting:
        choice = waiting.popleft()
        dropped = frozenset(thing for thing, _ in choice)
        if dropped in tried:
            continue
        tried.add(dropped)
        conflict = next((one for one in conflicts if not dropped & set(one.things)), None)
        if conflict is None:
            kept = tuple(thing for thing in things if thing not in dropped)
            if met(kept):
                return choice
            conflict = find_conflict(kept, met)
            conflicts.append(conflict)
        waiting.extend([*choice, (thing, conflict)] for thing in conflict.things)
    return None


def first_found(candidates: Iterable[T], find: Callable[[T], Optional[Found]]) -> Optional[Found]:
    """What the first candidate gives that gives anything; None where none does.

    Raises UndecidedError where none does, but it was not known of each in its time.
    """
    undecided = False
    for one in candidates:
        try:
            found = find(one)
        except UndecidedError:
            undecided = True
            continue
        if found is not None:
            return found
    if undecided:
        raise UndecidedError
    return None


def remembering(met: Met[T], known: Dict[FrozenSet[T], bool]) -> Met[T]:
    """The same test, which asks for no set of things whose answer follows from those ``known``, which it adds to."""

    def ask(things: Tuple[T, ...]) -> bool:
        """Tell whether things can be met together; a part of what can be can, more than what cannot be cannot."""
        key = frozenset(things)
        if any(answer and key <= other for other, answer in known.items()):
            return True
        if any(not answer and other <= key for other, answer in known.items()):
            return False
        known[key] = met(things)
        return known[key]

    return ask


def _is_conflict(found: Sequence[T], met: Met[T], known: Sequence[T]) -> bool:
    """Whether what was found is a whole conflict; all that is known to be one is found when nothing is left."""
    return not known or (bool(found) and not met(tuple(found)))


def _too_many(things: Sequence[T], found: Sequence[T], rest: Sequence[T], met: Met[T], size: int) -> bool:
    """Whether what was found and the first ``size`` of the rest cannot be had together."""
    return not met(_in_order(things, [*found, *rest[:size]]))


def least_number(most: int, enough: Callable[[int], bool]) -> int:
    """The least number from 1 to ``most`` that is enough; ``most`` is. Small numbers are tried first."""
    low, high = 0, 1
    while high < most and not enough(high):
        low, high = high, 2 * high
    high = min(high, most)
    while high - low > 1:
        middle = (low + high) // 2
        if enough(middle):
            high = middle
        else:
            low = middle
    return high


def _in_order(things: Sequence[T], some: Sequence[T]) -> Tuple[T, ...]:
    return tuple(thing for thing in things if thing in some)
