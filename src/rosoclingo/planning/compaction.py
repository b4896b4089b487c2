"""Compaction: later groundings get decided steps as facts, so that a long stream costs no more than a short one.

Let R be the ground rules of the first steps. Each atom of R has to be fixed: true in all answers or in none, whatever
follows. No statement with a body may define one. R is dropped, and the rest of the program gets

* a fact for each true atom that R or a fact of the stream defines, and
* a constraint with the value of each other atom of R that base defines, since a constraint of R may have decided it.

The remaining atoms of R are externals that nothing defines. The answers stay the same:

* An old answer is a new one: what R derived in it is a fact now, and the constraints hold as the atoms are fixed.
* A new answer is an old one: the atoms of R have their fixed values in it, so the rules of R hold. They derive the
  facts as before: no body of R depends on a head of R by other rules, as no statement closes a loop.
"""

from dataclasses import replace
from typing import Iterator, List, Optional, Set

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.updates import Literal, Statement
from rosoclingo.planning.fixed_atoms import FixedAtoms, fixed_atoms
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.snapshot import ClosedHeads, Past, Snapshot, SnapshotItem, TimedStatement

MOST_STEPS = 16
"""So many steps to retire are worth a look."""

SHOWN_STEPS = 10
"""For so many steps answers still tell what was shown of a retired step."""


def compacted(grounding: Grounding, snapshot: Snapshot) -> Optional[Snapshot]:
    """Return the ``snapshot`` of a search without the steps that are decided; None if there are none.

    The steps are over: externals that they declare and that nothing has defined are false from now on. As long as a
    statement can lapse nothing is decided.
    """
    start, before = grounding.past.first, end_of_past(grounding.program, snapshot)
    if before <= start or grounding.shown is None or grounding.is_cyclic or any(snapshot.lapsing):
        return None
    grounding.forget(start, before - 1, base=False)
    statements = [one.statement for one in grounding.in_force]
    facts = {one.head for one in statements if one.head is not None and not one.body}
    heads = {one.head for one in statements}
    fixed = fixed_atoms(grounding, before, heads - facts)
    return _moved(grounding, snapshot, fixed, facts) if fixed.first > start else None


def end_of_past(program: ReactiveProgram, snapshot: Snapshot) -> int:
    """Return the step before which steps are over, and the program's volatile rules for them hold no more."""
    return min(snapshot.keep_from, snapshot.step + 1 - max(program.windows))


def _moved(grounding: Grounding, snapshot: Snapshot, fixed: FixedAtoms, facts: Set[clingo.Symbol]) -> Snapshot:
    """Return the snapshot that begins with the first step that is not decided; the stream has told the ``facts``."""
    program, first, old = grounding.program, fixed.first, grounding.past
    true = facts | (fixed.true & fixed.defined) | old.facts
    left = list(_shortened(grounding, fixed, true))
    mentioned = {literal.atom for one in left for literal in one.statement.body}

    def matters(atom: clingo.Symbol) -> bool:
        """Tell whether base, the steps to come or a statement that is left can mention an atom."""
        if atom in mentioned or atom in fixed.base:
            return True
        return program.may_mention(atom, first) or program.may_declare(atom, first)

    shown = {atom: step for step, atom in old.shown}
    for atom in (grounding.shown or frozenset()) & (fixed.steps.keys() - fixed.base | facts):
        shown.setdefault(atom, fixed.steps.get(atom, first - 1))
    kept = set(filter(matters, true))
    opened = set(filter(program.is_open_signature, kept & facts))  # base has to know of these
    false = frozenset(filter(matters, grounding.false))
    # the last cycle is told for its returns, those before it for the actions that steps to come can still have of them
    closed = {c: done for c, done in snapshot.closed.items() if c >= first - 1 or program.may_act(c, first)}
    recent = tuple((step, atom) for atom, step in shown.items() if step >= first - SHOWN_STEPS)
    told: List[SnapshotItem] = [*(TimedStatement(Statement(atom), FOREVER, 0) for atom in sorted(opened)), *left]
    told += [ClosedHeads(false)] if false else []
    return replace(snapshot, items=tuple(told), closed=closed, past=Past(first, frozenset(kept - opened), recent))


def _shortened(grounding: Grounding, fixed: FixedAtoms, true: Set[clingo.Symbol]) -> Iterator[TimedStatement]:
    """Yield the constraints on atoms of base, and the statements in order but for facts, without what facts decide."""
    decided = fixed.steps.keys() - fixed.base | true
    ties = {Statement(None, (Literal(atom, atom not in fixed.true),)) for atom in fixed.steps.keys() - decided}
    known = {*grounding.in_force, *grounding.waiting}
    for told in filter(known.__contains__, grounding.snapshot.timed_statements):
        statement = told.statement
        if statement.head is None:
            if any(one.atom in decided and (one.atom in true) is not one.positive for one in statement.body):
                continue
            statement = Statement(None, tuple(one for one in statement.body if one.atom not in decided))
            ties.discard(statement)
        if statement.head not in true:
            yield told._replace(statement=statement)
    for tie in sorted(ties, key=str):
        yield TimedStatement(tie, FOREVER, 0)
