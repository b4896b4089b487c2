"""Steps that are over: later groundings get them as facts, so that a long stream costs no more than a short one.

A step can be retired once every atom of its ground rules is fixed for good: by splitting, its rules and the facts that
hold at it are worth the same to all that comes later. What it takes is that requests, commitments, returns and other
facts decide all that rules say of the past; where something stays open, steps from there on are ground as ever.
"""

from dataclasses import replace
from typing import Iterator, List, Optional, Set

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.updates import Literal, Statement
from rosoclingo.planning.fixed_atoms import FixedAtoms, look
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.snapshot import ClosedHeads, Past, Snapshot, Told

MOST_STEPS = 16
"""So many steps to retire are worth a look."""

SHOWN_STEPS = 10
"""For so many steps answers still tell what was shown of a retired step."""


def compacted(grounding: Grounding, snapshot: Snapshot) -> Optional[Snapshot]:
    """Return another form of the ``snapshot`` after a search, in which decided steps are retired; None if none are.

    Externals that these steps declare and that nothing has defined are false from now on.
    """
    program = grounding.program
    start = snapshot.first_ground(program)
    before = end_of_past(program, snapshot)
    if before <= start or not grounding.satisfied:
        return None
    grounding.forget(start, before - 1, base=False)
    fixed = look(grounding, start, before, _named(snapshot))
    if fixed.first <= start:
        return None
    statements = _Statements(grounding, fixed)
    return _moved(grounding, snapshot, fixed, statements) if statements.sound else None


def end_of_past(program: ReactiveProgram, snapshot: Snapshot) -> int:
    """Return the step before which steps are over, and the program's volatile rules for them hold no more."""
    return min(snapshot.keep_from, snapshot.step + 1 - max(program.windows))


def _named(snapshot: Snapshot) -> Iterator[clingo.Symbol]:
    """Yield the atoms that the stream has spoken of."""
    for statement in snapshot.statements:
        yield from statement.atoms


class _Statements:
    """Permanent statements with bodies, less what is decided: new facts, and what is left of the others."""

    def __init__(self, grounding: Grounding, fixed: FixedAtoms) -> None:
        self._grounding, self._values = grounding, fixed.values
        self._program, self._fixed = grounding.program, fixed
        permanent = [one for one in grounding.in_force if one.lifetime == FOREVER]
        lapsing = [one for one in grounding.in_force if one.lifetime != FOREVER]
        self.unsettled = [*lapsing, *grounding.waiting]
        self._unsettled = {one.statement.head for one in self.unsettled if one.statement.head is not None}
        self._heads = self._unsettled | {one.statement.head for one in permanent if one.statement.head is not None}
        self._past = grounding.past.facts | (fixed.literals.keys() & fixed.defined)
        self.facts = {one.statement.head for one in permanent if one.statement.head and not one.statement.body}
        self.left = {id(one): one for one in self.unsettled}  # what is left of a statement, by its identity
        self.false: Set[clingo.Symbol] = set()  # heads that were defined, but never come true
        # False where a statement still ties the past to what is open
        self.sound = not any(self._is_over(one.statement.head) for one in lapsing)
        rules = [one for one in permanent if one.statement.body]
        # heads that something open may make true: what is fixed of these, constraints may have fixed
        self._undecided = self._heads
        self._decide([one.statement for one in rules])
        for one in rules:
            self._take(one)

    def _decide(self, rules: List[Statement]) -> None:
        """Let go of the undecided heads all rules for which are decided, as long as there are any."""
        before: Set[clingo.Symbol] = set()
        while before != self._undecided:
            before = self._undecided
            heads = {one.head for one in rules if one.head is not None and not self._is_decided(one)}
            self._undecided = self._unsettled | heads

    def _is_decided(self, rule: Statement) -> bool:
        values = [(self._value(literal.atom), literal.positive) for literal in rule.body]
        return all(value is not None for value, _ in values) or any(value is (not sign) for value, sign in values)

    def _take(self, told: Told) -> None:
        statement = told.statement
        if any(self._value(literal.atom) is (not literal.positive) for literal in statement.body):
            if statement.head is not None:
                self.false.add(statement.head)
            return
        body = tuple(literal for literal in statement.body if self._value(literal.atom) is None)
        if statement.head is None or body:
            self.left[id(told)] = told._replace(statement=Statement(statement.head, body))
            self.sound = self.sound and not self._is_over(statement.head)
        else:
            self.facts.add(statement.head)

    def _is_over(self, head: Optional[clingo.Symbol]) -> bool:
        """Tell whether retired steps may have decided of ``head``, and by that of the rules that define it."""
        if head is None:
            return False
        if head in self._fixed.literals:
            return head in self._fixed.steps and head not in self._fixed.base
        # clingo lets go of the names of what is false for good
        return self._program.may_see([head], self._program.first_step, self._fixed.first - 1)

    def _value(self, atom: clingo.Symbol) -> Optional[bool]:
        """Return what is decided of ``atom`` without regard to constraints, which may be the ones in question."""
        if atom not in self._fixed.literals:
            return False if self._is_gone(atom) else None
        decided = atom in self._past or atom in self.facts or self.is_settled(atom)
        return self._values.get(atom) if decided else None

    def is_settled(self, atom: clingo.Symbol) -> bool:
        """Tell whether ``atom`` was closed, or rules of the stream define it of which all is decided."""
        return self._grounding.definitions.is_closed(atom) and atom not in self._undecided

    def _is_gone(self, atom: clingo.Symbol) -> bool:
        """Tell whether ``atom``, whose name clingo let go of as it is false for good, will not come again."""
        may_come = atom in self._heads or atom in self._grounding.definitions.awaited
        return not may_come and not self._program.may_define(atom, self._fixed.first)


