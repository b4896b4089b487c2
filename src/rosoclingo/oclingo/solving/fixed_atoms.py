"""What is decided for good: a look at which atoms clingo has fixed, step by step."""

from functools import cached_property
from typing import Dict, List, Optional, Sequence, Set, Tuple

import clingo
from clingo.backend import Observer
from clingo.propagator import PropagateInit, Propagator, PropagatorCheckMode

BASE = -(2**31)
"""The base part among the steps of a recorder."""


class StepRecorder(Observer):
    """Notes the literals in the ground rules of each block of steps that are grounded at once.

    Attributes:
        blocks: first step of a block -> its steps.
        heads: first step of a block -> atoms that its rules define.
        atoms: first step of a block -> all atoms of its rules, and its externals.
        opaque: True once something was grounded whose meaning is not in rules alone.

    """

    def __init__(self) -> None:
        self._block: Optional[int] = None
        self.blocks: Dict[int, range] = {}
        self.heads: Dict[int, Set[int]] = {}
        self.atoms: Dict[int, Set[int]] = {}
        self.opaque = False

    def begin(self, steps: range) -> None:
        """Take what comes as the rules of ``steps``."""
        self._block = steps[0]
        self.blocks[steps[0]] = steps

    def end(self) -> None:
        """Take what comes as nobody's."""
        self._block = None

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """A rule of some step."""
        if self._block is not None:
            self._note(self._block, head, body)

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """A rule with a weighted body of some step."""
        if self._block is not None:
            self._note(self._block, head, [literal for literal, _ in body])

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """An external of some step."""
        if self._block is not None:
            self._note(self._block, (), (atom,))

    def acyc_edge(self, node_u: int, node_v: int, condition: Sequence[int]) -> None:
        """Edges of all steps make one graph."""
        self.opaque = True

    def theory_atom(self, atom_id_or_zero: int, term_id: int, elements: Sequence[int]) -> None:
        """A theory's atoms may mean anything."""
        self.opaque = True

    def _note(self, block: int, head: Sequence[int], body: Sequence[int]) -> None:
        self.heads.setdefault(block, set()).update(head)
        atoms = self.atoms.setdefault(block, set())
        atoms.update(head)
        atoms.update(map(abs, body))


class FixedAtoms(Propagator):
    """Reads, at the start of a search, what is fixed whatever further steps and externals bring.

    ``steps`` and ``defined`` are for afterwards.

    Attributes:
        first: the first step, up to ``before``, of a block that is not decided; ``start`` where nothing could be read.
        values: the fixed atoms and their truth values.
        literals: the atoms' literals.

    """

    def __init__(self, recorder: StepRecorder, start: int, before: int) -> None:
        """Look at the recorded steps from ``start`` to before ``before``."""
        self._recorder, self._start, self._before = recorder, start, before
        self.first = start
        self._read = False
        self.values: Dict[clingo.Symbol, bool] = {}
        self.literals: Dict[clingo.Symbol, int] = {}

    def init(self, init: PropagateInit) -> None:
        """Called by clingo before each search; the first one is looked at."""
        init.check_mode = PropagatorCheckMode.Off
        if self._read or self._recorder.opaque or not init.propagate():
            return
        self._read = True
        for one in init.symbolic_atoms:
            value = _fixed(init, one.literal)
            self.literals[one.symbol] = one.literal
            if value is not None:
                self.values[one.symbol] = value
        # what base defines without a name can't be told to a later grounding
        nameless = self._recorder.heads.get(BASE, set()) - set(self.literals.values())
        while self.first in self._recorder.blocks and self._recorder.blocks[self.first][-1] < self._before:
            atoms = self._recorder.atoms.get(self.first, set())
            if atoms & nameless or any(_fixed(init, atom) is None for atom in atoms):
                break
            self.first = self._recorder.blocks[self.first][-1] + 1

    @property
    def base(self) -> Set[int]:
        """The atoms that base defines or declares external."""
        return self._recorder.atoms.get(BASE, set())

    @cached_property
    def steps(self) -> Dict[int, int]:
        """For the atoms that decided blocks mention the first step of the first such block."""
        found: Dict[int, int] = {}
        for step in range(self._start, self.first):
            for atom in self._recorder.atoms.get(step, ()):
                found.setdefault(atom, step)
        return found

    @cached_property
    def defined(self) -> Set[int]:
        """The atoms that rules of decided steps define."""
        heads: List[Set[int]] = [self._recorder.heads.get(step, set()) for step in range(self._start, self.first)]
        return set().union(*heads)


def _fixed(init: PropagateInit, atom: int) -> Optional[bool]:
    literal = init.solver_literal(atom)
    return init.assignment.value(literal) if init.assignment.is_fixed(literal) else None
