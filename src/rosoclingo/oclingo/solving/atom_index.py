"""The atoms of one control, sorted by step."""

from typing import Dict, Iterable, Iterator, List, Optional, Sequence, Set, Tuple

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
        self._ground = (_GroundHeads if program.defines_externals else _GroundExternals)()
        self._declared: Dict[int, Optional[range]] = {}  # literal -> the steps whose grounding declared it, None: base
        self._defined: Set[int] = set()  # literals of externals that rules define
        self.stepless: Set[clingo.Symbol] = set()
        self._atoms: Dict[Optional[int], List[clingo.Symbol]] = {}  # by their steps, None: base
        control.register_observer(self._ground)

    def note(self, steps: range) -> None:
        """Record the atoms that the grounding of ``steps`` declared and defined; base counts as step 1."""
        for literal in self._ground.externals:
            self._declared.setdefault(literal, steps)
        self._defined |= self._ground.heads & self._declared.keys()
        self._ground.externals.clear()
        self._ground.heads.clear()
        self.expire()

    def is_external(self, literal: int) -> bool:
        """Return whether ``literal`` belongs to a declared external that no rule defines."""
        return literal in self._declared and literal not in self._defined

    def end_base(self) -> None:
        """Record all externals declared so far as externals of base."""
        self._declared = dict.fromkeys(self._declared)

    def between(self, first: int, last: int, base: bool) -> List[clingo.Symbol]:
        """Return the externals that the steps first..last declare; with ``base``, externals of base count as step 1."""
        for atom, literal in self.fresh():
            if literal in self._declared and atom not in self.stepless:
                steps = self._declared[literal]
                step = None if steps is None else self._program.declaring_step(atom, steps)
                self._atoms.setdefault(step, []).append(atom)
        in_base = self._atoms.get(None, []) if base and first <= 1 <= last else []
        steps_with = (step for step in self._atoms if step is not None and first <= step <= last)
        return [*in_base, *(atom for step in steps_with for atom in self._atoms[step])]


class _GroundExternals(Observer):
    """Collects the literals of externals as clingo declares them.

    Attributes:
        externals: the literals.
        heads: the literals that rules define, if these are collected.

    """

    def __init__(self) -> None:
        self.externals: Set[int] = set()
        self.heads: Set[int] = set()

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record an external."""
        self.externals.add(atom)


class _GroundHeads(_GroundExternals):
    """Collects also the literals that rules define."""

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record the head of a rule."""
        self.heads.update(head)

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """Record the head of a rule with a weighted body."""
        self.heads.update(head)
