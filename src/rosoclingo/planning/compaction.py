"""Compaction: later groundings contain decided steps as facts, so that a long stream costs no more than a short one.

Let R be the ground rules of the first steps; a program with theory atoms or edges of a graph means more than these
and is not compacted. Each atom of R must be fixed: true in all answers or in none, for all possible updates. No
statement with a body may define an atom of R. R is dropped, and the rest of the program gets

* a fact for each true atom that R or a fact of the stream defines, and
* a constraint with the value of each other atom of R that base defines, since a constraint of R may have decided it.

The remaining atoms of R are externals without a definition. clingo leaves atoms out of R whose values it knows; they
are fixed as well: a true one is a fact of R by then, and a false one stays without a definition. The answers stay the
same:

* An old answer is a new answer: what R derived in it is a fact now, and the constraints hold as the atoms are fixed.
* A new answer is an old answer: the atoms of R have their fixed values in it, so the rules of R hold. They derive the
  facts as before: no body of R depends on a head of R by other rules, as no statement closes a loop.
"""

from dataclasses import replace
from typing import Iterator, List, Optional, Set

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.updates import Literal, Statement
from rosoclingo.oclingo.solving.results import Answer
from rosoclingo.oclingo.solving.stream_state import ClosedHeads, StateItem, TimedStatement
from rosoclingo.planning.fixed_atoms import FixedAtoms, ObservedGrounding, fixed_atoms
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.history import Plan
from rosoclingo.planning.question import Question, Stop, never
from rosoclingo.planning.return_rules import is_opaque
from rosoclingo.planning.snapshot import Past, Snapshot

SHOWN_STEPS = 10
"""Number of compacted steps whose shown atoms answers still contain."""


def compacted(program: ReactiveProgram, snapshot: Snapshot, plan: Plan, stopped: Stop = never) -> Optional[Snapshot]:
    """Return the ``snapshot`` without its decided steps; None if no step is decided.

    Undefined externals of past steps become false. No step is decided while a statement can lapse. ``plan`` is the plan
    in force. Raises like :class:`Grounding`.
    """
    start, end = first_open(program, snapshot), end_of_past(program, snapshot)
    if end <= start or any(snapshot.lapsing) or is_opaque(program):
        return None
    grounding = _past(program, snapshot, plan, stopped)
    if grounding.shown is None or grounding.is_cyclic:
        return None
    grounding.forget(start, end - 1, base=False)
    statements = [one.statement for one in grounding.statements]
    facts = {one.head for one in statements if one.head is not None and not one.body}.union(grounding.open_facts)
    heads = {one.head for one in statements}
    fixed = fixed_atoms(grounding, end, heads - facts)
    return _without_fixed_steps(grounding, snapshot, fixed, facts) if fixed.first > start else None


def _past(program: ReactiveProgram, snapshot: Snapshot, plan: Plan, stopped: Stop) -> ObservedGrounding:
    """Return a grounding of the past and present steps, with an answer for the actions of ``plan``.

    The horizon of the answer lies so far beyond these steps that none of their volatile rules hold.
    """
    step = snapshot.step
    grounding = ObservedGrounding(program, replace(snapshot, horizon=step), step, stopped=stopped, settles=False)
    horizon = step + max(program.windows)
    actions = plan.fixing(grounding.actions(program.first_step, step))
    grounding.ask(Question(horizon, horizon, actions, believes=False), never)
    return grounding


def recent_atoms(answer: Answer, step: int, program: ReactiveProgram) -> Answer:
    """Return ``answer`` without atoms of cycles that lie more than :data:`SHOWN_STEPS` before ``step``.

    Otherwise the answers of a long run would grow until the next compaction.
    """

    def is_recent(atom: clingo.Symbol) -> bool:
        """Return whether an atom has a recent cycle or none."""
        time = program.time_of(atom)
        return time is None or time >= step - SHOWN_STEPS

    return frozenset(filter(is_recent, answer))


def first_open(program: ReactiveProgram, snapshot: Snapshot) -> int:
    """Return the first step that is not compacted."""
    return program.first_step if snapshot.past is None else snapshot.past.first


def end_of_past(program: ReactiveProgram, snapshot: Snapshot) -> int:
    """Return the first step that updates can still concern, or for which volatile rules still hold."""
    return min(snapshot.keep_from, snapshot.step + 1 - max(program.windows))


def _without_fixed_steps(
    grounding: Grounding, snapshot: Snapshot, fixed: FixedAtoms, facts: Set[clingo.Symbol]
) -> Snapshot:
    """Return the snapshot that begins with the first undecided step; ``facts`` are the facts of the stream."""
    program, first, old = grounding.program, fixed.first, grounding.past
    true = facts | (fixed.true & fixed.defined) | old.facts
    left = list(_simplified(grounding, fixed, true))
    mentioned = {literal.atom for one in left for literal in one.statement.body}

    def matters(atom: clingo.Symbol) -> bool:
        """Return whether base, later steps or a remaining statement can mention an atom."""
        if atom in mentioned or atom in fixed.base:
            return True
        return program.can_mention(atom, first) or program.can_declare(atom, first)

    shown = {atom: step for step, atom in old.shown}
    for atom in (grounding.shown or frozenset()) & (fixed.steps.keys() - fixed.base | facts):
        shown.setdefault(atom, fixed.steps.get(atom, first - 1))
    kept = set(filter(matters, true))
    opened = set(filter(program.is_open_signature, kept & facts))  # base has to declare these
    false = frozenset(filter(matters, grounding.definitions.false))
    # The last cycle can still get returns. Actions of earlier cycles are needed while later steps can define more.
    closed = {c: done for c, done in snapshot.closed.items() if c >= first - 1 or program.can_act(c, first)}
    recent = tuple((step, atom) for atom, step in shown.items() if step >= first - SHOWN_STEPS)
    items: List[StateItem] = [*(TimedStatement(Statement(atom), FOREVER, 0) for atom in sorted(opened)), *left]
    items += [ClosedHeads(false)] if false else []
    return replace(snapshot, items=tuple(items), closed=closed, past=Past(first, frozenset(kept - opened), recent))


def _simplified(grounding: Grounding, fixed: FixedAtoms, true: Set[clingo.Symbol]) -> Iterator[TimedStatement]:
    """Yield the statements that the decided atoms do not satisfy, in order, and the constraints on atoms of base."""
    decided = fixed.steps.keys() - fixed.base | true
    ties = {Statement(None, (Literal(atom, atom not in fixed.true),)) for atom in fixed.steps.keys() - decided}
    known = {*grounding.statements, *grounding.deferred}
    for entry in filter(known.__contains__, grounding.snapshot.timed_statements):
        statement = entry.statement
        if statement.head is None:
            if any(one.atom in decided and (one.atom in true) is not one.positive for one in statement.body):
                continue
            statement = Statement(None, tuple(one for one in statement.body if one.atom not in decided))
            ties.discard(statement)
        if statement.head not in true:
            yield entry._replace(statement=statement)
    for tie in sorted(ties, key=str):
        yield TimedStatement(tie, FOREVER, 0)
