"""Which atoms clingo has fixed for good, step by step."""

from functools import cached_property
from typing import Dict, List, Optional, Set

import clingo
from clingo.propagator import PropagateInit, Propagator, PropagatorCheckMode

from rosoclingo.oclingo.solving.atom_table import StepRecorder
from rosoclingo.oclingo.solving.grounding import BASE, Grounding


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
        self.literals = {**self._recorder.names, **{one.symbol: one.literal for one in init.symbolic_atoms}}
        for atom, literal in self.literals.items():
            value = _fixed(init, literal)
            if value is not None:
                self.values[atom] = value
        # what base defines without a name, a projection of clingo's say, follows from what has one
        while self.first in self._recorder.blocks and self._recorder.blocks[self.first][-1] < self._before:
            atoms = self._recorder.atoms.get(self.first, set())
            if any(_fixed(init, atom) is None for atom in atoms):
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


def look(grounding: Grounding, start: int, before: int) -> FixedAtoms:
    """Return what is fixed for good in ``grounding``, looking at the steps from ``start`` to before ``before``."""
    fixed = FixedAtoms(grounding.recorder, start, before)
    grounding.show(fixed)
    return fixed
