"""The atoms of one control, sorted by step."""

from typing import Dict, FrozenSet, Iterable, Iterator, List, Sequence, Set, Tuple

import clingo
from clingo.backend import Observer

from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature


class AtomIndex:
    """The atoms of some signatures in a control; new atoms are looked up on demand."""

    def __init__(self, control: clingo.Control, signatures: Iterable[Signature]) -> None:
        self._control, self._signatures = control, sorted(signatures)
        self._seen: Set[int] = set()
        self._stale = True

    def expire(self) -> None:
        """Mark the index as stale: there can be new atoms."""
        self._stale = True

    def fresh(self) -> Iterator[Tuple[clingo.Symbol, int]]:
        """Yield the atoms that are new since the last call, with their literals."""
        if not self._stale:
            return
        self._stale = False
        for signature in self._signatures:
            for one in self._control.symbolic_atoms.by_signature(*signature):
                literal = one.literal  # 0 if no rule defines the atom yet
                if literal and literal not in self._seen:
                    self._seen.add(literal)
                    yield one.symbol, literal


class ExternalIndex(AtomIndex):
    """The externals of one control, sorted by the step that declares them.

    Attributes:
        stepless: atoms that no step declares.

    """

    def __init__(self, control: clingo.Control, program: ReactiveProgram) -> None:
        """Index the externals of ``control``, before the ``program`` is loaded into it."""
        super().__init__(control, program.external_signatures - {BEYOND})
        self._program = program
        self._fresh, self._heads = _Externals(), _Heads()
        self._declared: Dict[int, range] = {}  # literal -> the steps whose grounding declared it
        self._defined: Set[int] = set()  # literals of externals that rules define
        self.stepless: Set[clingo.Symbol] = set()
        self._unsorted: Dict[range, List[clingo.Symbol]] = {}  # by the steps that were grounded in one call
        self._atoms: Dict[int, List[clingo.Symbol]] = {}  # by their steps
        self._of_base: FrozenSet[int] = frozenset()
        self._base_atoms: Set[clingo.Symbol] = set()
        for observer in (self._fresh, self._heads) if program.defines_externals else (self._fresh,):
            control.register_observer(observer)

    def note(self, steps: range) -> None:
        """Record the atoms that the grounding of ``steps`` declared and defined; base counts as step 1."""
        for literal in self._fresh.literals:
            self._declared.setdefault(literal, steps)
        self._defined.update(literal for literal in self._heads.literals if literal in self._declared)
        self._fresh.literals.clear()
        self._heads.literals.clear()
        self.expire()

    def is_external(self, literal: int) -> bool:
        """Return whether ``literal`` belongs to a declared external that no rule defines."""
        return literal in self._declared and literal not in self._defined

    def end_base(self) -> None:
        """Record all externals declared so far as externals of base."""
        self._of_base = frozenset(self._declared)

    def between(self, first: int, last: int, base: bool) -> List[clingo.Symbol]:
        """Return the externals that the steps first..last declare; with ``base``, externals of base count as step 1."""
        for atom, literal in self.fresh():
            if literal in self._declared and atom not in self.stepless:
                self._unsorted.setdefault(self._declared[literal], []).append(atom)
                if literal in self._of_base:
                    self._base_atoms.add(atom)
        for steps in [one for one in self._unsorted if one[0] <= last]:  # later ones are not needed yet
            for atom in self._unsorted.pop(steps):
                self._atoms.setdefault(self._program.declaring_step(atom, steps), []).append(atom)
        found = [atom for step, atoms in self._atoms.items() if first <= step <= last for atom in atoms]
        return found if base else [atom for atom in found if atom not in self._base_atoms]


class _Externals(Observer):
    """Collects the literals of externals as clingo declares them."""

    def __init__(self) -> None:
        self.literals: Set[int] = set()

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record an external."""
        self.literals.add(atom)


class _Heads(Observer):
    """Collects the literals that rules define."""

    def __init__(self) -> None:
        self.literals: Set[int] = set()

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record the head of a rule."""
        self.literals.update(head)

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """Record the head of a rule with a weighted body."""
        self.literals.update(head)
