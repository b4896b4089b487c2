"""The grounding of the incremental solver, which grows step by step and is updated in place."""

from typing import Callable, Dict, FrozenSet, Iterable, List, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.parts import GUARD
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.solving.atom_index import ExternalIndex
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch, SearchLimits
from rosoclingo.oclingo.solving.cycles import ActionIndex
from rosoclingo.oclingo.solving.definitions import HOLDS, BackendSession, Definitions
from rosoclingo.oclingo.solving.results import Answer, refusing
from rosoclingo.oclingo.solving.stream_state import ForgottenSteps, StateItem, StreamState, TimedStatement

Parts = Sequence[Tuple[str, Sequence[clingo.Symbol]]]
"""Program parts with their arguments."""


class ReactiveGrounding:
    """A control with base, the steps up to :attr:`horizon`, and the items of a stream's state.

    It can be dropped and rebuilt from the state at any time. It contains no reference cycle, so its memory is freed
    with the last reference to it. Methods raise SolverError if clingo rejects the program.

    Attributes:
        horizon: the last grounded step; first step - 1 while only base is grounded.
        messages: messages of clingo.

    """

    def __init__(self, program: ReactiveProgram, state: StreamState) -> None:
        """Ground base; heads of open signatures in ``state`` become externals or facts."""
        self.program, self.messages = program, Messages()
        self.horizon = program.first_step - 1
        self._control = clingo.Control(program.arguments(), logger=self.messages.log)
        self._session = BackendSession(self._control)
        self._externals = ExternalIndex(self._control, program)
        self._definitions = Definitions(self._control, self._session, self._externals, reopens=True)
        self._actions = ActionIndex(self._control, self._session)
        self._clasp = ClaspSearch(self._control, program)
        self._items: Dict[int, StateItem] = {}  # the applied items of the state, by identity
        self._guards: Dict[int, int] = {}  # identity of a lapsing statement -> its guard literal
        self._deferred: List[TimedStatement] = []  # statements whose heads are declared by later steps
        self._closed: Dict[int, FrozenSet[clingo.Symbol]] = {}  # closed cycle -> its executed actions
        self._opened: Set[clingo.Symbol] = set()  # the known atoms of open signatures
        self._windows: List[Tuple[clingo.Symbol, int, int]] = []  # guards of volatile rules, first and last horizon
        self._hidden: Set[clingo.Symbol] = set()  # auxiliary atoms, left out of answers
        self._was_searched = False
        with refusing(self.messages, program):
            program.load_into(self._control)
        permanent, heads = state.permanent_facts(), self._new_open(state)
        self._facts = {one: permanent[one] for one in heads if one in permanent}  # they need no defining statement
        self.open_heads(state)
        self._ground([("base", [])], range(1, 2))
        self._externals.end_base()

    def _ground(self, parts: Parts, steps: range) -> None:
        self._session.close()
        with refusing(self.messages, self.program):
            self._control.ground(parts)
        self._externals.note(steps)
        self._actions.expire()
        self._definitions.resolve_absent()

    # ---- Following the state -----------------------------------------------------------------------------------------

    def can_follow(self, state: StreamState) -> bool:
        """Return whether the grounding can be updated in place to ``state``.

        It cannot if its horizon is too high, a permanent item was removed, a grounded rule could match a new atom of an
        open signature, or a statement closes a loop: clingo detects loops only among rules that are added between two
        searches.
        """
        return (
            self.horizon <= state.horizon
            and all(isinstance(one, TimedStatement) and one.lifetime != FOREVER for one in self._removed(state))
            and self._closed.items() <= state.closed.items()
            and not self.program.can_see(self._new_open(state), self.program.first_step, self.horizon)
            and not (self._was_searched and state.closes_loops(self.program))
        )

    def open_heads(self, state: StreamState) -> None:
        """Declare new heads of open signatures as externals or facts, visible to the steps grounded later."""
        atoms = self._new_open(state)
        if not atoms:
            return
        self._opened.update(atoms)
        self._externals.stepless.update(atoms)
        self._ground([self.program.open_part(atom, atom in self._facts) for atom in atoms], range(1, 2))

    def ground_to(self, last: int) -> None:
        """Ground the steps up to ``last`` in one call, which is much faster than one by one."""
        steps = range(self.horizon + 1, last + 1)
        self.horizon = last
        self._ground([(part, [clingo.Number(step)]) for step in steps for part in ("cumulative", "volatile")], steps)
        for step in steps:
            self._windows += [(self.program.guard(one, step), step, step + one - 1) for one in self.program.windows]
        self._hidden.update(guard for guard, *_ in self._windows)
        self._hidden.update(one.symbol for one in self._control.symbolic_atoms.by_signature(*BEYOND))
        for guard, first, end in self._windows:
            self._control.assign_external(guard, first <= last <= end)
        self._windows = [one for one in self._windows if one[2] >= last]

    def follow(self, state: StreamState) -> List[TimedStatement]:
        """Apply the new items of ``state`` and release removed ones; return the ignored statements.

        The grounding must have reached the horizon of ``state``.
        """
        for one in self._removed(state):
            del self._items[id(one)]
            if id(one) in self._guards:
                self._session.release(self._guards.pop(id(one)))
        for cycle in state.closed.keys() - self._closed.keys():
            self._closed[cycle] = state.closed[cycle]
            self._actions.close_cycle(cycle, state.closed[cycle])
        deferred, self._deferred = self._deferred, []
        for entry in deferred:
            if id(entry) in self._items:
                self._add_or_defer(entry)
        ignored: List[TimedStatement] = []
        for item in state.items:
            if id(item) in self._items:
                continue
            self._items[id(item)] = item
            if isinstance(item, ForgottenSteps):
                self._forget(item)
            elif isinstance(item, TimedStatement) and not self._add_or_defer(item):
                ignored.append(item)
        return ignored

    def _removed(self, state: StreamState) -> List[StateItem]:
        """Return the applied items that ``state`` no longer contains."""
        present = set(map(id, state.items))
        return [item for key, item in self._items.items() if key not in present]

    def _new_open(self, state: StreamState) -> List[clingo.Symbol]:
        """Return the heads of open signatures that are not known yet."""
        return [one for one in state.heads if self.program.is_open_signature(one) and one not in self._opened]

    def _add_or_defer(self, entry: TimedStatement) -> bool:
        """Add a statement, or defer it to the step that declares its head; return False to ignore it."""
        definitions, head = self._definitions, entry.statement.head
        if head in self._facts:
            return not entry.statement.body or entry.update == self._facts[head]
        if head is None or definitions.is_open(head, entry.update) or self._is_unmentioned(head):
            guards = [] if entry.lifetime == FOREVER else [self._session.new_external(HOLDS)]
            self._guards.update((id(entry), guard) for guard in guards)
            definitions.add(entry, guards)
            return True
        if not entry.statement.body and definitions.is_true(head):
            return True
        # clingo stops grounding once the program is permanently unsatisfiable: the next grounding decides
        is_undecided = self.is_conflicting and signature_of(head) in self.program.external_signatures
        can_be_declared = is_undecided or self.program.can_declare(head, self.horizon + 1)
        if can_be_declared and not definitions.is_closed(head) and not definitions.knows(head):
            self._deferred.append(entry)
            return True
        return False

    def _is_unmentioned(self, atom: clingo.Symbol) -> bool:
        """Return whether the program does not mention ``atom``, so that any update can define it."""
        known = self.program.signatures | self.program.open_signatures
        is_unknown = signature_of(atom) not in known or '"' in str(atom)  # see strings_as_constants
        return is_unknown and not self._definitions.knows(atom) and not self._definitions.is_closed(atom)

    def _forget(self, steps: ForgottenSteps) -> None:
        """Close the undefined externals of ``steps``; base counts as step 1."""
        for atom in self._externals.between(steps.first, steps.last, base=True):
            if self._definitions.is_open(atom) and atom not in steps.spared and atom.name != GUARD:
                self._definitions.close(atom)

    # ---- Searching ---------------------------------------------------------------------------------------------------

    @property
    def is_conflicting(self) -> bool:
        """Whether the program is unsatisfiable for all values of externals and all horizons."""
        return bool(self._control.is_conflicting)

    def search(self, models: int, stopped: Callable[[], bool]) -> Tuple[Optional[bool], Tuple[Answer, ...]]:
        """Search for up to ``models`` answers (0: all) at the horizon, until ``stopped`` returns true.

        Returns whether there is an answer (None after a stop), and the answers. If the program optimizes, these are
        optimal.
        """
        self._was_searched = True
        self._actions.forbid_late()
        self._session.close()
        answers: List[Answer] = []
        hidden = self._hidden

        def keep(model: clingo.Model) -> None:
            """Record a model as an answer; if the program optimizes, only a proven optimum."""
            if not model.cost or model.optimality_proven:
                answers.append(frozenset(model.symbols(shown=True)) - hidden)

        limits = SearchLimits(models, None, best=True, advised=True)
        with refusing(self.messages, self.program):
            result, _ = self._clasp.run(limits, (), keep, stopped, with_core=False)
        if result.interrupted or result.unknown:
            return None, ()
        return bool(result.satisfiable or answers), tuple(answers)

    def new_remarks(self) -> Iterable[str]:
        """Return the messages that clingo logged about the program since the last call."""
        return map(str, self.messages.new_remarks(self.program.parameter_at)) if self.messages.received else ()
