"""Beliefs: the part of the past that rules of later steps can see. States with equal beliefs behave alike."""

from typing import Dict, FrozenSet, NamedTuple, Optional, Tuple

import clingo

from rosoclingo.checking.verifying.time_shift import TimeShift
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.reasoning.keywords import FAILED, RETURN

_ANSWERS = (Signature(RETURN, 3), Signature(FAILED, 3))


class Belief(NamedTuple):
    """The visible atoms of the past, with times relative to a step, and the phase of that step."""

    atoms: FrozenSet[clingo.Symbol]
    phase: Tuple[int, ...]

    @property
    def without_answers(self) -> FrozenSet[clingo.Symbol]:
        """The atoms without returns."""
        return frozenset(one for one in self.atoms if signature_of(one) not in _ANSWERS)


class Beliefs:
    """Reads beliefs from answers.

    As programs choose only actions, the past before step k is the same in all answers after the update of step k.
    """

    def __init__(self, program: ReactiveProgram) -> None:
        self._program = program
        self._shift = TimeShift(program.parts)
        self._stepped = program.external_signatures | program.step_signatures
        self._relative: Dict[Tuple[clingo.Symbol, int], Optional[clingo.Symbol]] = {}
        self._visible: Dict[clingo.Symbol, bool] = {}

    def belief(self, atoms: FrozenSet[clingo.Symbol], snapshot: Snapshot, late: int) -> Belief:
        """Return the belief in a snapshot, with all true ``atoms``, for facts that are at most ``late`` steps late."""
        first = snapshot.step - late
        facts = (one.head for one in snapshot.permanent if one.head is not None and not one.body)
        executed = (one for cycle, actions in snapshot.closed.items() if cycle >= first for one in actions)
        times = ((one, self._shift.time_of(one)) for one in (*facts, *executed))
        inputs = (self._shift.shift(one, -first) for one, time in times if time is None or time >= first)
        past = (self._relative_to(first, atom) for atom in atoms)
        visible = frozenset(one for one in past if one is not None).union(filter(self._is_visible, inputs))
        return Belief(visible, self._shift.phase(first, frozenset(map(signature_of, visible))))

    def _relative_to(self, first: int, atom: clingo.Symbol) -> Optional[clingo.Symbol]:
        """Return an atom of a step before ``first`` with times relative to it, None if no later rule can see it."""
        key = atom, first
        if key not in self._relative:
            time = self._shift.time_of(atom)
            if time is None:
                self._relative[key] = atom if signature_of(atom) in self._stepped else None
            else:
                moved = self._shift.shift(atom, -first)
                self._relative[key] = moved if time < first and self._is_visible(moved) else None
        return self._relative[key]

    def _is_visible(self, atom: clingo.Symbol) -> bool:
        """Return whether rules of step 0 or later can see an earlier atom."""
        if atom not in self._visible:
            self._visible[atom] = self._program.can_mention(atom, 0)
        return self._visible[atom]
