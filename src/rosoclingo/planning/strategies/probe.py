"""What would be, had some facts not been told: asked of a grounding in which these facts are assumable.

A question without an answer has a core: a few of the facts because of which there is none (see clingo's
``SolveHandle.core``). Every other question that agrees on these has no answer either.
"""

from typing import FrozenSet, NamedTuple, Optional, Sequence, Set

import clingo

from rosoclingo.planning.asking import Asking
from rosoclingo.planning.question import Question, Reply, Strategy

PIECE = 32
"""Steps to grow by at least before the next question."""


class Verdict(NamedTuple):
    """Whether there is an answer, None if that was not found out before a stop.

    If there is none, ``core`` holds assumable facts: it is so whenever these are told or disabled as they were.
    """

    satisfiable: Optional[bool]
    core: FrozenSet[clingo.Symbol] = frozenset()


def probe(
    asking: Asking,
    least: int,
    disabled: FrozenSet[clingo.Symbol],
    kept: Sequence[clingo.Symbol] = (),
    believes: bool = True,
) -> Strategy[Reply]:
    """Look for an answer, had the facts ``disabled`` not been told, in which the atoms ``kept`` are true.

    It may have a horizon of at least ``least``, whatever the bound. The longest horizon that may do is asked for last:
    with more steps it is easier to find an answer, but all of them have to be ground if there is none, unless the
    reason for that has nothing to do with the horizon.
    """
    idles = asking.block > 1
    core: Set[clingo.Symbol] = set()
    blamed: Set[clingo.Symbol] = set()
    end = max(least, asking.last())
    last = min(asking.horizon, end)
    while True:
        reply = yield Question(min(asking.first, last), last, disabled=disabled, kept=kept, believes=believes)
        if reply.satisfiable is not False:
            return reply
        core = set(reply.core) if idles else core | reply.core
        blamed = set(reply.blamed) if idles else blamed | reply.blamed
        if last == end or reply.hopeless:
            return reply._replace(core=frozenset(core), blamed=frozenset(blamed))
        last = min(end, last + (max(last - asking.first + 1, PIECE) if idles else 1))
