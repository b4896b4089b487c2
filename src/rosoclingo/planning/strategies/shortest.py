"""The search for a shortest plan, which refutes all shorter horizons."""

from rosoclingo.planning.question import Question, Reply, Strategy
from rosoclingo.planning.strategies.trim import trimmed
from rosoclingo.planning.strategy_runner import StrategyRunner


def shortest(runner: StrategyRunner, models: int, hint: int) -> Strategy[Reply]:
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
        reply = yield from all_answers(reply, models)
    elif reply.satisfiable:
        reply = yield from trimmed(reply, runner, runner.step - 1, reply.horizon)
    return reply


def all_answers(found: Reply, models: int) -> Strategy[Reply]:
    """Return the best answers with the horizon of ``found``: at most ``models``, 0 for all."""
    return (yield Question(found.horizon, found.horizon, models=models, best=True))
