"""The search for a shortest plan, which refutes all shorter horizons."""

from typing import NamedTuple, Optional

from rosoclingo.planning.question import Question, Reply, Strategy
from rosoclingo.planning.strategies.trim import trimmed
from rosoclingo.planning.strategy_runner import StrategyRunner


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
        hint: a likely horizon, such as the horizon of the last answer; it and the lower ones are searched first.

    """
    first = runner.min_horizon
    while True:
        ground = (end for end in (hint - 1, hint, runner.horizon) if first <= end <= runner.horizon)
        end = next(ground, runner.last(runner.horizon + runner.block))
        reply = yield Question(first, end)
        if reply.satisfiable is not False or reply.hopeless or not (end < runner.horizon or runner.may_grow(end)):
            break
        first = end + 1
    while reply.satisfiable and first < reply.horizon:
        shorter = yield Question(first, reply.horizon - 1)
        if not shorter.satisfiable:
            break
        reply = shorter
    if reply.satisfiable and (models != 1 or runner.program.optimizes):
        reply = yield Question(reply.horizon, reply.horizon, models=models, best=True)
    elif reply.satisfiable:
        reply = yield from trimmed(reply, runner, runner.step - 1, reply.horizon)
    return SearchResult(reply, bool(reply.satisfiable))
