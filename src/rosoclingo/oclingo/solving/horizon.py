"""Steps of a grounding: which atoms are of which, what closed ones allow, and the horizon of an answer as literals.

By these literals one grounding can be asked for any horizon, or for the least of a range. ``beyond(T)`` says that step
T lies beyond the horizon. It is free, but once true it stays true for all later steps; so the horizon H is where
``not beyond(H), beyond(H+1)``, and an instance of ``#volatile t : w.`` of step S, which holds while S <= H <= S+w-1,
holds where ``not beyond(S), beyond(S+w)``.
"""

from typing import Collection, Container, Dict, FrozenSet, Iterable, Iterator, List, Mapping, Optional, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.oclingo.solving.atom_table import HOLDS, OPEN, BackendSession


class AtomIndex:
    """Atoms of some signatures, sorted by a number; looked through only when asked after something new was grounded."""

    def __init__(self, control: clingo.Control, signatures: Iterable[Signature]) -> None:
        self._control, self._signatures = control, sorted(signatures)
        self._seen: Set[int] = set()
        self._stale = True

    def expire(self) -> None:
        """Note that there may be new atoms."""
        self._stale = True

    def fresh(self) -> Iterator[Tuple[clingo.Symbol, int]]:
        """Yield the atoms, with their literals, that have not been yielded before."""
        if not self._stale:
            return
        self._stale = False
        for signature in self._signatures:
            for one in self._control.symbolic_atoms.by_signature(*signature):
                literal = one.literal  # 0 where rules mention, under not, what no rule defines yet
                if literal and literal not in self._seen:
                    self._seen.add(literal)
                    yield one.symbol, literal


class ExternalIndex(AtomIndex):
    """The externals, sorted by the step that declares them.

    Attributes:
        declared: the literal of an external -> the step with which it was ground: of a block of steps the first.
        stepless: atoms that no step declares.

    """

    def __init__(
        self,
        control: clingo.Control,
        program: ReactiveProgram,
        blocks: Mapping[int, range],
        opened: Collection[Signature] = (),
    ) -> None:
        """Take the ``blocks`` of steps ground at once, by the first of each; what is ``opened`` belongs to no step."""
        super().__init__(control, program.external_signatures - {BEYOND})
        self._program, self._blocks, self._opened = program, blocks, opened
        self.declared: Dict[int, int] = {}
        self.stepless: Set[clingo.Symbol] = set()
        self._unsorted: Dict[int, List[clingo.Symbol]] = {}  # by the first steps of their blocks
        self._atoms: Dict[int, List[clingo.Symbol]] = {}  # by their steps
        self._of_base: FrozenSet[int] = frozenset()
        self._base_atoms: Set[clingo.Symbol] = set()

    def note(self, literals: Iterable[int], step: int) -> None:
        """Note externals that were declared with ``step``."""
        for literal in literals:
            self.declared.setdefault(literal, step)
        self.expire()

    def end_base(self) -> None:
        """Take what was noted up to now for the externals of base."""
        self._of_base = frozenset(self.declared)

    def between(self, first: int, last: int, base: bool) -> List[clingo.Symbol]:
        """Return what steps first..last declare, with what ``base`` declares, which counts as 1, or without."""
        for atom, literal in self.fresh():
            if literal in self.declared and atom not in self.stepless and not self._is_opened(atom):
                self._unsorted.setdefault(self.declared[literal], []).append(atom)
                if literal in self._of_base:
                    self._base_atoms.add(atom)
        for step in [one for one in self._unsorted if one <= last]:  # of later ones nobody wants to know yet
            self._sort(step, self._unsorted.pop(step))
        found = [atom for step, atoms in self._atoms.items() if first <= step <= last for atom in atoms]
        return found if base else [atom for atom in found if atom not in self._base_atoms]

    def _is_opened(self, atom: clingo.Symbol) -> bool:
        return bool(self._opened) and signature_of(atom) in self._opened

    def _sort(self, step: int, atoms: Iterable[clingo.Symbol]) -> None:
        """Sort the atoms of the block that begins with ``step``."""
        block = self._blocks.get(step, range(step, step + 1))
        for atom in atoms:
            self._atoms.setdefault(self._program.declaring_step(atom, block), []).append(atom)


