"""The atoms in the ground rules of the first steps, and the last step up to which all of them are fixed.

The rules are grounded a second time, because an observer would slow down each search.
"""

from typing import AbstractSet, Dict, FrozenSet, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.backend import Observer
from clingo.propagator import PropagateInit, Propagator, PropagatorCheckMode

from rosoclingo.planning.grounding import PAST, Grounding


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


_Block = Tuple[range, FrozenSet[clingo.Symbol], FrozenSet[clingo.Symbol]]
"""The steps of a block, the atoms in heads of its rules, and all atoms in its rules."""


def _reground(grounding: Grounding, end: int) -> List[_Block]:
    """Ground the program again; return base, followed by the blocks that end before step ``end``."""
    rules, found = _Rules(), []  # type: _Rules, List[Tuple[range, Set[int], Set[int]]]
    control = clingo.Control(grounding.program.arguments(), logger=lambda code, text: None)
    control.register_observer(rules, replace=True)
    grounding.program.load_into(control)
    control.add(*PAST, "".join(f"{atom}.\n" for atom in grounding.past.facts))
    for steps, parts in grounding.ground_parts:
        name = parts[0][0]
        if name == "cumulative" and steps[-1] >= end:
            break
        rules.heads, rules.others = set(), set()
        control.ground(parts)
        if name in ("base", "cumulative"):
            found.append((steps, rules.heads, rules.heads | rules.others))
    names = {one.literal: one.symbol for one in control.symbolic_atoms}

    def named(literals: Set[int]) -> FrozenSet[clingo.Symbol]:
        return frozenset(names[one] for one in literals & names.keys())

    return [(steps, named(heads), named(atoms)) for steps, heads, atoms in found]


def fixed_atoms(grounding: Grounding, end: int, open_atoms: AbstractSet[Optional[clingo.Symbol]]) -> FixedAtoms:
    """Return the fixed atoms of the grounded steps before ``end``; the ``open_atoms`` count as not fixed."""
    (_, _, base), *blocks = _reground(grounding, end)
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
