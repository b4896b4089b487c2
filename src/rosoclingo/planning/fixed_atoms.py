"""Which atoms the ground rules of the first steps mention, and up to which step all of these are fixed.

The rules are ground a second time for that: to observe them while a search waits for them would take longer than to
ground them, and most steps are never looked at.
"""

from typing import AbstractSet, Dict, FrozenSet, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.backend import Observer
from clingo.propagator import PropagateInit, Propagator, PropagatorCheckMode

from rosoclingo.planning.grounding import PAST, Grounding


class FixedAtoms(NamedTuple):
    """The atoms of the steps before ``first``: each is true in all answers, or in none, whatever updates follow.

    Attributes:
        first: the first step of a block that mentions another atom.
        steps: the atoms of these steps' rules, each with the first step of the block that first mentions it.
        defined: those that are heads of these rules.
        base: the atoms of the rules of base.
        true: those of all these atoms that are true in all answers.

    """

    first: int
    steps: Dict[clingo.Symbol, int]
    defined: FrozenSet[clingo.Symbol]
    base: FrozenSet[clingo.Symbol]
    true: FrozenSet[clingo.Symbol]


class _Rules(Observer):
    """Collects the literals of ground rules.

    What clingo defines without a name, projections and aggregates, follows from atoms that have one.

    Attributes:
        heads: what the rules define.
        others: the literals of their bodies, and the externals.
        is_opaque: whether there are edges or theory atoms, whose meaning is not in rules alone.

    """

    def __init__(self) -> None:
        self.heads: Set[int] = set()
        self.others: Set[int] = set()
        self.is_opaque = False

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

    def acyc_edge(self, node_u: int, node_v: int, condition: Sequence[int]) -> None:
        """Record that there are edges: those of all steps make one graph."""
        self.is_opaque = True

    def theory_atom(self, atom_id_or_zero: int, term_id: int, elements: Sequence[int]) -> None:
        """Record that there are theory atoms, which can mean anything."""
        self.is_opaque = True


class _Values(Propagator):
    """Reads, at the start of a search, the values of atoms that are fixed whatever further steps and externals bring.

    Attributes:
        values: the values; none if the program is contradictory.

    """

    def __init__(self, atoms: AbstractSet[clingo.Symbol]) -> None:
        self._atoms = atoms
        self.values: Dict[clingo.Symbol, bool] = {}

    def init(self, init: PropagateInit) -> None:
        """Read the values once; clingo calls this before each search."""
        init.check_mode = PropagatorCheckMode.Off
        atoms, self._atoms = self._atoms, frozenset()
        for atom in atoms if init.propagate() else ():
            known = init.symbolic_atoms[atom]
            literal = 0 if known is None else init.solver_literal(known.literal)
            if known is None:  # clingo drops the names of atoms that are false for good
                self.values[atom] = False
            elif init.assignment.is_fixed(literal):
                self.values[atom] = bool(init.assignment.value(literal))


_Block = Tuple[range, FrozenSet[clingo.Symbol], FrozenSet[clingo.Symbol]]
"""Steps that were ground at once, the atoms that their rules define, and all atoms of their rules."""


def _ground_again(grounding: Grounding, before: int) -> Tuple[_Rules, List[_Block]]:
    """Return base and the blocks of a grounding that end before step ``before``."""
    rules, found = _Rules(), []  # type: _Rules, List[Tuple[range, Set[int], Set[int]]]
    control = clingo.Control(grounding.program.arguments(), logger=lambda code, text: None)
    control.register_observer(rules, replace=True)
    grounding.program.load_into(control)
    control.add(*PAST, "".join(f"{atom}.\n" for atom in grounding.past.facts))
    for steps, parts in grounding.ground_parts:
        if steps and steps[-1] >= before:
            break
        rules.heads, rules.others = set(), set()
        control.ground(parts)
        if steps:
            found.append((steps, rules.heads, rules.heads | rules.others))
    names = {one.literal: one.symbol for one in control.symbolic_atoms}

    def named(literals: Set[int]) -> FrozenSet[clingo.Symbol]:
        return frozenset(names[one] for one in literals & names.keys())

    return rules, [(steps, named(heads), named(atoms)) for steps, heads, atoms in found]


def fixed_atoms(grounding: Grounding, before: int, open_atoms: AbstractSet[Optional[clingo.Symbol]]) -> FixedAtoms:
    """Return the fixed atoms of the steps that are ground, at most up to the one before ``before``.

    The ``open_atoms`` count as not fixed.
    """
    rules, ((_, _, base), *blocks) = _ground_again(grounding, before)
    fixed = _Values(base.union(*(atoms for _, _, atoms in blocks)) - open_atoms)
    grounding.show(fixed)
    first, steps, defined = grounding.past.first, {}, set()  # type: int, Dict[clingo.Symbol, int], Set[clingo.Symbol]
    for block, heads, atoms in blocks:
        if rules.is_opaque or not fixed.values.keys() >= atoms:
            break
        first = block[-1] + 1
        defined |= heads
        for atom in atoms:
            steps.setdefault(atom, block[0])
    true = frozenset(atom for atom, value in fixed.values.items() if value)
    return FixedAtoms(first, steps, frozenset(defined), base, true)
