"""Steps that are over: told to later groundings as facts, so that a long stream costs no more than a short one.

A step can be retired once every atom of its ground rules is fixed for good: by splitting, its rules and the facts that
hold at it are worth the same to all that comes later. What it takes is that requests, commitments, returns and other
facts decide all that rules say of the past; where something stays open, steps from there on are ground as ever.
"""

from typing import List, Optional, Sequence, Set

import clingo

from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.updates import Literal, Statement
from rosoclingo.oclingo.solving.fixed_atoms import Census
from rosoclingo.oclingo.solving.grounding import Engine
from rosoclingo.oclingo.solving.stream_state import Past, StreamState

RETIRE_AFTER = 100
"""Steps to retire that are worth a grounding of its own; fewer wait for one that has another reason."""

RETIRE_ALONG = 16
"""Steps to retire that are worth a look when the program is ground anew for another reason."""

SHOWN_STEPS = 10
"""For so many steps answers still tell what was shown of a retired step."""


def first_step(program: ReactiveProgram, state: StreamState) -> int:
    """Return the first step that is ground."""
    return program.first_step if state.past is None else state.past.first


def is_due(program: ReactiveProgram, state: StreamState, along: bool = False) -> bool:
    """Tell whether enough steps are over, since the last try as well, to retire them now, ``along`` or on their own."""
    over = state.keep_from - max(first_step(program, state), state.tried)
    return over >= (RETIRE_ALONG if along else RETIRE_AFTER)


def is_too_late(program: ReactiveProgram, state: StreamState, atom: clingo.Symbol) -> bool:
    """Tell whether only steps that have been retired could have known of ``atom``, which nobody has told yet."""
    if state.past is None:
        return False
    first, last = program.first_step, state.past.first - 1
    if program.may_declare(atom, first, last):
        return not program.may_declare(atom, last + 1)
    known = program.is_open_signature(atom) and program.may_see([atom], first, last)
    return known and not program.may_mention(atom, last + 1)


def retire(program: ReactiveProgram, state: StreamState, engine: Engine) -> bool:
    """Move decided steps before ``state.keep_from`` into ``state.past``; tell whether there were any.

    Externals that these steps declare and that nothing has defined are closed. The engine fits the state no longer if
    True is returned.
    """
    start = first_step(program, state)
    # from step ``before`` on volatile rules may still hold
    before = min(state.keep_from, state.step + 1 - max(program.windows), engine.horizon + 1)
    if before <= start or not engine.satisfied:
        return False
    state.tried = state.keep_from
    _close(state, engine, start, before)
    census = engine.census(start, before)
    if census.first <= start:
        return False
    statements = _Statements(engine, census, state.permanent)
    if statements.sound:
        _move(program, state, engine, census, statements)
    return statements.sound


def _close(state: StreamState, engine: Engine, start: int, before: int) -> None:
    """Close what steps start..before-1 declared external and nothing has defined."""
    engine.settle(state.settled)
    defined = {entry.statement.head for entry in state.lapsing}
    for atom in engine.declared_between(start, before - 1, base=False):
        if atom not in defined:
            engine.atoms.close(atom)
            state.forgotten.add(atom)


class _Statements:
    """Permanent statements with bodies, less what is decided: new facts, and what is left of the others."""

    def __init__(self, engine: Engine, census: Census, statements: Sequence[Statement]) -> None:
        self._engine, self._values = engine, census.values
        defined = census.defined
        self._past = {atom for atom, literal in census.literals.items() if literal in defined}
        self.facts = {one.head for one in statements if one.head is not None and not one.body}
        self.kept: List[Statement] = []
        self.false: Set[clingo.Symbol] = set()  # heads that were defined, but never come true
        self.sound = True  # False where a statement still ties the past to what is open
        for statement in statements:
            if statement.body:
                self._take(statement)

    def _take(self, statement: Statement) -> None:
        if any(self._value(literal.atom) is (not literal.positive) for literal in statement.body):
            if statement.head is not None:
                self.false.add(statement.head)
            return
        body = tuple(literal for literal in statement.body if self._value(literal.atom) is None)
        if statement.head is None or body:
            self.kept.append(Statement(statement.head, body))
            self.sound = self.sound and bool(body) and statement.head not in self._past
        else:
            self.facts.add(statement.head)

    def _value(self, atom: clingo.Symbol) -> Optional[bool]:
        """Return what is decided of ``atom`` without regard to constraints, which may be the ones in question."""
        decided = atom in self._past or atom in self.facts or self._engine.atoms.is_closed(atom)
        return self._values.get(atom) if decided else None


def _move(
    program: ReactiveProgram, state: StreamState, engine: Engine, census: Census, statements: _Statements
) -> None:
    """Write down in ``state`` what was found."""
    first, old = census.first, state.past

    def matters(atom: clingo.Symbol) -> bool:
        return program.may_mention(atom, first) or program.may_declare(atom, first)

    steps, defined = census.steps, census.defined
    true = {atom for atom, value in census.values.items() if value}
    told = {atom for atom in true if census.literals[atom] in defined} | (old.facts if old is not None else set())
    shown = [] if old is None else list(old.shown)
    theirs = steps.keys() - census.base
    fresh = {atom for atom in engine.shown & true if census.literals[atom] in theirs}
    fresh |= engine.shown & statements.facts
    fresh -= {atom for _, atom in shown}
    shown += [(steps.get(census.literals[atom], first - 1), atom) for atom in fresh]
    facts = set(filter(matters, statements.facts))
    known = {atom for atom in facts if program.is_open_signature(atom) or program.may_declare(atom, first)}
    shown = [one for one in shown if one[0] >= first - SHOWN_STEPS]
    state.past = Past(first, frozenset(filter(matters, told)) | facts - known, tuple(shown))
    state.permanent = [*map(Statement, known), *statements.kept, *_ties(engine, census, set(statements.kept))]
    state.open_atoms = [atom for atom in state.open_atoms if atom not in census.values or matters(atom)]
    state.forgotten = {atom for atom in state.forgotten | (statements.false - true) if matters(atom)}
    state.closed_cycles = {cycle: done for cycle, done in state.closed_cycles.items() if cycle >= first - 1}


def _ties(engine: Engine, census: Census, kept: Set[Statement]) -> List[Statement]:
    """Return constraints for what retired steps have decided of atoms that are not theirs, a choice of base say."""
    mentioned = census.steps.keys() & census.base
    found: List[Statement] = []
    for atom, value in census.values.items():
        # clingo calls facts what constraints have fixed: whether the atom is one tells nothing
        if census.literals[atom] in mentioned and (value or not engine.atoms.is_closed(atom)):
            statement = Statement(None, (Literal(atom, not value),))
            found += [statement] if statement not in kept else []
    return found
