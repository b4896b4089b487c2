"""What is left of the past: all that the rules of steps to come can see of it, so that equal states go on alike."""

from typing import Dict, FrozenSet, Iterable, List, NamedTuple, Sequence, Tuple

import clingo

from rosoclingo.checking.verifying.time_shift import TimeShift
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.planning.grounding import Grounding
from rosoclingo.planning.question import Read
from rosoclingo.planning.snapshot import Snapshot
from rosoclingo.reasoning.keywords import FAILED, NEVER, RETURN

_EMPTY_LAYERS = 3
"""So many steps in a row of which nothing is seen: then nothing before them is."""

_NEVER = Signature(NEVER, 2)

_ANSWERS = (Signature(RETURN, 3), Signature(FAILED, 3))


class Belief(NamedTuple):
    """What matters of the past at a step, with times counted from it, and what of the step itself matters."""

    atoms: FrozenSet[clingo.Symbol]
    phase: Tuple[int, ...]

    @property
    def has_answers(self) -> bool:
        """Whether it holds how actions have ended."""
        return any(signature_of(one) in _ANSWERS for one in self.atoms)

    def without_answers(self) -> FrozenSet[clingo.Symbol]:
        """Return the atoms but those that tell how actions have ended."""
        return frozenset(one for one in self.atoms if signature_of(one) not in _ANSWERS)


class Beliefs:
    """Reads beliefs of the models of a program.

    The past before step k is sure in every answer once the updates up to step k are taken, where programs guess nothing
    but actions, as they have to.
    """

    def __init__(self, program: ReactiveProgram, late: int) -> None:
        """Facts may come so many steps ``late``."""
        self.late = late
        self.shift = TimeShift(program.parts, program.values)
        self._program = program
        self._visible: Dict[clingo.Symbol, bool] = {}
        self._by_time: Dict[int, Dict[int, List[Tuple[clingo.Symbol, int]]]] = {}
        self._timeless: Dict[int, List[Tuple[clingo.Symbol, int]]] = {}
        self._never: Dict[int, List[Tuple[clingo.Symbol, int]]] = {}
        self._layers: Dict[Tuple[int, int], List[Tuple[clingo.Symbol, int]]] = {}

    def readers(self, grounding: Grounding, step: int) -> Sequence[Read]:
        """Return what to read of a model: what matters, what does where facts may come late, and what must never be."""
        now, before = self._seen(grounding, step), self._seen(grounding, step - self.late)
        if grounding.horizon not in self._never:
            self._never[grounding.horizon] = [one for one in grounding.atom_literals if signature_of(one[0]) == _NEVER]
        never = [one for one in self._never[grounding.horizon] if self._is_by(one[0], step)]
        return [_reader(now), _reader(before), _reader(never)]

    def of(self, atoms: FrozenSet[clingo.Symbol], snapshot: Snapshot, late: int) -> Belief:
        """Return the belief in a snapshot, where ``atoms`` are those that were read, and facts may come so ``late``."""
        first = snapshot.step - late
        told = (one.head for one in snapshot.permanent if one.head is not None and not one.body)
        done = (one for cycle, actions in snapshot.closed.items() if cycle >= first for one in actions)
        inputs = {self.shift.moved(one, -first) for one in (*told, *done) if self._is_from(one, first)}
        every = atoms | frozenset(filter(self._is_visible, inputs))
        return Belief(every, self.shift.phase(first, frozenset(map(signature_of, every))))

    def _is_from(self, fact: clingo.Symbol, first: int) -> bool:
        time = self.shift.time_of(fact)
        return time is None or time >= first

    @staticmethod
    def _is_by(never: clingo.Symbol, step: int) -> bool:
        time = never.arguments[-1]
        return time.type is clingo.SymbolType.Number and time.number <= step

    def _seen(self, grounding: Grounding, first: int) -> List[Tuple[clingo.Symbol, int]]:
        """Return the atoms of steps before ``first`` that the steps from there on see, counted from there."""
        key = grounding.horizon, first
        if key not in self._layers:
            self._layers[key] = list(self._look(grounding, first))
        return self._layers[key]

    def _look(self, grounding: Grounding, first: int) -> Iterable[Tuple[clingo.Symbol, int]]:
        if grounding.horizon not in self._by_time:
            self._by_time[grounding.horizon] = self._atoms_by_time(grounding)
        by_time, empty = self._by_time[grounding.horizon], 0
        for time in sorted((one for one in by_time if one < first), reverse=True):
            moved = [(self.shift.moved(atom, -first), literal) for atom, literal in by_time[time]]
            seen = [one for one in moved if self._is_visible(one[0])]
            yield from seen
            empty = 0 if seen else empty + 1
            if empty == _EMPTY_LAYERS:
                break
        if grounding.horizon not in self._timeless:
            self._timeless[grounding.horizon] = self._timeless_atoms(grounding)
        yield from self._timeless[grounding.horizon]

    def _atoms_by_time(self, grounding: Grounding) -> Dict[int, List[Tuple[clingo.Symbol, int]]]:
        """Return the atoms that have a time, with their literals, by that."""
        found: Dict[int, List[Tuple[clingo.Symbol, int]]] = {}
        for atom, literal in grounding.atom_literals:
            time = self.shift.time_of(atom)
            if time is not None:
                found.setdefault(time, []).append((atom, literal))
        return found

    def _timeless_atoms(self, grounding: Grounding) -> List[Tuple[clingo.Symbol, int]]:
        """Return the atoms that steps define, or that are told, of which nothing tells a time."""
        defined = self._program.external_signatures | self._program.step_signatures
        return [
            (atom, literal)
            for atom, literal in grounding.atom_literals
            if signature_of(atom) in defined and self.shift.time_of(atom) is None
        ]

    def _is_visible(self, atom: clingo.Symbol) -> bool:
        """Tell whether the rules from step 0 on see an atom of before."""
        if atom not in self._visible:
            self._visible[atom] = self._program.may_mention(atom, 0)
        return self._visible[atom]


def _reader(atoms: Sequence[Tuple[clingo.Symbol, int]]) -> Read:
    def read(model: clingo.Model) -> FrozenSet[clingo.Symbol]:
        """Return those that are true."""
        return frozenset(atom for atom, literal in atoms if model.is_true(literal))

    return read
