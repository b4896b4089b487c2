"""Steps that are over: later groundings get them as facts, so that a long stream costs no more than a short one.

A step can be retired once every atom of its ground rules is fixed for good: by splitting, its rules and the facts that
hold at it are worth the same to all that comes later. What it takes is that requests, commitments, returns and other
facts decide all that rules say of the past; where something stays open, steps from there on are ground as ever.
"""

from typing import Iterator, List, Optional, Set

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import Literal, Statement, StreamUpdate
from rosoclingo.oclingo.solving.fixed_atoms import FixedAtoms, look
from rosoclingo.oclingo.solving.grounding import Grounding
from rosoclingo.oclingo.solving.stream_log import Checkpoint, StreamLog
from rosoclingo.oclingo.solving.stream_state import Past, Setting, StreamState

COMPACT_AFTER = 100
"""Steps to retire that are worth a grounding of its own; fewer wait for one that has another reason."""

COMPACT_ALONG = 16
"""Steps to retire that are worth a look when the program is ground anew for another reason."""

SHOWN_STEPS = 10
"""For so many steps answers still tell what was shown of a retired step."""


def is_due(setting: Setting, state: StreamState, grounding: Grounding, update: Optional[StreamUpdate]) -> bool:
    """Tell whether steps to retire are so many, or so many for an update for which the program is ground anew.

    Not where the update takes back what was told, whose consequences would stay.
    """
    if update is not None and update.withdrawn:
        return False
    new = [head for head in setting.open_heads(update) if not grounding.atoms.knows(head)]
    anew = setting.program.may_see(new, setting.first_step(state), grounding.horizon)
    return setting.steps_over(state) >= (COMPACT_ALONG if anew else COMPACT_AFTER)


def compact(setting: Setting, state: StreamState, grounding: Grounding) -> bool:
    """Move decided steps before ``state.keep_from`` into ``state.past``; tell whether there were any.

    Externals that these steps declare and that nothing has defined are closed. The grounding no longer fits the state
    if True is returned.
    """
    program, start = setting.program, setting.first_step(state)
    # from step ``before`` on volatile rules may still hold
    before = min(state.keep_from, state.step + 1 - max(program.windows))
    if before <= start or not grounding.satisfied:
        return False
    state.tried = state.keep_from
    _close(state, grounding, start, before)
    fixed = look(grounding, start, before, _named(state))
    if fixed.first <= start:
        return False
    statements = _Statements(program, state, grounding, fixed)
    if statements.sound:
        _move(program, state, grounding, fixed, statements)
    return statements.sound


def checkpoint(setting: Setting, log: StreamLog, grounding: Optional[Grounding], idle: bool) -> StreamLog:
    """Return the ``log``, whose state ``grounding`` fits, with a checkpoint, in which steps that are over are retired.

    That is where they are many, or while the solver is ``idle`` not so many. The grounding fits the log's state as
    before: only who reads the checkpoint has less to ground.
    """
    assert log.state is not None
    if grounding is None or setting.steps_over(log.state) < (COMPACT_ALONG if idle else COMPACT_AFTER):
        return log.checkpoint()
    form = log.state.copy()
    retired = compact(setting, form, grounding)
    short = log.then(Checkpoint(form)).cut()
    short.state = log.state if retired else form
    return short


def _close(state: StreamState, grounding: Grounding, start: int, before: int) -> None:
    """Close what steps start..before-1 declared external and nothing has defined."""
    grounding.settle(state.settled)
    defined = {entry.statement.head for entry in state.lapsing}
    for atom in grounding.declared_between(start, before - 1, base=False):
        if atom not in defined:
            grounding.atoms.close(atom)
            state.forgotten.add(atom)


def _named(state: StreamState) -> Iterator[clingo.Symbol]:
    """Yield the atoms that the stream has spoken of."""
    yield from state.open_atoms
    for statement in [*state.permanent, *(entry.statement for entry in state.lapsing)]:
        yield from statement.atoms


