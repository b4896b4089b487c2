"""A program and the state of a stream in one :class:`clingo.Control`: the common part of both solvers' groundings."""

from abc import ABC, abstractmethod
from typing import Collection, Dict, Iterable, List, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.parts import GUARD
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.solving.atom_index import ExternalIndex
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch
from rosoclingo.oclingo.solving.cycles import ActionIndex
from rosoclingo.oclingo.solving.definitions import BackendSession, Definitions
from rosoclingo.oclingo.solving.results import refusing
from rosoclingo.oclingo.solving.stream_state import ClosedHeads, ForgottenSteps, StateItem, StreamState, TimedStatement

Parts = Sequence[Tuple[str, Sequence[clingo.Symbol]]]
"""Program parts with their arguments."""


class StepwiseGrounding(ABC):
    """Base and the steps up to :attr:`horizon` of a program in one control, with the items of a stream's state.

    It can be dropped and rebuilt from the state at any time. It holds no reference to itself, so its memory is freed
    with the last reference of others. Methods raise SolverError if clingo rejects the program. Subclasses decide how
    the validity of volatile rules and lapsing statements depends on the horizon of a search.

    Attributes:
        program: the reactive logic program.
        messages: messages of clingo.
        horizon: the last grounded step; first step - 1 while only base is grounded.
        definitions: the statements that define their heads.
        deferred: statements whose heads are declared by later steps.
        open_facts: the facts of open signatures, with the numbers of their updates; no statement can define them.

    """

    _actions: ActionIndex

    def __init__(self, program: ReactiveProgram, reopens: bool = False) -> None:
        """Create a control for ``program``, which :meth:`_load` loads; for ``reopens`` see :class:`Definitions`."""
        self.program, self.messages = program, Messages()
        self.horizon = program.first_step - 1
        self.deferred: List[TimedStatement] = []
        self.open_facts: Dict[clingo.Symbol, int] = {}
        self._opened: Set[clingo.Symbol] = set()  # the declared atoms of open signatures
        self._hidden: Set[clingo.Symbol] = set()  # auxiliary atoms, left out of answers
        self._control = clingo.Control(program.arguments(), logger=self.messages.log)
        self._session = BackendSession(self._control)
        self._externals = ExternalIndex(self._control, program)
        self.definitions = Definitions(self._control, self._session, self._externals, reopens)

    @property
    def is_conflicting(self) -> bool:
        """Whether the program is unsatisfiable for all values of externals and all horizons."""
        return bool(self._control.is_conflicting)

    # ---- Grounding ---------------------------------------------------------------------------------------------------

    def _load(self, extra: Iterable[Tuple[str, List[str], str]] = ()) -> ClaspSearch:
        """Load the program and the ``extra`` parts; return the search."""
        with refusing(self.messages, self.program):
            self.program.load_into(self._control)
            for part in extra:
                self._control.add(*part)
        return ClaspSearch(self._control, self.program)

    def _new_open(self, state: StreamState) -> List[clingo.Symbol]:
        """Return the heads of open signatures that are not declared yet."""
        return [one for one in state.heads if self.program.is_open_signature(one) and one not in self._opened]

    def _open(self, atoms: Collection[clingo.Symbol]) -> None:
        """Declare ``atoms`` of open signatures, visible to the steps grounded later."""
        self._opened.update(atoms)
        self._externals.stepless.update(atoms)
        if atoms:
            self._ground([self.program.open_part(atom, atom in self.open_facts) for atom in atoms], range(1, 2))

    def _ground_base(self) -> None:
        self._ground([("base", [])], range(1, 2))
        self._externals.end_base()

    def _ground(self, parts: Parts, steps: range) -> None:
        """Ground ``parts``, whose externals belong to ``steps``; base counts as step 1."""
        self._session.close()
        with refusing(self.messages, self.program):
            self._control.ground(parts)
        self._externals.note(steps)
        self._actions.expire()
        self.definitions.resolve_absent()
        self._hidden.update(one.symbol for one in self._control.symbolic_atoms.by_signature(*BEYOND))

    def ground_to(self, last: int) -> None:
        """Ground the steps up to ``last`` in one call, which is much faster than a call for each step."""
        steps = range(self.horizon + 1, last + 1)
        self.horizon = last
        self._ground([(part, [clingo.Number(step)]) for step in steps for part in ("cumulative", "volatile")], steps)
        for step in steps:
            for window in (one for one in self.program.windows if one > 0):
                guard = self._control.symbolic_atoms[self.program.guard(window, step)]
                if guard is not None:
                    self._hidden.add(guard.symbol)
                    self._limit(guard.literal, step, step + window - 1)

    @abstractmethod
    def _limit(self, guard: int, first: int, last: int) -> None:
        """Make the external ``guard`` true iff the horizon of a search lies in ``first`` to ``last``."""

    # ---- Items of the state ------------------------------------------------------------------------------------------

    def _apply(self, items: Iterable[StateItem]) -> List[TimedStatement]:
        """Apply ``items`` in order; return the ignored statements."""
        ignored: List[TimedStatement] = []
        for item in items:
            if isinstance(item, ForgottenSteps):
                self.forget(item.first, item.last, spared=item.spared)
            elif isinstance(item, ClosedHeads):
                for atom in item.atoms:
                    self.definitions.close(atom)
            elif not self._accept(item):
                ignored.append(item)
        return ignored

    def _accept(self, entry: TimedStatement) -> bool:
        """Add a statement, or defer it to the step that declares its head; return False to ignore it."""
        definitions, head = self.definitions, entry.statement.head
        if head in self.open_facts:
            return not entry.statement.body or entry.update == self.open_facts[head]
        is_known = head is not None and (self._mentions(head) or definitions.knows(head) or definitions.is_closed(head))
        if head is None or not is_known or definitions.is_open(head, entry.update):
            self._add(entry)
            return True
        if not entry.statement.body and definitions.is_true(head):
            return True
        # clingo stops grounding once the program is permanently unsatisfiable: the next grounding decides
        is_undecided = self.is_conflicting and signature_of(head) in self.program.external_signatures
        can_be_declared = is_undecided or self.program.can_declare(head, self.horizon + 1)
        is_deferred = can_be_declared and not definitions.is_closed(head) and not definitions.knows(head)
        self.deferred += [entry] if is_deferred else []
        return is_deferred

    @abstractmethod
    def _add(self, entry: TimedStatement) -> None:
        """Add a statement that holds during its lifetime."""

    def _accept_deferred(self) -> None:
        """Add the statements whose heads are declared by now."""
        deferred, self.deferred = self.deferred, []
        for entry in deferred:
            self._accept(entry)

    def _mentions(self, atom: clingo.Symbol) -> bool:
        """Return whether the program mentions the predicate of ``atom``."""
        signature = signature_of(atom)
        return signature in self.program.signatures or signature in self.program.open_signatures

    def forget(self, first: int, last: int, base: bool = True, spared: Collection[clingo.Symbol] = ()) -> None:
        """Close the undefined externals of steps ``first`` to ``last``, except the ``spared`` ones.

        If ``base``, the base part counts as step 1.
        """
        for atom in self._externals.between(first, last, base):
            if self.definitions.is_open(atom) and atom not in spared and atom.name != GUARD:
                self.definitions.close(atom)
