"""One grounding of a reactive program in one :class:`clingo.Control`, grown step by step.

The grounding knows nothing of streams: the solver tells it what to ground, define, release and solve. It can be thrown
away and built anew at any time from the solver's state.
"""

from contextlib import contextmanager
from functools import cached_property
from itertools import chain
from typing import Any, Callable, Container, Dict, FrozenSet, Iterable, Iterator, List, Optional, Sequence, Set, Tuple
from weakref import proxy

import clingo
from clingo.propagator import Propagator

from rosoclingo.oclingo.errors import DroppedError
from rosoclingo.oclingo.program.action_rules import ACTION, RETURN, STEPS, no_plan_from, steps_claimed
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.return_rules import ReturnRules
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.oclingo.solving.assumptions import Assumptions, Search
from rosoclingo.oclingo.solving.atom_table import HOLDS, AtomTable, BackendSession, Externals, Heads
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch, Limits
from rosoclingo.oclingo.solving.closed_steps import closed_blocks
from rosoclingo.oclingo.solving.doubts import Doubts
from rosoclingo.oclingo.solving.foresight import Foreseen, foresee
from rosoclingo.oclingo.solving.horizon import ActionIndex, CycleIndex, ExternalIndex, HorizonLiterals
from rosoclingo.oclingo.solving.stream_state import FOREVER, Lifetime, Past, StreamState, block_ends

Parts = Sequence[Tuple[str, Sequence[clingo.Symbol]]]
"""Program parts with their arguments."""

DOMAIN_LIMIT = 100
"""Atoms of an open signature that are declared with each step, at most; more would cost more than to ground anew."""

BASE = range(-(2**31), 1 - 2**31)
"""The base part among the steps that were ground at once."""

PAST: Tuple[str, List[str]] = ("__oclingo_past", [])
"""The part that has what steps must know of those that are retired, and its parameters."""