class CycleIndex(AtomIndex):
    """The atoms of a keyword like ``_return/3``, sorted by the cycle that is their last argument."""

    def __init__(self, control: clingo.Control, signature: Signature) -> None:
        super().__init__(control, [signature])
        self._cycles: Dict[int, List[Tuple[clingo.Symbol, int]]] = {}

    def cycles(self) -> Collection[int]:
        """Return the cycles whose atoms, or some of them, have not been popped."""
        for atom, literal in self.fresh():
            cycle = atom.arguments[-1]
            if cycle.type is clingo.SymbolType.Number:
                self._cycles.setdefault(cycle.number, []).append((atom, literal))
        return self._cycles.keys()

    def pop_cycle(self, cycle: int) -> List[Tuple[clingo.Symbol, int]]:
        """Return, once, the atoms of ``cycle`` that are known by now, with their literals."""
        return self._cycles.pop(cycle, []) if cycle in self.cycles() else []

    def of_cycle(self, cycle: int) -> List[Tuple[clingo.Symbol, int]]:
        """Return the atoms of ``cycle`` that have not been popped, with their literals."""
        return self._cycles[cycle] if cycle in self.cycles() else []

    def among(self, atoms: Container[clingo.Symbol]) -> List[clingo.Symbol]:
        """Return those of the ``atoms`` that have not been popped."""
        return [atom for cycle in self.cycles() for atom, _ in self._cycles[cycle] if atom in atoms]

    def between(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the atoms of the cycles first..last that have not been popped."""
        known = self.cycles()
        return [atom for cycle in range(first, last + 1) if cycle in known for atom, _ in self._cycles[cycle]]


class ActionIndex(CycleIndex):
    """The ``_action_lib`` atoms of each cycle, and what closed cycles allow of them."""

    def __init__(
        self,
        control: clingo.Control,
        session: BackendSession,
        signature: Signature,
        first: Optional[int] = None,
        told: Optional[Mapping[clingo.Symbol, int]] = None,
    ) -> None:
        """Take the signature, and the ``first`` cycle of all: those before it hold what the program says for sure.

        Of actions in doubt ``told`` has the literal under which they were executed.
        """
        super().__init__(control, signature)
        self._session, self._first = session, first
        self._told: Mapping[clingo.Symbol, int] = {} if told is None else told
        self._closed: Dict[int, Set[clingo.Symbol]] = {}

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Forbid all actions of ``cycle`` but ``executed``, those that come later as well."""
        self._closed[cycle] = set(executed)
        self._forbid(cycle)

    def forbid_late(self) -> None:
        """Forbid actions of cycles that are over which came with the last grounding."""
        for cycle in [one for one in self.cycles() if one in self._closed or self._is_before(one)]:
            self._forbid(cycle)

    def _is_before(self, cycle: int) -> bool:
        return self._first is not None and cycle < self._first

    def _may_be(self, atom: clingo.Symbol, cycle: int) -> bool:
        if cycle in self._closed:
            return atom in self._closed[cycle]
        known = self._control.symbolic_atoms[atom]
        return known is not None and known.is_fact

    def _forbid(self, cycle: int) -> None:
        for atom, literal in self.pop_cycle(cycle):
            if not self._may_be(atom, cycle):
                self._session.backend.add_rule([], [literal])
            elif atom in self._told:
                self._session.backend.add_rule([], [literal, -self._told[atom]])


class HorizonLiterals:
    """The literals ``beyond(T)`` of one control, made as they are needed, and the program's names for them.

    Attributes:
        names: the program's ``__oclingo_beyond(T)``, which are no part of an answer.

    """

    def __init__(self, control: clingo.Control, session: BackendSession, before: int) -> None:
        """Start with step ``before``, which never lies beyond."""
        self._session = session
        self._last = before
        self._settled = before
        self._beyond: Dict[int, int] = {}
        self._index = AtomIndex(control, [BEYOND])
        self._known: Dict[int, int] = {}  # grounded step that may lie beyond -> literal of the program's name for it
        self._coming: Dict[int, int] = {}  # step that is not grounded yet -> likewise
        self.names: Set[clingo.Symbol] = set()

    def expire(self) -> None:
        """Note that there may be new names."""
        self._index.expire()

    @property
    def coming(self) -> Collection[int]:
        """The steps that rules name and that are not grounded yet: what is of them is forbidden until they are."""
        return self._coming.keys()

    def _literal(self, step: int) -> int:
        """Return the literal ``beyond(step)``, making it and those before it."""
        backend = self._session.backend
        while self._last < step:
            self._last += 1
            literal = self._beyond[self._last] = backend.add_atom()
            backend.add_rule([literal], choice=True)
            if self._last - 1 in self._beyond:
                backend.add_rule([], [self._beyond[self._last - 1], -literal])
        return self._beyond[step]

    def define_window(self, guard: int, step: int, window: int) -> None:
        """Define ``guard``: true where the horizon lies in step..step+window-1."""
        end = self._literal(step + window)
        self._session.backend.add_rule([guard], [end, -self._literal(step)])

    def link(self, last: int) -> None:
        """Tie the program's names to the literals; all steps after ``last``, which is grounded, lie beyond."""
        for atom, name in self._index.fresh():
            self.names.add(atom)
            cycle = atom.arguments[0]
            if cycle.type is clingo.SymbolType.Number and cycle.number > self._settled:
                self._coming[cycle.number] = name
            else:
                self._session.release(name)
        for step in sorted(self._coming):
            if step <= last:
                name = self._known[step] = self._coming.pop(step)
                self._session.backend.add_external(name, OPEN)  # else it would stay true where its rule is of no use
                self._session.backend.add_rule([name], [self._literal(step)])
            else:
                self._session.backend.add_external(self._coming[step], HOLDS)

    def settle(self, step: int) -> None:
        """Say for good that no horizon lies before ``step``, which lets clingo simplify."""
        for settled in range(self._settled + 1, step + 1):
            self._session.backend.add_rule([], [self._literal(settled)])
            if settled in self._known:
                # its rule is not enough: it goes where its body is false now, and without a rule the name is open
                self._session.backend.add_rule([], [self._known.pop(settled)])
        self._settled = max(self._settled, step)

    def range(self, first: int, last: int) -> List[int]:
        """Return the assumptions by which the horizon lies in first..last."""
        end = self._literal(last + 1)
        return [end] if first <= self._settled else [-self._literal(first), end]

    def horizon_of(self, model: clingo.Model, first: int, last: int) -> int:
        """Return the horizon, known to lie in first..last, of ``model``."""
        return next((step for step in range(first, last) if model.is_true(self._beyond[step + 1])), last)
