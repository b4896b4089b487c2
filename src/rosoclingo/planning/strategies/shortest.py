"""The search for a shortest plan: every shorter horizon is refuted."""

from typing import Generator, List, NamedTuple, Optional, Tuple

from rosoclingo.planning.asking import Asking
from rosoclingo.planning.question import Question, Reply, Strategy

_Asks = Generator[Question, Reply, Reply]


class SearchResult(NamedTuple):
    """What a search came to.

    Attributes:
        reply: the last reply, with the answers if there are any.
        proven: whether the horizon of the answers is known to be the least.
        answered: the processor time of this process when there was an answer that would do; None if only the end of
            the search gave it.

    """

    reply: Reply
    proven: bool = False
    answered: Optional[float] = None


def shortest(asking: Asking, models: int, hint: int) -> Strategy[SearchResult]:
    """Search at the horizons that are ground, then grow until there is an answer or no more may be ground.

    ``models`` answers are found, 0 for all; ``hint`` is a likely horizon, that of the last answer.
    """
    reply = yield from _least(asking, models, asking.first, asking.horizon, hint)
    while reply.satisfiable is False and not reply.hopeless and asking.may_grow:
        first = asking.horizon + 1
        reply = yield from _least(asking, models, first, asking.last(asking.horizon + asking.block))
    return SearchResult(reply, bool(reply.satisfiable))


def _least(asking: Asking, models: int, first: int, last: int, hint: Optional[int] = None) -> _Asks:
    """Find the answers of the least horizon in first..last; the ``hint`` and below are asked first."""
    if first == last:
        return (yield Question(first, last, models=models, best=True))
    reply, low = Reply(False), first
    for low, high in _ranges(first, last, hint):
        reply = yield Question(low, high)
        if reply.satisfiable or reply.hopeless:
            break
    if not reply.satisfiable:
        return reply
    while low < reply.horizon:
        shorter = yield Question(low, reply.horizon - 1)
        if not shorter.satisfiable:
            break
        reply = shorter
    if models != 1 or asking.program.optimizes:
        return (yield Question(reply.horizon, reply.horizon, models=models, best=True))
    return reply


def _ranges(first: int, last: int, hint: Optional[int]) -> List[Tuple[int, int]]:
    """Return the ranges of horizons in first..last to ask for, one after the other: below a ``hint``, it, above it."""
    if hint is None:
        return [(first, last)]
    middle = min(max(hint, first), last)
    return [(low, high) for low, high in ((first, middle - 1), (middle, middle), (middle + 1, last)) if low <= high]
