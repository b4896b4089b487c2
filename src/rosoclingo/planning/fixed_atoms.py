"""The atoms in the ground rules of the first steps, and the last step up to which all of them are fixed."""

from typing import AbstractSet, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.backend import Observer
from clingo.propagator import PropagateInit, Propagator, PropagatorCheckMode

from rosoclingo.oclingo.solving.clasp_search import ClaspSearch
from rosoclingo.oclingo.solving.stepwise_grounding import Parts
from rosoclingo.planning.grounding import Grounding


class FixedAtoms(NamedTuple):
    """The atoms of the steps before ``first``: each is true in all answers or in none, for all possible updates.

    A block is a range of steps that were grounded in one call.

    Attributes:
        first: the first step of the first block with an atom that is not fixed.
        steps: atom of the steps before ``first`` -> the first step of the block that first mentions it.
        defined: the atoms that are heads of these steps' rules.
        base: the atoms of the base part.
        true: the fixed atoms that are true in all answers.

    """

    first: int
    steps: Dict[clingo.Symbol, int]
    defined: FrozenSet[clingo.Symbol]
    base: FrozenSet[clingo.Symbol]
    true: FrozenSet[clingo.Symbol]


class Block(NamedTuple):
    """The ground rules of steps that were grounded in one call.

    Attributes:
        steps: the steps.
        heads: the atoms in heads of the rules.
        atoms: all atoms in the rules.

    """

    steps: range
    heads: FrozenSet[clingo.Symbol]
    atoms: FrozenSet[clingo.Symbol]


class _Rules(Observer):
    """Collects the literals of ground rules.

    Auxiliary atoms of clingo, for projections and aggregates, are ignored: they follow from atoms with names.

    Attributes:
        heads: literals of heads.
        others: literals of bodies, and externals.

    """

    def __init__(self) -> None:
        self.heads: Set[int] = set()
        self.others: Set[int] = set()

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record a rule."""
        self.heads.update(head)
        self.others.update(map(abs, body))

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """Record a rule with a weighted body."""
        self.rule(choice, head, [literal for literal, _ in body])

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record an external."""
        self.others.add(atom)


class _Values(Propagator):
    """Reads the top-level values of atoms, which hold for all values of externals and all later steps.

    Attributes:
        values: the values of the fixed atoms; empty if the program is contradictory.

    """

    def __init__(self, atoms: AbstractSet[clingo.Symbol]) -> None:
        self._atoms = atoms
        self.values: Dict[clingo.Symbol, bool] = {}

    def init(self, init: PropagateInit) -> None:
        """Read the values; clingo calls this before each search, but only the first call has an effect."""
        init.check_mode = PropagatorCheckMode.Off
        atoms, self._atoms = self._atoms, frozenset()
        for atom in atoms if init.propagate() else ():
            known = init.symbolic_atoms[atom]
            literal = 0 if known is None else init.solver_literal(known.literal)
            if known is None:  # clingo removes atoms that are false at the top level
                self.values[atom] = False
            elif init.assignment.is_fixed(literal):
                self.values[atom] = bool(init.assignment.value(literal))


class ObservedGrounding(Grounding):
    """A grounding that records the atoms in its ground rules. Its searches are slow."""

    def _load(self, extra: Iterable[Tuple[str, List[str], str]] = ()) -> ClaspSearch:
        self._rules = _Rules()
        self._blocks: List[Tuple[range, Set[int], Set[int]]] = []  # steps, literals of heads, and of all other atoms
        self._names: Dict[int, clingo.Symbol] = {}
        self._control.register_observer(self._rules)
        return super()._load(extra)

    def _ground(self, parts: Parts, steps: range) -> None:
        self._rules.heads, self._rules.others = set(), set()
        name = parts[0][0]
        if name in ("base", "cumulative"):
            self._blocks.append((steps, self._rules.heads, self._rules.others))
        super()._ground(parts, steps)
        if name == "base":
            self._name_atoms()  # now, as later steps can decide them

    def _name_atoms(self) -> None:
        self._names.update((one.literal, one.symbol) for one in self._control.symbolic_atoms)

    def blocks(self) -> List[Block]:
        """Return base and the blocks, without the atoms of blocks that are false in all answers."""
        self._name_atoms()
        names = self._names
        return [
            Block(steps, *(frozenset(names[one] for one in some & names.keys()) for some in (heads, heads | others)))
            for steps, heads, others in self._blocks
        ]


def fixed_atoms(grounding: ObservedGrounding, end: int, open_atoms: AbstractSet[Optional[clingo.Symbol]]) -> FixedAtoms:
    """Return the fixed atoms of the grounded steps before ``end``; the ``open_atoms`` count as not fixed."""
    base, *later = grounding.blocks()
    blocks = [one for one in later if one.steps[-1] < end]
    fixed = _Values(base.atoms.union(*(one.atoms for one in blocks)) - open_atoms)
    grounding.inspect(fixed)
    first, steps, defined = grounding.past.first, {}, set()  # type: int, Dict[clingo.Symbol, int], Set[clingo.Symbol]
    for block in blocks:
        if not fixed.values.keys() >= block.atoms:
            break
        first = block.steps[-1] + 1
        defined |= block.heads
        for atom in block.atoms:
            steps.setdefault(atom, block.steps[0])
    true = frozenset(atom for atom, value in fixed.values.items() if value)
    return FixedAtoms(first, steps, frozenset(defined), base.atoms, true)
