"""Which atoms clingo has fixed for good, step by step.

Which atoms the rules of a step have is seen when these are ground once more: to hear of all rules while they are ground
for a search would take longer than to ground them, and of most steps nobody wants to know.
"""

from functools import cached_property
from typing import AbstractSet, Dict, FrozenSet, Iterable, Optional, Sequence, Set, Tuple

import clingo
from clingo.backend import Observer
from clingo.propagator import PropagateInit, Propagator, PropagatorCheckMode

from rosoclingo.planning.grounding import BASE, PAST, Grounding


class StepRules(Observer):
    """The atoms with a name in the ground rules of each block of steps that were ground at once.

    What rules define without a name, clingo's projections and aggregates, follows from what has one.

    Attributes:
        heads: steps of a block -> atoms that its rules define.
        atoms: steps of a block -> all atoms of its rules, and its externals.
        opaque: True once something was ground whose meaning is not in rules alone.

    """

    def __init__(self, grounding: Grounding, before: int) -> None:
        """Look at base, and at the blocks of ``grounding`` that end before ``before``; nothing is changed there."""
        self._heads: Set[int] = set()
        self._literals: Set[int] = set()
        self.heads: Dict[range, FrozenSet[clingo.Symbol]] = {}
        self.atoms: Dict[range, FrozenSet[clingo.Symbol]] = {}
        self.opaque = False
        found: Dict[range, Tuple[Set[int], Set[int]]] = {}
        control = clingo.Control(grounding.program.arguments(), logger=lambda code, text: None)
        control.register_observer(self, replace=True)
        grounding.program.load_into(control)
        control.add(*PAST, "".join(f"{atom}.\n" for atom in grounding.past.facts))
        for steps, parts in grounding.ground_parts:
            if steps and steps[-1] >= before:
                break
            self._heads, self._literals = set(), set()
            control.ground(parts)
            if steps:
                found[steps] = self._heads, self._heads.union(map(abs, self._literals))
        names = {one.literal: one.symbol for one in control.symbolic_atoms}
        for steps, (heads, atoms) in found.items():
            self.heads[steps] = frozenset(names[atom] for atom in heads & names.keys())
            self.atoms[steps] = frozenset(names[atom] for atom in atoms & names.keys())

    def rule(self, choice: bool, head: Sequence[int], body: Sequence[int]) -> None:
        """Record a rule of some step."""
        self._heads.update(head)
        self._literals.update(body)

    def weight_rule(self, choice: bool, head: Sequence[int], lower_bound: int, body: Sequence[Tuple[int, int]]) -> None:
        """Record a rule with a weighted body of some step."""
        self._heads.update(head)
        self._literals.update(literal for literal, _ in body)

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        """Record an external of some step."""
        self._literals.add(atom)

    def acyc_edge(self, node_u: int, node_v: int, condition: Sequence[int]) -> None:
        """Record that there are edges: those of all steps make one graph."""
        self.opaque = True

    def theory_atom(self, atom_id_or_zero: int, term_id: int, elements: Sequence[int]) -> None:
        """Record that there are theory atoms, which may mean anything."""
        self.opaque = True


class FixedAtoms(Propagator):
    """Reads, at the start of a search, what is fixed whatever further steps and externals bring.

    ``steps`` and ``defined`` are for afterwards.

    Attributes:
        first: the first step of a block that is not decided; ``start`` where nothing could be read.
        values: the fixed atoms and their truth values.
        literals: the atoms' literals.

    """

    def __init__(
        self, rules: StepRules, names: Dict[clingo.Symbol, int], start: int, further: Iterable[clingo.Symbol] = ()
    ) -> None:
        """Look at the blocks of steps from ``start`` on that ``rules`` tell of; base has the ``names``.

        Atoms that are neither of these nor ``further`` ones are not looked at: most of them are of steps to come.
        """
        self._rules, self._names = rules, names
        self._wanted = frozenset(further).union(*rules.atoms.values())
        self._blocks = [steps for steps in rules.atoms if steps[0] >= start]
        self._decided: Dict[range, FrozenSet[clingo.Symbol]] = {}
        self.first = start
        self._read = False
        self.values: Dict[clingo.Symbol, bool] = {}
        self.literals: Dict[clingo.Symbol, int] = {}

    def init(self, init: PropagateInit) -> None:
        """Called by clingo before each search; the first one is looked at."""
        init.check_mode = PropagatorCheckMode.Off
        if self._read or self._rules.opaque or not init.propagate():
            return
        self._read = True
        known = map(init.symbolic_atoms.__getitem__, self._wanted | self._names.keys())
        self.literals = {**self._names, **{one.symbol: one.literal for one in known if one is not None}}
        for atom, literal in self.literals.items():
            value = _fixed(init, literal)
            if value is not None:
                self.values[atom] = value
        # clingo lets go of the names of what is false for good
        undecided = self.literals.keys() - self.values.keys()
        for steps in self._blocks:
            if not undecided.isdisjoint(self._rules.atoms[steps]):
                break
            self._decided[steps] = self._rules.atoms[steps]
            self.first = steps[-1] + 1

    @property
    def base(self) -> AbstractSet[clingo.Symbol]:
        """The atoms that base defines or declares external."""
        return self._rules.atoms.get(BASE, frozenset())

    @cached_property
    def steps(self) -> Dict[clingo.Symbol, int]:
        """For the atoms that decided blocks mention the first step of the first such block."""
        found: Dict[clingo.Symbol, int] = {}
        for steps, atoms in self._decided.items():
            for atom in atoms:
                found.setdefault(atom, steps[0])
        return found

    @cached_property
    def defined(self) -> AbstractSet[clingo.Symbol]:
        """The atoms that rules of decided steps define."""
        return frozenset().union(*(self._rules.heads[steps] for steps in self._decided))


def _fixed(init: PropagateInit, atom: int) -> Optional[bool]:
    literal = init.solver_literal(atom)
    return init.assignment.value(literal) if init.assignment.is_fixed(literal) else None


def look(grounding: Grounding, start: int, before: int, further: Iterable[clingo.Symbol] = ()) -> FixedAtoms:
    """Return what is fixed for good in ``grounding`` of the steps from ``start`` to before ``before``.

    Base and ``further`` atoms are looked at as well.
    """
    fixed = FixedAtoms(StepRules(grounding, before), grounding.names, start, further)
    grounding.show(fixed)
    return fixed
