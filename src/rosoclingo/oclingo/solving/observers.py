"""What a grounding notes of the rules that clingo grounds."""

from typing import Container, Dict, Optional, Sequence, Set, Tuple

import clingo
from clingo.backend import Observer


class Externals(Observer):
    """Notes which externals clingo declares."""

    def __init__(self) -> None:
        self.fresh: Set[int] = set()

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record an external."""
        self.fresh.add(atom)


class Heads(Observer):
    """Notes what rules define.

    Attributes:
        externals: the literals of externals that rules define.

    """

    def __init__(self) -> None:
        self._fresh: Set[int] = set()
        self.externals: Set[int] = set()

    def sort(self, declared: Container[int]) -> None:
        """Take those of what was noted for externals whose literals are ``declared``."""
        self.externals.update(literal for literal in self._fresh if literal in declared)
        self._fresh.clear()

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record what a rule defines."""
        self._fresh.update(head)

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """Record what a rule with a weighted body defines."""
        self._fresh.update(head)


class StepRecorder(Observer):
    """Records the literals in the ground rules of each block of steps that are grounded at once.

    Attributes:
        blocks: first step of a block -> its steps.
        heads: first step of a block -> atoms that its rules define.
        atoms: first step of a block -> all atoms of its rules, and its externals.
        names: the literals of the atoms that base has; clingo lets go of the names of those that are false for good.
        opaque: True once something was grounded whose meaning is not in rules alone.

    """

    def __init__(self) -> None:
        self._block: Optional[int] = None
        self.names: Dict[clingo.Symbol, int] = {}
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
        """Record a rule of some step."""
        if self._block is not None:
            self._note(self._block, head, body)

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """Record a rule with a weighted body of some step."""
        if self._block is not None:
            self._note(self._block, head, [literal for literal, _ in body])

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record an external of some step."""
        if self._block is not None:
            self._note(self._block, (), (atom,))

    def acyc_edge(self, node_u: int, node_v: int, condition: Sequence[int]) -> None:
        """Record that there are edges: those of all steps make one graph."""
        self.opaque = True

    def theory_atom(self, atom_id_or_zero: int, term_id: int, elements: Sequence[int]) -> None:
        """Record that there are theory atoms, which may mean anything."""
        self.opaque = True

    def _note(self, block: int, head: Sequence[int], body: Sequence[int]) -> None:
        self.heads.setdefault(block, set()).update(head)
        atoms = self.atoms.setdefault(block, set())
        atoms.update(head)
        atoms.update(map(abs, body))
