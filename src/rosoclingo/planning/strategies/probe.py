"""Hypothetical questions: is there an answer if some assumable facts are disabled?

A question without an answer has an unsat core of assumable facts (see clingo's ``SolveHandle.core``). Every question
that agrees on these facts has no answer either.
"""

from typing import FrozenSet, Sequence, Set

import clingo

from rosoclingo.planning.asking import Asking
from rosoclingo.planning.question import Question, Reply, Strategy

PIECE = 32
"""Least number of steps to add before the next question."""


def probe(
    asking: Asking,
    end: int,
    disabled: FrozenSet[clingo.Symbol],
    kept: Sequence[clingo.Symbol] = (),
    believes: bool = True,
) -> Strategy[Reply]:
    """Search for an answer without the facts ``disabled`` in which the atoms ``kept`` are true.

    Its horizon is at most ``end``. The horizon grows up to that: an answer is easier to find with more steps, but
    refuting the last horizon requires grounding all of them, unless the unsat core does not depend on the horizon.
    """
    idles = asking.block > 1
    core: Set[clingo.Symbol] = set()
    blamed: Set[clingo.Symbol] = set()
    last = min(asking.horizon, end)
    while True:
        first = min(asking.min_horizon, last)
        reply = yield Question(first, last, disabled=disabled, kept=kept, believes=believes)
        if reply.satisfiable is not False:
            return reply
        core = set(reply.core) if idles else core | reply.core
        blamed = set(reply.blamed) if idles else blamed | reply.blamed
        if last == end or reply.hopeless:
            return reply._replace(core=frozenset(core), blamed=frozenset(blamed))
        last = min(end, last + (max(last - asking.min_horizon + 1, PIECE) if idles else 1))