class Grounding:
    """A control with base and the steps first..:attr:`horizon` grounded.

    Nothing in it refers to it, so that its memory, which may be much, is free as soon as nobody else does.

    Attributes:
        horizon: the last grounded step; first step - 1 while only base is grounded.
        atoms: what updates may say of the atoms, and how.
        messages: what clingo said since they were last cleared.
        past: the steps before those that are ground.
        ground_parts: what was ground one after the other, with the steps, :data:`BASE` or none, where answers are
            shortest.
        names: the literals of the atoms that base has; clingo lets go of the names of those that are false for good.
        shown: the shown atoms of the last answer.
        satisfied: whether a search had an answer, and nothing was added since but what was foreseen.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        open_atoms: Iterable[clingo.Symbol],
        facts: Set[clingo.Symbol],
        shortest: bool = False,
        past: Optional[Past] = None,
        doubted: FrozenSet[clingo.Symbol] = frozenset(),
        foresees: bool = False,
    ) -> None:
        """Load ``program`` and ground its base, ``open_atoms`` known as externals or, where in ``facts``, as facts.

        With ``shortest`` no answer holds an action of a cycle beyond its horizon. Steps that ``past`` tells of are not
        ground. Of facts that are ``doubted`` each search says whether they were told. Where it ``foresees``, answers
        come with the returns that may be told. Raises RuntimeError as clingo does.
        """
        self.program = program
        self._shortest = shortest
        self.messages = Messages()
        self._control = clingo.Control(program.arguments(), logger=self.messages.log)
        self._session = BackendSession(self._control)
        self._observer, self._heads = Externals(), Heads()
        self.ground_parts: List[Tuple[range, Parts]] = []
        self._blocks: Dict[int, range] = {}  # by their first step
        self._externals = ExternalIndex(self._control, program, self._blocks, () if shortest else program.domains)
        self.atoms = AtomTable(self._control, self._session, self._externals.declared, self._heads.externals)
        self._doubts = Doubts(self._session, doubted) if doubted else None
        self._told = self._doubts.literals if self._doubts else {}  # fact in doubt -> literal under which it was told
        first = program.first_step if shortest else None
        self._actions = ActionIndex(self._control, self._session, ACTION, first, self._told)
        self._returns = CycleIndex(self._control, RETURN)
        self._return_rules = program.return_rules if foresees else None
        self._asked: Set[clingo.Symbol] = set()  # in the bodies of the stream's rules
        for observer in (self._observer, self._heads) if program.defines_externals else (self._observer,):
            self._control.register_observer(observer)
        program.load_into(self._control, foresees)
        self._hidden: Set[clingo.Symbol] = set()
        self.shown: FrozenSet[clingo.Symbol] = frozenset()
        self.satisfied = False
        self._clasp = ClaspSearch(self._control, program)
        self._guards: Dict[Lifetime, int] = {}  # of what will lapse -> the literal under which it holds
        self.past = past or Past(program.first_step, frozenset())
        self._retired = frozenset(atom for _, atom in self.past.shown)
        self.horizon = self.past.first - 1
        self._ends = HorizonLiterals(self._control, self._session, self.horizon)
        self.declare(open_atoms, facts)
        self._ground_base()
        self._externals.end_base()
        self._tell(self.past.facts)
        self._before_steps = len(self._control.symbolic_atoms)

    def _ground_base(self) -> None:
        self._ground([("base", [])], 1, BASE)
        known = self._control.symbolic_atoms if self._shortest else ()
        self.names = {one.symbol: one.literal for one in known}

    def declare(self, atoms: Iterable[clingo.Symbol], facts: Container[clingo.Symbol] = ()) -> None:
        """Make atoms of open signatures known to all that is grounded later: as externals, or as facts."""
        declared = list(atoms)
        self._externals.stepless.update(declared)
        self._ground([self.program.open_part(atom, atom in facts) for atom in declared], 1)
        self.atoms.resolve_absent()

    def _tell(self, facts: Iterable[clingo.Symbol]) -> None:
        """Make ``facts`` known to the steps."""
        doubted = [atom for atom in facts if atom in self._told]
        text = "".join(f"#external {atom}.\n" if atom in doubted else f"{atom}.\n" for atom in facts)
        if text:
            self._control.add(*PAST, text)
            self._ground([(PAST[0], [])], self.past.first - 1)
        for atom in doubted:
            self.add(Statement(atom), FOREVER)

    def _ground(self, parts: Parts, step: int, steps: range = range(0)) -> None:
        self._session.close()
        self._control.ground(parts)
        if self._shortest:
            self.ground_parts.append((steps, parts))
        self._externals.note(self._observer.fresh, step)
        self._observer.fresh.clear()
        self._heads.sort(self._externals.declared)
        self._returns.expire()
        self._actions.expire()
        self._ends.expire()

    def ground_to(self, last: int) -> None:
        """Ground the steps up to ``last`` at once, which is much quicker than one by one; raises RuntimeError."""
        steps = range(self.horizon + 1, last + 1)
        names = ("cumulative", "volatile", *self._domain_parts)
        parts = [(part, [clingo.Number(step)]) for step in steps for part in names]
        self.horizon, self.satisfied = last, False
        self._blocks[steps[0]] = steps
        self._ground(parts, steps[0], steps)
        for step in steps:
            self._bound(step)
        if self._shortest:
            self._ends.link(last)
        self.atoms.resolve_absent()

    @property
    def atoms_per_step(self) -> int:
        """How many atoms a step has that is ground, on average; at least 1."""
        found, steps = len(self._control.symbolic_atoms) - self._before_steps, self.horizon + 1 - self.past.first
        return max(1, found // max(1, steps))

    @cached_property
    def _domain_parts(self) -> List[str]:
        """The parts that declare what else a step could use of open signatures; to be asked for once base is ground.

        Where steps are retired there are none: what nobody has defined would hold them.
        """
        known = () if self._shortest else self.program.domains.values()
        return [domain.part for domain in known if domain.size(self._control) <= DOMAIN_LIMIT]

    def _bound(self, step: int) -> None:
        """Tie the volatile rules of ``step`` to the horizon."""
        for window in self.program.windows:
            guard = self._control.symbolic_atoms[self.program.guard(window, step)]
            if guard is not None and window > 0:
                self._ends.define_window(guard.literal, step, window)
                self._hidden.add(guard.symbol)

    def add(self, statement: Statement, lifetime: Lifetime) -> None:
        """Put a statement in force, for ever or until its lifetime lapses; its head may be defined."""
        self.satisfied = False
        self._asked.update(literal.atom for literal in statement.body)
        guard = None if statement.subject is None else self._told.get(statement.subject)
        if lifetime != FOREVER:
            if lifetime not in self._guards:
                self._guards[lifetime] = self._session.new_external(HOLDS)
            guard = self._session.conjunction(self._guards[lifetime], guard)
        self.atoms.add(statement, guard)

    def lapse(self, lifetimes: Iterable[Lifetime]) -> None:
        """End what holds for the ``lifetimes``."""
        for lifetime in lifetimes:
            if lifetime in self._guards:
                self._session.release(self._guards.pop(lifetime))

    def declared_between(self, first: int, last: int, base: bool = True) -> List[clingo.Symbol]:
        """Return the open externals that were declared at steps ``first`` to ``last`` (``base`` counts as 1)."""
        return [atom for atom in self._externals.between(first, last, base) if self.atoms.is_open(atom)]

    def claimed_steps(self, step: int) -> int:
        """Return how many steps the program claims that a plan from ``step`` on takes at least; 0 for no claim.

        What is known for good counts, after a search all that follows from what was told.
        """
        self._session.close()
        self._control.cleanup()
        claims = [one.symbol for one in self._control.symbolic_atoms.by_signature(*STEPS) if one.is_fact]
        return max((steps_claimed(claim, step) for claim in claims), default=0)

    def claim(self, step: int) -> Optional[int]:
        """Return the literal of the claim that there is no plan from ``step`` on; None where it can't be true."""
        if STEPS not in self.program.head_signatures:
            return None
        known = self._control.symbolic_atoms[no_plan_from(step)]
        return (known.literal or None) if known is not None else None

    def show(self, propagator: Propagator) -> None:
        """Let ``propagator`` read the program as it stands, without a search."""
        self._control.register_propagator(propagator)
        self._actions.forbid_late()
        self.simplify()

    def simplify(self) -> None:
        """Let clingo see what follows for good, so that all that is ground from now on is ground with that known."""
        external = self._session.new_external()
        self._session.close()
        self._control.solve(assumptions=[external, -external])  # ends at once, but reads the program
        self._session.release(external)

    def close_cycle(self, cycle: int, executed: Iterable[clingo.Symbol]) -> None:
        """Fix the actions of ``cycle`` to ``executed``."""
        self._actions.close_cycle(cycle, executed)

    def close_returns(self, cycle: int) -> None:
        """Close the returns of ``cycle`` that never came: what can't come any more needs no thought."""
        for atom, _ in self._returns.pop_cycle(cycle):
            if self.atoms.is_open(atom):
                self.atoms.close(atom)

    def settle(self, step: int) -> None:
        """Say that no search will ask for a horizon before ``step`` any more."""
        self._ends.settle(step)

    @property
    def conflicting(self) -> bool:
        """Whether what has been added can never be satisfied, whatever externals and further steps bring."""
        return bool(self._control.is_conflicting)

    @property
    def known(self) -> List[clingo.Symbol]:
        """All atoms that may be true by what is ground."""
        return [one.symbol for one in self._control.symbolic_atoms]

    @property
    def complete(self) -> bool:
        """Whether further steps leave what is ground as it is: where it has no answer, they bring none."""
        defined = self.program.defines_externals and not self.program.steps_apart
        return not (self.atoms.awaited or self._ends.coming or defined)

    def actions(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the ``_action_lib`` atoms of the cycles first..last, as far as these have not been closed."""
        return self._actions.between(first, last)

    def search(
        self,
        models: int,
        stopped: Callable[[], bool],
        first: int,
        last: int,
        given: Sequence[Tuple[clingo.Symbol, bool]] = (),
        conflicts: Optional[int] = None,
        best: bool = True,
        proven: bool = True,
        untold: FrozenSet[clingo.Symbol] = frozenset(),
        kept: Sequence[clingo.Symbol] = (),
        advised: bool = True,
        claim: Optional[int] = None,
    ) -> Search:
        """Search for up to ``models`` answers (0: all) of a horizon in first..last, until ``stopped`` says so.

        Below the last grounded step, volatile rules hold as they did at that horizon; where ``first`` < ``last`` the
        answers' horizons are free within the range. Only answers are looked for in which the atoms ``given`` are as
        they are given, for so many ``conflicts`` at most (None: no limit). Where the program optimizes, they are the
        ``best``, or else any; where that need not be ``proven``, the best that is found until the search is stopped.
        Facts in doubt were told but those ``untold``. What is ``kept`` is true. ``#heuristic`` counts if ``advised``.
        The literal ``claim`` is false.
        """
        self.atoms.end_definitions()
        self._actions.forbid_late()
        assumed, horizon = self._assumed(untold, kept, claim), self._ends.range(first, last)
        self._session.close()
        answers, horizons, foreseen = [], [last], [Foreseen()]
        this = proxy(self)  # since the control keeps the function, which must not keep the control

        def keep(model: clingo.Model) -> None:
            """Take a model for an answer; where there is something to optimize, one that is proven best or will do."""
            if not (best and proven and model.cost) or model.optimality_proven:
                this.shown = frozenset(model.symbols(shown=True)) - this._hidden - this._ends.names
                answers.append(this.shown | this._retired)
                horizons.append(this._ends.horizon_of(model, first, last))
                if this._return_rules is not None:
                    foreseen.append(this._foresee(model, this._return_rules))

        assumptions: List[Any] = [*(assumed.literals if assumed else ()), *horizon, *given]  # clasp blames the first
        limits = Limits(models, conflicts, best, advised)
        result, core = self._clasp.run(limits, assumptions, keep, stopped, blames=assumed is not None)
        self.satisfied = (satisfied := bool(result.satisfiable or answers)) or self.satisfied
        if (result.interrupted or result.unknown) and (proven or not answers):
            return Search(None)
        kept_answers = tuple(answers if proven else answers[-1:])
        if satisfied:
            return Search(True, kept_answers, horizons[-1], foreseen=foreseen[-1])
        return assumed.refuted_by(core, horizon, bool(given)) if assumed else Search(False)

    @contextmanager
    def lacking(self, atoms: Iterable[clingo.Symbol]) -> Iterator[None]:
        """Within this context, search for answers that lack at least one of the ``atoms``."""
        guard = self._session.new_external(HOLDS)
        known = map(self._control.symbolic_atoms.__getitem__, atoms)
        self._session.backend.add_rule([], [guard, *(one.literal for one in known if one is not None)])
        yield
        self._session.release(guard)

    def _assumed(
        self, untold: FrozenSet[clingo.Symbol], kept: Sequence[clingo.Symbol], claim: Optional[int]
    ) -> Optional[Assumptions]:
        """Return what a search assumes beside its horizon; None where it is nothing, as a rule."""
        if not (self._doubts or kept or claim):
            return None
        literals = {one.symbol: one.literal for one in map(self._control.symbolic_atoms.__getitem__, kept) if one}
        return Assumptions(self._doubts, untold, literals, claim)

    def _foresee(self, model: clingo.Model, rules: ReturnRules) -> Foreseen:
        """Return what is foreseen of a model whose shown atoms are known."""
        atoms = self._control.symbolic_atoms

        def is_true(atom: clingo.Symbol) -> Optional[bool]:
            known = atoms[atom]
            return model.is_true(known.literal) if known is not None and known.literal else None

        def may_be_told(atom: clingo.Symbol) -> bool:
            return atom not in self._asked and self.atoms.is_open(atom)

        return foresee(self._actions.among(self.shown), rules, may_be_told, is_true)


BLOCK = 64
"""Steps that are grounded at once."""


def build_grounding(
    program: ReactiveProgram,
    state: StreamState,
    shortest: bool,
    dropped: Callable[[], bool] = lambda: False,
    coming: Iterable[clingo.Symbol] = (),
    doubted: FrozenSet[clingo.Symbol] = frozenset(),
    foresees: bool = False,
) -> Grounding:
    """Ground ``program`` up to the state's horizon and put in force all that ``state`` holds.

    Of steps whose cycles are closed little more is ground than what has become of them. Behind them nothing is searched
    in between, so that clingo sees all rules together: loops over several steps and several rules for one head are what
    they are in a program of one piece. Atoms that are ``coming`` are known as externals, and facts that are ``doubted``
    were told where a search says so; where it ``foresees``, answers come with the returns that may be told.
    Raises DroppedError where ``dropped``, which is asked before each block of steps, says so.
    """
    facts = state.facts_without(doubted)
    open_atoms = dict.fromkeys([*state.open_atoms, *coming])
    grounding = Grounding(program, open_atoms, facts, shortest, state.past, doubted, foresees)
    start, told = grounding.horizon + 1, set()  # type: int, Set[Statement]
    known = state.closed_until(start) if shortest and program.heads_apart and not doubted else start - 1
    closed = closed_blocks(grounding, state, known, told) if known >= start else ()
    for last in chain(closed, block_ends(state, known + 1, BLOCK if shortest or program.steps_apart else 1)):
        if dropped():
            raise DroppedError("stopped while the program was grounded again; the request was discarded")
        grounding.ground_to(last)
    for atom in state.forgotten:
        grounding.atoms.close(atom)
    for cycle, executed in state.closed_cycles.items():
        grounding.close_cycle(cycle, executed)
    given = set(open_atoms) & facts
    for statement in state.permanent:
        if statement.head not in given and statement not in told:  # a rule for what is given as a fact says no more
            grounding.add(statement, FOREVER)
    for entry in state.lapsing:
        grounding.add(entry.statement, entry.lifetime)
    for cycle in sorted(state.closed_cycles.keys() - state.returning):
        grounding.close_returns(cycle)
    return grounding
