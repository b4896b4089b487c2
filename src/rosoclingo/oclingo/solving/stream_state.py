"""The state of the incremental solver's stream, from which its grounding can be rebuilt at any time."""

from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any, Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Set

import clingo

from rosoclingo.oclingo.program.update_reader import with_their_failures
from rosoclingo.oclingo.progression.lifetimes import Lifetime
from rosoclingo.oclingo.progression.updates import Statement


class Lapsing(NamedTuple):
    """A statement that will lapse, or that waits until its head is declared, with its lifetime."""

    statement: Statement
    lifetime: Lifetime


@dataclass
class StreamState:
    """State of a stream between two updates.

    Attributes:
        step: k, the step of the last update.
        bound: B, the greatest horizon to search, None for no bound.
        horizon: N, the last grounded step.
        permanent: statements that hold for ever, in order.
        lapsing: statements in force that will lapse.
        waiting: statements whose head is an external that only a later step declares.
        open_atoms: atoms of open signatures seen so far, in order.
        forgotten: externals closed by ``#forget``.
        forgets_done: last step at which the program's own ``#forget`` was carried out.
        closed_cycles: the actions that were executed in each cycle that has been closed.
        cyclic: whether a statement can close a positive loop over several steps. Such a stream is reground for each
            search, since clingo detects loops only among rules added between two searches.
        told: remarks on the stream that were reported.

    """

    step: int = 1
    horizon: int = 1
    bound: Optional[int] = None
    permanent: List[Statement] = field(default_factory=list)
    lapsing: List[Lapsing] = field(default_factory=list)
    waiting: List[Lapsing] = field(default_factory=list)
    open_atoms: List[clingo.Symbol] = field(default_factory=list)
    forgotten: Set[clingo.Symbol] = field(default_factory=set)
    forgets_done: int = 0
    closed_cycles: Dict[int, FrozenSet[clingo.Symbol]] = field(default_factory=dict)
    cyclic: bool = False
    told: Set[str] = field(default_factory=set)

    @property
    def facts(self) -> Set[clingo.Symbol]:
        """The facts that never lapse."""
        return {one.head for one in self.permanent if one.head is not None and not one.body}

    def rules(self) -> Iterator[Statement]:
        """Yield the statements in force that have a head and a body."""
        for statement in chain(self.permanent, (entry.statement for entry in self.lapsing)):
            if statement.head is not None and statement.body:
                yield statement

    def copy(self) -> "StreamState":
        """Return a copy that shares nothing that changes."""
        changing: Dict[str, Any] = {
            name: value.copy() for name, value in vars(self).items() if isinstance(value, (list, set, dict))
        }
        return replace(self, **changing)

    def less(self, facts: FrozenSet[clingo.Symbol]) -> "StreamState":
        """Return the state as if ``facts`` had not been asserted; an action among them was not executed."""
        less, facts = self.copy(), with_their_failures(facts)
        less.permanent = [statement for statement in less.permanent if not statement.concerns(facts)]
        less.lapsing = [entry for entry in less.lapsing if not entry.statement.concerns(facts)]
        less.waiting = [entry for entry in less.waiting if not entry.statement.concerns(facts)]
        less.open_atoms = [atom for atom in less.open_atoms if atom not in facts]
        less.closed_cycles = {cycle: executed - facts for cycle, executed in less.closed_cycles.items()}
        return less
