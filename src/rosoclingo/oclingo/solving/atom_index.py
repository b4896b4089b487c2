"""The atoms of one control, sorted by step."""

from typing import Dict, FrozenSet, Iterable, Iterator, List, Mapping, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature


class AtomIndex:
    """Atoms of some signatures, sorted by a number; looked through only when asked after something new was grounded."""

    def __init__(self, control: clingo.Control, signatures: Iterable[Signature]) -> None:
        self._control, self._signatures = control, sorted(signatures)
        self._seen: Set[int] = set()
        self._stale = True

    def expire(self) -> None:
        """Note that there may be new atoms."""
        self._stale = True

    def fresh(self) -> Iterator[Tuple[clingo.Symbol, int]]:
        """Yield the atoms, with their literals, that have not been yielded before."""
        if not self._stale:
            return
        self._stale = False
        for signature in self._signatures:
            for one in self._control.symbolic_atoms.by_signature(*signature):
                literal = one.literal  # 0 where rules mention, under not, what no rule defines yet
                if literal and literal not in self._seen:
                    self._seen.add(literal)
                    yield one.symbol, literal


class ExternalIndex(AtomIndex):
    """The externals, sorted by the step that declares them.

    Attributes:
        declared: the literal of an external -> the step with which it was ground: of a block of steps the first.
        stepless: atoms that no step declares.

    """

    def __init__(
        self,
        control: clingo.Control,
        program: ReactiveProgram,
        blocks: Mapping[int, range],
    ) -> None:
        """Take the ``blocks`` of steps ground at once, by the first of each."""
        super().__init__(control, program.external_signatures - {BEYOND})
        self._program, self._blocks = program, blocks
        self.declared: Dict[int, int] = {}
        self.stepless: Set[clingo.Symbol] = set()
        self._unsorted: Dict[int, List[clingo.Symbol]] = {}  # by the first steps of their blocks
        self._atoms: Dict[int, List[clingo.Symbol]] = {}  # by their steps
        self._of_base: FrozenSet[int] = frozenset()
        self._base_atoms: Set[clingo.Symbol] = set()

    def note(self, literals: Iterable[int], step: int) -> None:
        """Note externals that were declared with ``step``."""
        for literal in literals:
            self.declared.setdefault(literal, step)
        self.expire()

    def end_base(self) -> None:
        """Take what was noted up to now for the externals of base."""
        self._of_base = frozenset(self.declared)

    def between(self, first: int, last: int, base: bool) -> List[clingo.Symbol]:
        """Return what steps first..last declare, with what ``base`` declares, which counts as 1, or without."""
        for atom, literal in self.fresh():
            if literal in self.declared and atom not in self.stepless:
                self._unsorted.setdefault(self.declared[literal], []).append(atom)
                if literal in self._of_base:
                    self._base_atoms.add(atom)
        for step in [one for one in self._unsorted if one <= last]:  # of later ones nobody wants to know yet
            self._sort(step, self._unsorted.pop(step))
        found = [atom for step, atoms in self._atoms.items() if first <= step <= last for atom in atoms]
        return found if base else [atom for atom in found if atom not in self._base_atoms]

    def _sort(self, step: int, atoms: Iterable[clingo.Symbol]) -> None:
        """Sort the atoms of the block that begins with ``step``."""
        block = self._blocks.get(step, range(step, step + 1))
        for atom in atoms:
            self._atoms.setdefault(self._program.declaring_step(atom, block), []).append(atom)
