"""One grounding of a reactive program in one :class:`clingo.Control`, grown step by step.

The engine knows nothing of streams: the solver tells it what to ground, define, release and solve. It can be thrown away and
built anew at any time from the solver's state.
"""

from typing import Callable, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Set, Tuple

import clingo
from clingo.backend import Backend, Observer

from rosoclingo.oclingo.horizon import HorizonLiterals
from rosoclingo.oclingo.messages import Messages
from rosoclingo.oclingo.program import ReactiveProgram
from rosoclingo.oclingo.progression import Literal, Statement
from rosoclingo.oclingo.rewriting import guard_atom

_FREE, _FALSE, _TRUE = clingo.TruthValue.Release, clingo.TruthValue.False_, clingo.TruthValue.True_
POLL = 0.02
"""Seconds of wall time between two looks at the stop request while clingo searches."""


class Search(NamedTuple):
    """Result of one search: satisfiable, or not, or None where it was stopped; the answers, and the horizon of the last."""

    satisfiable: Optional[bool]
    answers: Tuple[FrozenSet[clingo.Symbol], ...] = ()
    horizon: int = 0


class _Externals(Observer):
    """Notes which externals clingo declares."""

    def __init__(self) -> None:
        self.fresh: Set[int] = set()

    def external(self, atom: int, value: clingo.TruthValue) -> None:
        self.fresh.add(atom)


