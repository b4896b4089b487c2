"""The search for a shortest plan, which refutes all shorter horizons."""

from typing import Generator, List, NamedTuple, Optional, Tuple

from rosoclingo.planning.asking import Asking
from rosoclingo.planning.question import Question, Reply, Strategy
from rosoclingo.planning.strategies.trim import trimmed

_Asks = Generator[Question, Reply, Reply]


class SearchResult(NamedTuple):
    """The result of a search.

    Attributes:
        reply: the last reply, with the answers if there are any.
        proven: whether all shorter horizons were refuted and the answer is optimal.
        answered: the processor time of this process when the first acceptable answer was found; None stands for the end
            of the search.

    """

    reply: Reply
    proven: bool = False
    answered: Optional[float] = None


def shortest(asking: Asking, models: int, hint: int) -> Strategy[SearchResult]:
    """Search the grounded horizons, then extend the grounding until there is an answer or the bound is reached.

    Args:
        asking: the snapshot and its grounding.
        models: the number of answers to compute, 0 for all.
        hint: a likely horizon, such as the horizon of the last answer.

    """
    reply = yield from _search(asking, models, asking.min_horizon, asking.horizon, hint)
    while reply.satisfiable is False and not reply.hopeless and asking.may_grow(asking.horizon):
        first = asking.horizon + 1
        reply = yield from _search(asking, models, first, asking.last(asking.horizon + asking.block))
    if reply.satisfiable and models == 1 and not asking.program.optimizes:
        reply = yield from trimmed(reply, asking, asking.step - 1, reply.horizon)
    return SearchResult(reply, bool(reply.satisfiable))


def _search(asking: Asking, models: int, first: int, last: int, hint: Optional[int] = None) -> _Asks:
    """Compute the answers for the least horizon in first..last that has any."""
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
    """Split first..last into the horizons below ``hint``, ``hint`` itself and the horizons above."""
    if hint is None:
        return [(first, last)]
    middle = min(max(hint, first), last)
    return [(low, high) for low, high in ((first, middle - 1), (middle, middle), (middle + 1, last)) if low <= high]