class _Statements:
    """Permanent statements with bodies, less what is decided: new facts, and what is left of the others."""

    def __init__(self, program: ReactiveProgram, state: StreamState, grounding: Grounding, fixed: FixedAtoms) -> None:
        statements, told = state.permanent, frozenset() if state.past is None else state.past.facts
        self._grounding, self._values = grounding, fixed.values
        self._program, self._fixed = program, fixed
        self._unsettled = {one.head for one in state.unsettled() if one.head is not None}
        self._heads = self._unsettled | {one.head for one in statements if one.head is not None}
        self._past = told | (fixed.literals.keys() & fixed.defined)
        self.facts = {one.head for one in statements if one.head is not None and not one.body}
        self.kept: List[Statement] = []
        self.false: Set[clingo.Symbol] = set()  # heads that were defined, but never come true
        # False where a statement still ties the past to what is open
        self.sound = not any(self._is_over(entry.statement.head) for entry in state.lapsing)
        rules = [one for one in statements if one.body]
        # heads that something open may make true: what is fixed of these, constraints may have fixed
        self._undecided = self._heads
        self._decide(rules)
        for statement in rules:
            self._take(statement)

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

    def _take(self, statement: Statement) -> None:
        if any(self._value(literal.atom) is (not literal.positive) for literal in statement.body):
            if statement.head is not None:
                self.false.add(statement.head)
            return
        body = tuple(literal for literal in statement.body if self._value(literal.atom) is None)
        if statement.head is None or body:
            self.kept.append(Statement(statement.head, body))
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
        return self._grounding.atoms.is_closed(atom) and atom not in self._undecided

    def _is_gone(self, atom: clingo.Symbol) -> bool:
        """Tell whether ``atom``, whose name clingo let go of as it is false for good, will not come again."""
        may_come = atom in self._heads or self._grounding.atoms.is_awaited(atom)
        return not may_come and not self._program.may_define(atom, self._fixed.first)


def _move(
    program: ReactiveProgram, state: StreamState, grounding: Grounding, fixed: FixedAtoms, statements: _Statements
) -> None:
    """Write down in ``state`` what was found."""
    first, old = fixed.first, state.past
    mentioned = {literal.atom for one in state.unsettled() for literal in one.body}

    def matters(atom: clingo.Symbol) -> bool:
        """Tell whether the steps to come, or what is not settled, may mention an atom."""
        if atom in mentioned or atom in fixed.base:
            return True
        return program.may_mention(atom, first) or program.may_declare(atom, first)

    steps, defined = fixed.steps, fixed.defined
    true = {atom for atom, value in fixed.values.items() if value}
    told = (true & defined) | (old.facts if old is not None else set())
    shown = [] if old is None else list(old.shown)
    theirs = steps.keys() - fixed.base
    fresh = grounding.shown & ((true & theirs) | statements.facts)
    fresh -= {atom for _, atom in shown}
    shown += [(steps.get(atom, first - 1), atom) for atom in fresh]
    facts = set(filter(matters, statements.facts))
    known = {atom for atom in facts if program.is_open_signature(atom) or program.may_declare(atom, first)}
    shown = [one for one in shown if one[0] >= first - SHOWN_STEPS]
    state.past = Past(first, frozenset(filter(matters, told)) | facts - known, tuple(shown))
    state.permanent = [*map(Statement, known), *statements.kept, *_ties(fixed, statements)]
    state.open_atoms = [atom for atom in state.open_atoms if atom not in fixed.values or matters(atom)]
    state.forgotten = {atom for atom in state.forgotten | (statements.false - true) if matters(atom)}
    # the last one is told for its returns, those before it for the actions that steps to come may yet have of them
    closed = state.closed_cycles.items()
    state.closed_cycles = {c: done for c, done in closed if c >= first - 1 or program.may_act(c, first)}


def _ties(fixed: FixedAtoms, statements: _Statements) -> List[Statement]:
    """Return constraints for what retired steps have decided of atoms that are not theirs, a choice of base say."""
    mentioned, kept = fixed.steps.keys() & fixed.base, set(statements.kept)
    found: List[Statement] = []
    for atom, value in fixed.values.items():
        # clingo calls facts what constraints have fixed: whether the atom is one tells nothing
        if atom in mentioned and (value or not statements.is_settled(atom)):
            statement = Statement(None, (Literal(atom, not value),))
            found += [statement] if statement not in kept else []
    return found
