"""Steps whose cycles are closed, as they are ground anew: what was done is known to the steps that come next.

Else a robot might be anywhere in each of them, and they would cost as much as the steps to come.
"""

from typing import TYPE_CHECKING, Iterator, Set

from rosoclingo.oclingo.progression.updates import Statement, commitment
from rosoclingo.oclingo.solving.stream_state import FOREVER, StreamState, block_ends

if TYPE_CHECKING:
    from rosoclingo.oclingo.solving.grounding import Grounding

CLOSED_BLOCK = 16
"""So many of them are grounded at once."""


def closed_blocks(grounding: "Grounding", state: StreamState, known: int, told: Set[Statement]) -> Iterator[int]:
    """Yield the last steps of the blocks up to the step ``known``; each is to be ground before the next is asked for.

    What was done in a block, and what was not, is made known then; commitments that say so are put in ``told``.
    """
    permanent = set(state.permanent)
    first = grounding.horizon + 1
    for last in block_ends(state, first, CLOSED_BLOCK, known):
        yield last
        if grounding.conflicting:
            continue
        for cycle in range(first, last + 1):
            executed = state.closed_cycles[cycle]
            grounding.close_cycle(cycle, executed)
            for statement in filter(permanent.__contains__, map(commitment, sorted(executed))):
                grounding.add(statement, FOREVER)
                told.add(statement)
        grounding.simplify()
        first = last + 1
