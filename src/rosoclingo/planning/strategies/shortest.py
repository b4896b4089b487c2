"""The search for a shortest plan, which refutes all shorter horizons."""

from typing import Generator, List, NamedTuple, Optional, Tuple

from rosoclingo.planning.question import Question, Reply, Strategy
from rosoclingo.planning.strategies.trim import trimmed
from rosoclingo.planning.strategy_runner import StrategyRunner

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


def shortest(runner: StrategyRunner, models: int, hint: int) -> Strategy[SearchResult]:
    """Search the grounded horizons, then extend the grounding until there is an answer or the bound is reached.

    Args:
        runner: the runner of the strategy, which has the snapshot and its grounding.
        models: the number of answers to compute, 0 for all.
        hint: a likely horizon, such as the horizon of the last answer.

    """
    reply = yield from _search(runner, models, runner.min_horizon, runner.horizon, hint)
    while reply.satisfiable is False and not reply.hopeless and runner.may_grow(runner.horizon):
        first = runner.horizon + 1
        reply = yield from _search(runner, models, first, runner.last(runner.horizon + runner.block))
    if reply.satisfiable and models == 1 and not runner.program.optimizes:
        reply = yield from trimmed(reply, runner, runner.step - 1, reply.horizon)
    return SearchResult(reply, bool(reply.satisfiable))


def _search(runner: StrategyRunner, models: int, first: int, last: int, hint: Optional[int] = None) -> _Asks:
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
    if models != 1 or runner.program.optimizes:
        return (yield Question(reply.horizon, reply.horizon, models=models, best=True))
    return reply


def _ranges(first: int, last: int, hint: Optional[int]) -> List[Tuple[int, int]]:
    """Split first..last into the horizons below ``hint``, ``hint`` itself and the horizons above."""
    if hint is None:
        return [(first, last)]
    middle = min(max(hint, first), last)
    return [(low, high) for low, high in ((first, middle - 1), (middle, middle), (middle + 1, last)) if low <= high]
