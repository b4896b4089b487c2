"""Beliefs: the part of the past that rules of later steps can see. States with equal beliefs behave alike."""

from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Sequence, Tuple
from weakref import WeakKeyDictionary

import clingo

from rosoclingo.checking.verifying.time_shift import TimeShift
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Read
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.reasoning.keywords import FAILED, NEVER, RETURN

_ANSWERS = (Signature(RETURN, 3), Signature(FAILED, 3))

_Literals = List[Tuple[clingo.Symbol, int]]


class Belief(NamedTuple):
    """The visible atoms of the past, with times relative to a step, and the phase of that step."""

    atoms: FrozenSet[clingo.Symbol]
    phase: Tuple[int, ...]

    @property
    def without_answers(self) -> FrozenSet[clingo.Symbol]:
        """The atoms without returns."""
        return frozenset(one for one in self.atoms if signature_of(one) not in _ANSWERS)


class _AtomsByTime:
    """The atoms of a grounding by time (None without one), the visible ones by step, and the forbidden states."""

    def __init__(self, grounding: Grounding, shift: TimeShift) -> None:
        self.at: Dict[Optional[int], _Literals] = {}
        self.seen: Dict[int, _Literals] = {}
        self.never: _Literals = []
        for atom, literal in grounding.atom_literals:
            self.at.setdefault(shift.time_of(atom), []).append((atom, literal))
            if atom.match(NEVER, 2) and atom.arguments[1].type is clingo.SymbolType.Number:
                self.never.append((atom, literal))


class Beliefs:
    """Reads beliefs from models; ``late`` is the number of steps that facts can be late.

    As programs choose only actions, the past before step k is the same in all answers after the update of step k.
    """

    def __init__(self, program: ReactiveProgram, late: int) -> None:
        self.late = late
        self._program = program
        self._shift = TimeShift(program.parts, program.values)
        self._stepped = program.external_signatures | program.step_signatures
        self._visible: Dict[clingo.Symbol, bool] = {}
        self._atoms: WeakKeyDictionary[Grounding, _AtomsByTime] = WeakKeyDictionary()

    def readers(self, grounding: Grounding, step: int) -> Sequence[Read]:
        """Return readers of the visible past before ``step``, of that for late facts, and of forbidden states."""
        if grounding not in self._atoms:
            self._atoms[grounding] = _AtomsByTime(grounding, self._shift)
        atoms = self._atoms[grounding]
        for first in (step, step - self.late):
            if first not in atoms.seen:
                atoms.seen[first] = list(self._seen(atoms, first))
        never = [(one, literal) for one, literal in atoms.never if one.arguments[1].number <= step]
        return [_reader(one) for one in (atoms.seen[step], atoms.seen[step - self.late], never)]

    def belief(self, atoms: FrozenSet[clingo.Symbol], snapshot: Snapshot, late: int) -> Belief:
        """Return the belief in a snapshot from the ``atoms`` read, for facts that are at most ``late`` steps late."""
        first = snapshot.step - late
        facts = (one.head for one in snapshot.permanent if one.head is not None and not one.body)
        executed = (one for cycle, actions in snapshot.closed.items() if cycle >= first for one in actions)
        times = ((one, self._shift.time_of(one)) for one in (*facts, *executed))
        inputs = (self._shift.shift(one, -first) for one, time in times if time is None or time >= first)
        visible = atoms.union(filter(self._is_visible, inputs))
        return Belief(visible, self._shift.phase(first, frozenset(map(signature_of, visible))))

    def _seen(self, atoms: _AtomsByTime, first: int) -> Iterator[Tuple[clingo.Symbol, int]]:
        """Yield the atoms of steps before ``first`` that later rules can see, with times relative to ``first``."""
        for time, found in atoms.at.items():
            if time is None:
                yield from (one for one in found if signature_of(one[0]) in self._stepped)
            elif time < first:
                moved = ((self._shift.shift(atom, -first), literal) for atom, literal in found)
                yield from (one for one in moved if self._is_visible(one[0]))

    def _is_visible(self, atom: clingo.Symbol) -> bool:
        """Return whether rules of step 0 or later can see an earlier atom."""
        if atom not in self._visible:
            self._visible[atom] = self._program.can_mention(atom, 0)
        return self._visible[atom]


def _reader(atoms: Sequence[Tuple[clingo.Symbol, int]]) -> Read:
    return lambda model: frozenset(atom for atom, literal in atoms if model.is_true(literal))