class Engine:
    """A control with base and the steps first..:attr:`horizon` grounded.

    Attributes:
        horizon: the last grounded step; first step - 1 while only base is grounded.
        messages: what clingo said since they were last cleared.
    """

    def __init__(
        self,
        program: ReactiveProgram,
        open_atoms: Iterable[clingo.Symbol],
        facts: Iterable[clingo.Symbol],
        shortest: bool = False,
    ) -> None:
        """Load ``program`` and ground its base with ``open_atoms`` as externals, or as facts where they are in ``facts``.

        With ``shortest`` no answer holds an action of a cycle beyond its horizon.

        Raises RuntimeError as clingo does.
        """
        self.program = program
        self._shortest = shortest
        self.messages = Messages()
        self._control = clingo.Control(program.arguments(), logger=self.messages.log)
        self._externals = _Externals()
        self._control.register_observer(self._externals)
        program.load_into(self._control)
        self._declared: Dict[int, int] = {}  # external literal -> step of its declaration
        self._cells: Dict[clingo.Symbol, int] = {}  # external -> literal that a further definition may define
        self._closing: Dict[clingo.Symbol, int] = {}  # defined since the last search -> literal still to be defined
        self._closed: Set[clingo.Symbol] = set()
        self._absent: Dict[clingo.Symbol, int] = {}  # body atom that nothing knows yet -> its stand-in
        self._hidden: Set[clingo.Symbol] = set()
        self.horizon = program.first_step - 1
        self._ends = HorizonLiterals(self._control, self.horizon)
        self.declare(open_atoms, set(facts))
        self._control.ground([("base", [])])
        self._note_externals(1)

    def declare(self, atoms: Iterable[clingo.Symbol], facts: Set[clingo.Symbol]) -> None:
        """Make ``atoms`` of open signatures known to all parts grounded later."""
        with self._control.backend() as backend:
            for atom in atoms:
                literal = backend.add_atom(atom)
                if atom in facts:
                    backend.add_rule([literal])
                    self._closed.add(atom)
                else:
                    backend.add_external(literal, _FALSE)
                    self._cells[atom] = literal

    def ground_step(self) -> None:
        """Ground the next step; raises RuntimeError as clingo does."""
        self.horizon += 1
        step = self.horizon
        self._control.ground([("cumulative", [clingo.Number(step)]), ("volatile", [clingo.Number(step)])])
        self._note_externals(step)
        for window in self.program.windows:
            guard = self._control.symbolic_atoms[guard_atom(window, step)]
            if guard is not None and window > 0:
                self._ends.define_window(guard.literal, step, window)
                self._hidden.add(guard.symbol)
        if self._shortest:
            self._ends.forbid_beyond(step)
        self._resolve_absent()

    def _note_externals(self, step: int) -> None:
        for literal in self._externals.fresh:
            self._declared.setdefault(literal, step)
        self._externals.fresh.clear()

    def knows(self, atom: clingo.Symbol) -> bool:
        """Tell whether some grounded rule or external mentions ``atom`` as possible."""
        return atom in self._control.symbolic_atoms

    def is_true(self, atom: clingo.Symbol) -> bool:
        """Tell whether ``atom`` is known as a fact."""
        known = self._control.symbolic_atoms[atom]
        return known is not None and known.is_fact

    def is_open(self, atom: clingo.Symbol) -> bool:
        """Tell whether ``atom`` is an external that a rule may define now."""
        if atom in self._cells or atom in self._closing:
            return True  # defined since the last search: more rules may still define it
        if atom in self._closed:
            return False
        known = self._control.symbolic_atoms[atom]
        return known is not None and known.is_external

    def add(self, statement: Statement, guard: Optional[int]) -> None:
        """Add a rule under ``guard``; its head must be open or an atom that the program does not know."""
        with self._control.backend() as backend:
            body = [self._body_literal(backend, literal) for literal in statement.body]
            body += [] if guard is None else [guard]
            head = [] if statement.head is None else [self._head(backend, statement.head, guard)]
            backend.add_rule(head, body)

    def _head(self, backend: Backend, atom: clingo.Symbol, guard: Optional[int]) -> int:
        """Return the literal to define for ``atom``; behind a guarded definition a new open one takes its place."""
        if atom.name.startswith("__oclingo_"):
            self._hidden.add(atom)
        if atom not in self._closing:
            cell = self._cells.pop(atom, None)
            self._closing[atom] = cell if cell is not None else self._new_or_known(backend, atom)
        literal = self._closing[atom]
        if guard is None:
            self._closed.add(atom)
            if atom in self._cells:
                backend.add_external(self._cells.pop(atom), _FREE)
        elif atom not in self._closed and atom not in self._cells:
            following = self._cells[atom] = backend.add_atom()
            backend.add_external(following, _FALSE)
            backend.add_rule([literal], [following])
        return literal

    def _new_or_known(self, backend: Backend, atom: clingo.Symbol) -> int:
        fresh = not self.knows(atom)
        literal = backend.add_atom(atom)
        if fresh:
            opposite = self._control.symbolic_atoms[clingo.Function(atom.name, atom.arguments, not atom.positive)]
            if opposite is not None:
                backend.add_rule([], [literal, opposite.literal])
            if atom in self._absent:
                backend.add_rule([self._absent.pop(atom)], [literal])
        return literal

    def _body_literal(self, backend: Backend, literal: Literal) -> int:
        atom = literal.atom
        known = self._control.symbolic_atoms[atom]
        if known is not None:
            code = backend.add_atom(atom)
        elif atom in self._absent:
            code = self._absent[atom]
        else:
            code = self._absent[atom] = backend.add_atom()
            backend.add_external(code, _FALSE)
        return code if literal.positive else -code

    def _resolve_absent(self) -> None:
        """Tie body atoms of updates that came before their step to the atoms that are grounded by now."""
        found = [atom for atom in self._absent if self.knows(atom)]
        if found:
            with self._control.backend() as backend:
                for atom in found:
                    backend.add_rule([self._absent.pop(atom)], [backend.add_atom(atom)])

    def new_guard(self) -> int:
        """Return a literal that holds until it is released."""
        with self._control.backend() as backend:
            guard = backend.add_atom()
            backend.add_external(guard, _TRUE)
        return guard

    def release(self, guards: Sequence[int]) -> None:
        """Make ``guards`` false for good."""
        if guards:
            with self._control.backend() as backend:
                for guard in guards:
                    backend.add_external(guard, _FREE)

    def declared_between(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the open externals that were declared at steps ``first`` to ``last`` (base counts as 1)."""
        atoms = self._control.symbolic_atoms
        return [
            one.symbol
            for signature in self.program.external_signatures
            for one in atoms.by_signature(*signature)
            if first <= self._declared.get(one.literal, last + 1) <= last and self.is_open(one.symbol)
        ]

    def close(self, atom: clingo.Symbol) -> None:
        """Let the open external ``atom`` be false for good."""
        self._closed.add(atom)
        cell = self._cells.pop(atom, None)
        if cell is not None:
            self.release([cell])
        elif self.knows(atom):
            self._control.release_external(atom)

    def settle(self, step: int) -> None:
        """Say that no search will ask for a horizon before ``step`` any more."""
        self._ends.settle(step)

    @property
    def conflicting(self) -> bool:
        """Whether what has been added can never be satisfied, whatever externals and further steps bring."""
        return self._control.is_conflicting

    def search(self, models: int, stopped: Callable[[], bool], first: int, last: int) -> Search:
        """Search for up to ``models`` answers (0: all) of a horizon in first..last, until ``stopped`` says so.

        Below the last grounded step, volatile rules hold as they did at that horizon; where ``first`` < ``last`` the answers'
        horizons are free within the range.
        """
        self._closing.clear()
        assumptions = self._ends.range(first, last)
        answers: List[FrozenSet[clingo.Symbol]] = []
        horizons = [last]
        best = self.program.optimizes
        self._control.configuration.solve.models = str(models)
        if best:
            self._control.configuration.solve.opt_mode = "optN"

        def keep(model: clingo.Model) -> None:
            if not best or model.optimality_proven:
                answers.append(frozenset(model.symbols(shown=True)) - self._hidden)
                horizons.append(self._ends.horizon_of(model, first, last))

        with self._control.solve(assumptions=assumptions, on_model=keep, async_=True) as handle:
            while not handle.wait(POLL):
                if stopped():
                    handle.cancel()
            result = handle.get()
        if result.interrupted:
            return Search(None)
        return Search(bool(result.satisfiable), tuple(answers), horizons[-1])
