"""Hypothetical questions: is there an answer if some assumable facts are disabled?

A question without an answer has an unsat core of assumable facts (see clingo's ``SolveHandle.core``). No question that
enables these facts has an answer.
"""

from typing import FrozenSet, Sequence, Set

import clingo

from rosoclingo.planning.question import Question, Reply, Strategy
from rosoclingo.planning.strategy_runner import StrategyRunner

PIECE = 32
"""Least number of steps added before the next question. Fewer are added if clingo grounds fewer in one call."""


def probe(
    runner: StrategyRunner,
    end: int,
    disabled: FrozenSet[clingo.Symbol],
    kept: Sequence[clingo.Symbol] = (),
    believes: bool = True,
) -> Strategy[Reply]:
    """Search for an answer without the ``disabled`` facts in which the atoms ``kept`` are true.

    The horizon grows up to ``end``. An answer is easier to find with more steps. To refute all horizons, all steps have
    to be grounded, unless the unsat core does not depend on the horizon.
    """
    idles = runner.block > 1
    core: Set[clingo.Symbol] = set()
    last = min(runner.horizon, end)
    while True:
        first = min(runner.min_horizon, last)
        reply = yield Question(first, last, disabled=disabled, kept=kept, believes=believes)
        if reply.satisfiable is not False:
            return reply
        core = set(reply.core) if idles else core | reply.core
        if last == end or reply.hopeless:
            return reply._replace(core=frozenset(core))
        piece = min(PIECE, runner.grounding.piece())
        last = min(end, last + (max(last - runner.min_horizon + 1, piece) if idles else 1))