def _moved(grounding: Grounding, snapshot: Snapshot, fixed: FixedAtoms, statements: _Statements) -> Snapshot:
    """Return the snapshot with what was found."""
    program, first, old = grounding.program, fixed.first, grounding.past
    mentioned = {literal.atom for one in statements.unsettled for literal in one.statement.body}

    def matters(atom: clingo.Symbol) -> bool:
        """Tell whether the steps to come, or what is not settled, may mention an atom."""
        if atom in mentioned or atom in fixed.base:
            return True
        return program.may_mention(atom, first) or program.may_declare(atom, first)

    steps, defined = fixed.steps, fixed.defined
    true = {atom for atom, value in fixed.values.items() if value}
    told = (true & defined) | old.facts
    shown = list(old.shown)
    theirs = steps.keys() - fixed.base
    fresh = grounding.shown & ((true & theirs) | statements.facts)
    fresh -= {atom for _, atom in shown}
    shown += [(steps.get(atom, first - 1), atom) for atom in fresh]
    shown = [one for one in shown if one[0] >= first - SHOWN_STEPS]
    facts = set(filter(matters, statements.facts))
    known = {atom for atom in facts if program.is_open_signature(atom) or program.may_declare(atom, first)}
    entries = [Told(Statement(atom), FOREVER, 0) for atom in sorted(known)]
    entries += _ties(fixed, statements)
    in_order = grounding.snapshot.entries
    entries += [statements.left[id(one)] for one in in_order if id(one) in statements.left]
    false = {atom for atom in grounding.false | (statements.false - true) if matters(atom)}
    # the last one is told for its returns, those before it for the actions that steps to come may yet have of them
    closed = {c: done for c, done in snapshot.closed.items() if c >= first - 1 or program.may_act(c, first)}
    past = Past(first, frozenset(filter(matters, told)) | facts - known, tuple(shown))
    closing = [ClosedHeads(frozenset(false))] if false else []
    return replace(snapshot, told=(*entries, *closing), closed=closed, past=past)


def _ties(fixed: FixedAtoms, statements: _Statements) -> List[Told]:
    """Return constraints for what retired steps have decided of atoms that are not theirs, a choice of base say."""
    mentioned, kept = fixed.steps.keys() & fixed.base, {one.statement for one in statements.left.values()}
    found: List[Told] = []
    for atom, value in fixed.values.items():
        # clingo calls facts what constraints have fixed: whether the atom is one tells nothing
        if atom in mentioned and (value or not statements.is_settled(atom)):
            statement = Statement(None, (Literal(atom, not value),))
            found += [Told(statement, FOREVER, 0)] if statement not in kept else []
    return found
