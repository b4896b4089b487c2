"""The atoms in the ground rules of the first steps, and the last step up to which all of them are fixed."""

from typing import AbstractSet, Dict, FrozenSet, Iterable, Iterator, List, NamedTuple, Optional, Sequence, Set, Tuple

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


class _Rules(Observer):
    """Collects the literals of ground rules.

    Auxiliary atoms of clingo, for projections and aggregates, are ignored: they follow from atoms with names.

    Attributes:
        blocks: for each call of clingo, the name of the part, its steps, the literals of heads, and all other ones.

    """

    def __init__(self) -> None:
        self.blocks: List[Tuple[str, range, Set[int], Set[int]]] = [("", range(0), set(), set())]

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record a rule."""
        _, _, heads, others = self.blocks[-1]
        heads.update(head)
        others.update(map(abs, body))

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """Record a rule with a weighted body."""
        self.rule(choice, head, [literal for literal, _ in body])

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record an external."""
        self.blocks[-1][3].add(atom)


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


_Block = Tuple[range, FrozenSet[clingo.Symbol], FrozenSet[clingo.Symbol]]
"""The steps of a block, the atoms in heads of its rules, and all atoms in its rules."""


class ObservedGrounding(Grounding):
    """A grounding that records its ground rules; searches in it are slow."""

    def _load(self, extra: Iterable[Tuple[str, List[str], str]] = ()) -> ClaspSearch:
        self._rules, self._names = _Rules(), {}  # type: _Rules, Dict[int, clingo.Symbol]
        self._control.register_observer(self._rules)
        return super()._load(extra)

    def _ground(self, parts: Parts, steps: range) -> None:
        name = parts[0][0]
        self._rules.blocks.append((name, steps, set(), set()))
        super()._ground(parts, steps)
        if name == "base":
            self._name_atoms()  # before later steps make some of them false, which clingo removes

    def _name_atoms(self) -> None:
        self._names.update((one.literal, one.symbol) for one in self._control.symbolic_atoms)

    def blocks(self) -> Iterator[Tuple[str, _Block]]:
        """Yield the blocks, each with the name of its part; atoms of steps that clingo has removed are left out."""
        self._name_atoms()
        for part, steps, heads, others in self._rules.blocks:
            yield part, (steps, self._named(heads), self._named(heads | others))

    def _named(self, literals: Set[int]) -> FrozenSet[clingo.Symbol]:
        return frozenset(self._names[one] for one in literals & self._names.keys())


def fixed_atoms(grounding: ObservedGrounding, end: int, open_atoms: AbstractSet[Optional[clingo.Symbol]]) -> FixedAtoms:
    """Return the fixed atoms of the grounded steps before ``end``; the ``open_atoms`` count as not fixed."""
    found = list(grounding.blocks())
    _, _, base = next(one for part, one in found if part == "base")
    blocks = [one for part, one in found if part == "cumulative" and one[0][-1] < end]
    fixed = _Values(base.union(*(atoms for _, _, atoms in blocks)) - open_atoms)
    grounding.inspect(fixed)
    first, steps, defined = grounding.past.first, {}, set()  # type: int, Dict[clingo.Symbol, int], Set[clingo.Symbol]
    for block, heads, atoms in blocks:
        if not fixed.values.keys() >= atoms:
            break
        first = block[-1] + 1
        defined |= heads
        for atom in atoms:
            steps.setdefault(atom, block[0])
    true = frozenset(atom for atom, value in fixed.values.items() if value)
    return FixedAtoms(first, steps, frozenset(defined), base, true)
