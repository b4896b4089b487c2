"""The grounding of the incremental solver: it grows step by step, and updates change it in place.

It knows nothing of streams: the solver tells it what to ground, define, release and solve. It can be dropped and built
again at any time from the solver's state.
"""

from typing import Callable, Container, Dict, FrozenSet, Iterable, List, Optional, Sequence, Set, Tuple

import clingo

from rosoclingo.oclingo.errors import DroppedError
from rosoclingo.oclingo.program.action_rules import BEYOND
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.lifetimes import FOREVER, Lifetime
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.oclingo.solving.atom_index import ExternalIndex
from rosoclingo.oclingo.solving.atom_table import HOLDS, AtomTable, BackendSession
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch, Limits
from rosoclingo.oclingo.solving.cycles import ActionIndex
from rosoclingo.oclingo.solving.stream_state import StreamState

Answers = Tuple[FrozenSet[clingo.Symbol], ...]

Parts = Sequence[Tuple[str, Sequence[clingo.Symbol]]]
"""Program parts with their arguments."""

BLOCK = 64
"""Steps that are ground at once during regrounding."""


class ReactiveGrounding:
    """A control with base and the steps first..:attr:`horizon` grounded.

    Nothing in it refers to it, so that its memory, which may be much, is free as soon as nobody else does.

    Attributes:
        horizon: the last grounded step; first step - 1 while only base is grounded.
        atoms: what updates may say of the atoms, and how.
        messages: what clingo said since they were last cleared.

    """

    def __init__(
        self, program: ReactiveProgram, open_atoms: Iterable[clingo.Symbol], facts: Set[clingo.Symbol]
    ) -> None:
        """Load ``program`` and ground its base, ``open_atoms`` known as externals or, where in ``facts``, as facts.

        Raises RuntimeError as clingo does.
        """
        self.program = program
        self.messages = Messages()
        self._control = clingo.Control(program.arguments(), logger=self.messages.log)
        self._session = BackendSession(self._control)
        self._externals = ExternalIndex(self._control, program)
        self.atoms = AtomTable(self._control, self._session, self._externals)
        self._actions = ActionIndex(self._control, self._session)
        program.load_into(self._control)
        self._clasp = ClaspSearch(self._control, program)
        self._guards: Dict[Lifetime, int] = {}  # of what will lapse -> the literal under which it holds
        self._windows: List[Tuple[clingo.Symbol, int, int]] = []  # guards of volatile rules, with when they hold
        self._hidden: Set[clingo.Symbol] = set()  # auxiliary atoms, left out of answers
        self.horizon = program.first_step - 1
        self.declare(open_atoms, facts)
        self._ground([("base", [])], range(1, 2))
        self._externals.end_base()

    def declare(self, atoms: Iterable[clingo.Symbol], facts: Container[clingo.Symbol] = ()) -> None:
        """Make atoms of open signatures known to all that is grounded later: as externals, or as facts."""
        declared = list(atoms)
        self._externals.stepless.update(declared)
        self._ground([self.program.open_part(atom, atom in facts) for atom in declared], range(1, 2))
        self.atoms.resolve_absent()

    def _ground(self, parts: Parts, steps: range) -> None:
        self._session.close()
        self._control.ground(parts)
        self._externals.note(steps)
        self._actions.expire()

    def ground_to(self, last: int) -> None:
        """Ground the steps up to ``last`` at once, which is much quicker than one by one; raises RuntimeError."""
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
        self.atoms.resolve_absent()

    def add(self, statement: Statement, lifetime: Lifetime) -> None:
        """Put a statement in force, for ever or until its lifetime lapses; its head may be defined."""
        guard = None
        if lifetime != FOREVER:
            if lifetime not in self._guards:
                self._guards[lifetime] = self._session.new_external(HOLDS)
            guard = self._guards[lifetime]
        self.atoms.add(statement, guard)

    def lapse(self, lifetimes: Iterable[Lifetime]) -> None:
        """End what holds for the ``lifetimes``."""
        for lifetime in lifetimes:
            if lifetime in self._guards:
                self._session.release(self._guards.pop(lifetime))

    def declared_between(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the open externals that were declared at steps ``first`` to ``last``; base counts as 1."""
        return [atom for atom in self._externals.between(first, last, base=True) if self.atoms.is_open(atom)]

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle`` to ``executed``."""
        self._actions.close_cycle(cycle, executed)

    @property
    def conflicting(self) -> bool:
        """Whether the program is unsatisfiable for any externals and further steps."""
        return bool(self._control.is_conflicting)

    def search(self, models: int, stopped: Callable[[], bool]) -> Tuple[Optional[bool], Answers]:
        """Search for up to ``models`` answers (0: all) of the horizon, until ``stopped`` says so.

        Returns whether there is one, None where it was stopped, and the answers: the best where the program optimizes.
        """
        self.atoms.end_definitions()
        self._actions.forbid_late()
        self._session.close()
        answers: List[FrozenSet[clingo.Symbol]] = []
        hidden = self._hidden

        def keep(model: clingo.Model) -> None:
            """Take a model for an answer; where there is something to optimize, one that is proven best."""
            if not model.cost or model.optimality_proven:
                answers.append(frozenset(model.symbols(shown=True)) - hidden)

        limits = Limits(models, None, best=True, advised=True)
        result, _ = self._clasp.run(limits, (), keep, stopped, blames=False)
        if result.interrupted or result.unknown:
            return None, ()
        return bool(result.satisfiable or answers), tuple(answers)


def build_grounding(program: ReactiveProgram, state: StreamState, dropped: Callable[[], bool]) -> ReactiveGrounding:
    """Ground ``program`` up to the state's horizon and put in force all that ``state`` holds.

    Nothing is searched in between, so that clingo sees all rules together: loops over several steps and several rules
    for one head are what they are in a program of one piece. Raises DroppedError where ``dropped``, which is asked
    before each block of steps, says so.
    """
    facts = state.facts
    open_atoms = dict.fromkeys(state.open_atoms)
    grounding = ReactiveGrounding(program, open_atoms, facts)
    block = BLOCK if state.horizon > grounding.horizon + 1 and program.steps_apart else 1
    while grounding.horizon < state.horizon:
        if dropped():
            raise DroppedError("stopped while the program was grounded again; the request was discarded")
        grounding.ground_to(min(grounding.horizon + block, state.horizon))
    for atom in state.forgotten:
        grounding.atoms.close(atom)
    for cycle, executed in state.closed_cycles.items():
        grounding.close_cycle(cycle, executed)
    given = set(open_atoms) & facts
    for statement in state.permanent:
        if statement.head not in given:  # a fact subsumes the rules with its head
            grounding.add(statement, FOREVER)
    for entry in state.lapsing:
        grounding.add(entry.statement, entry.lifetime)
    return grounding
