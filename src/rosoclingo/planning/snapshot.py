"""Snapshots: the state of a robot's stream between two updates, computed from the history without clingo."""

from dataclasses import dataclass, replace
from typing import FrozenSet, Optional, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import FAILED, RETURN, RUNNING
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.update_reader import with_their_failures
from rosoclingo.oclingo.progression.lifetimes import UPDATE
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import CloseCycles, Statement, StreamUpdate
from rosoclingo.oclingo.solving.results import NOT_EXTERNAL
from rosoclingo.oclingo.solving.stream_state import ClosedHeads, StreamState


@dataclass(frozen=True)
class Past:
    """The compacted steps of a stream, which are no longer grounded (see :mod:`~rosoclingo.planning.compaction`).

    Attributes:
        first: the first step that is still grounded.
        facts: the true atoms of compacted steps that later steps can depend on.
        shown: the shown atoms of compacted steps, each with its step.

    """

    first: int
    facts: FrozenSet[clingo.Symbol]
    shown: Tuple[Tuple[int, clingo.Symbol], ...] = ()


@dataclass(frozen=True)
class Snapshot(StreamState):
    """The state of a robot's stream between two updates.

    Attributes:
        past: the compacted steps, None for none.

    """

    past: Optional[Past] = None

    @property
    def size(self) -> int:
        """Approximate number of values."""
        return len(self.items) + sum(len(one.atoms) for one in self.items if isinstance(one, ClosedHeads))

    @property
    def is_steady(self) -> bool:
        """Whether no statement lapses with the next update."""
        return all(one.lifetime != UPDATE for one in self.timed_statements)

    @property
    def running(self) -> FrozenSet[clingo.Symbol]:
        """The ``_running`` atoms of the last cycle."""
        heads = [one.head for one in self.statements if one.head is not None and signature_of(one.head) == RUNNING]
        return frozenset(one for one in heads if one.arguments[2] == clingo.Number(self.step - 1))

    @property
    def awaiting_returns(self) -> FrozenSet[int]:
        """The closed cycles whose returns can still arrive: the last one, and the last one with actions."""
        done = (cycle for cycle, executed in self.closed.items() if executed)
        return frozenset({max(self.closed), max(done, default=max(self.closed))}) if self.closed else frozenset()

    def closed_until(self, first: int) -> int:
        """Return the last step up to which all cycles from ``first`` on are closed; ``first - 1`` for none."""
        last = first - 1
        while last + 1 in self.closed:
            last += 1
        return last

    def is_too_late(self, program: ReactiveProgram, atom: clingo.Symbol) -> bool:
        """Return whether only compacted steps can depend on ``atom``, which was not asserted so far."""
        if self.past is None:
            return False
        last = self.past.first - 1
        if program.can_declare(atom, program.first_step, last):
            return not program.can_declare(atom, last + 1)
        was_visible = program.is_open_signature(atom) and program.can_see([atom], program.first_step, last)
        return was_visible and not program.can_mention(atom, last + 1)

    def mentions_later_steps(self, program: ReactiveProgram) -> bool:
        """Return whether a statement with a head can concern steps after the present one."""
        rules = (one for one in self.statements if one.head is not None)
        return any(program.can_mention(atom, self.step + 1) for one in rules for atom in one.atoms)

    # ---- Changes -----------------------------------------------------------------------------------------------------

    def without_facts(self, facts: FrozenSet[clingo.Symbol]) -> "Snapshot":
        """Return the snapshot as if ``facts`` had not been asserted; an action among them was not executed.

        Their consequences in compacted steps remain.
        """
        snapshot = super().without_facts(facts)
        if self.past is None:
            return snapshot
        return replace(snapshot, past=replace(self.past, facts=self.past.facts - with_their_failures(facts)))

    def _without_late(self, update: StreamUpdate) -> Tuple[StreamUpdate, Tuple[str, ...]]:
        """Return ``update`` without returns that can no longer arrive, and warnings about them."""
        cycles = [range(one.first, one.last + 1) for one in update.items if isinstance(one, CloseCycles)]
        ended = {one for one, done in self.closed.items() if done and any(one in some for some in cycles)}
        closed = {clingo.Number(cycle) for cycle in self.closed.keys() - self.awaiting_returns - ended}
        heads = {one for one in update.heads if one is not None and signature_of(one) in (RETURN, FAILED)}
        late = {one for one in heads if one.arguments[2] in closed}
        if not late:
            return update, ()
        items = tuple(one for one in update.items if not (isinstance(one, Statement) and one.head in late))
        known = {one.head for one in self.statements if not one.body} | (self.past.facts if self.past else set())
        return replace(update, items=items), tuple(NOT_EXTERNAL.format(one) for one in sorted(late - known))
