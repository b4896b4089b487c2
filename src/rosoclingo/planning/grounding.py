"""A snapshot's program, ground in one :class:`clingo.Control` and asked questions.

A grounding is never changed, except that its horizon grows; it can be dropped and built again at any time.
"""

from contextlib import contextmanager
from typing import Any, Collection, Dict, FrozenSet, Iterable, Iterator, List, Optional, Sequence, Set, Tuple
from weakref import proxy

import clingo
from clingo.propagator import Propagator

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.action_rules import BEYOND, RETURN, STEPS, no_plan_from, steps_claimed
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.parts import GUARD
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.return_rules import ReturnRules
from rosoclingo.oclingo.program.signatures import statement_edges
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.strings import holds_string_apart
from rosoclingo.oclingo.progression.terms import Signature, signature_of
from rosoclingo.oclingo.progression.updates import Statement, commitment
from rosoclingo.oclingo.solving.atom_index import ExternalIndex
from rosoclingo.oclingo.solving.atom_table import HOLDS, BackendSession, Externals, Heads
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch, Limits
from rosoclingo.oclingo.solving.cycles import ActionIndex
from rosoclingo.oclingo.solving.results import refusal, unused_fact
from rosoclingo.planning.assumables import Assumables
from rosoclingo.planning.definitions import Definitions
from rosoclingo.planning.horizons import HorizonLiterals
from rosoclingo.planning.prediction import Predicted, predict
from rosoclingo.planning.question import UNKNOWN, Question, Reply, Stop
from rosoclingo.planning.snapshot import (
    NOT_EXTERNAL,
    ClosedHeads,
    ForgottenSteps,
    Past,
    Snapshot,
    SnapshotItem,
    TimedStatement,
)

Parts = Sequence[Tuple[str, Sequence[clingo.Symbol]]]
"""Program parts with their arguments."""

PIECE = 64
"""Steps that are ground at once."""

CLOSED_PIECE = 16
"""Steps that are ground at once if their cycles are closed."""

BASE = range(-(2**31), 1 - 2**31)
"""The base part among the steps that were ground at once."""

PAST: Tuple[str, List[str]] = ("__oclingo_past", [])
"""The part that has what steps must know of those that are retired, and its parameters."""

HIDDEN = (Signature(GUARD, 2), BEYOND)
"""The predicates of auxiliary atoms, which are no part of an answer."""

_TOO_LATE = "Head {} comes too late: what concerns steps before {} is over. The entire rule will be ignored."


class Grounding:
    """Base and the steps up to :attr:`horizon` of a program, with all that a snapshot holds.

    Nothing in it refers to it, so that its memory, which may be much, is free as soon as nobody else does.

    Attributes:
        program: the reactive logic program.
        snapshot: what is in force.
        horizon: the last step that is ground.
        warnings: what was ignored of the snapshot's last update.
        messages: what clingo said.
        past: the steps before those that are ground.
        ground_parts: what was ground one after the other, with the steps, :data:`BASE` or none.
        shown: the shown atoms of the last answer, None before there was one.
        definitions: the statements that define their heads.
        in_force: the statements that are.
        waiting: statements whose heads only steps to come declare.
        false: externals that nothing will define any more.
        is_cyclic: whether a statement closes a positive loop, which clingo finds only among rules that come together;
            such a grounding must not grow.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        snapshot: Snapshot,
        horizon: int,
        assumable: FrozenSet[clingo.Symbol] = frozenset(),
        dropped: Stop = lambda: False,
        predicts: bool = False,
        whole: bool = False,
    ) -> None:
        """Ground ``program`` up to ``horizon``, in pieces unless it is ground as a ``whole``.

        clingo takes rules of several steps that define the same atom only together.

        Each question says which of the ``assumable`` facts were told. If it ``predicts``, replies tell which returns
        leave the answer one. Raises DroppedError if ``dropped``, which is asked between pieces, says so, and
        SolverError for what clingo refuses.
        """
        self.program, self.snapshot, self.messages = program, snapshot, Messages()
        self.is_cyclic = _closes_loops(program, snapshot)
        self.past = snapshot.past or Past(program.first_step, frozenset())
        self.horizon = self.past.first - 1
        self.warnings = [*snapshot.warnings, *_unused_facts(program, snapshot)]
        self.shown: Optional[FrozenSet[clingo.Symbol]] = None
        self.in_force: List[TimedStatement] = []
        self.waiting: List[TimedStatement] = []
        self.false: Set[clingo.Symbol] = set()
        self.ground_parts: List[Tuple[range, Parts]] = []
        self._dropped = dropped
        self._retired = frozenset(atom for _, atom in self.past.shown)
        self._return_rules = program.return_rules if predicts else None
        self._hidden: Set[clingo.Symbol] = set()
        self._control = clingo.Control(program.arguments(), logger=self.messages.log)
        self._session = BackendSession(self._control)
        self._observer, self._heads = Externals(), Heads()
        self._pieces: Dict[int, range] = {}  # by their first step
        self._externals = ExternalIndex(self._control, program, self._pieces)
        self.definitions = Definitions(self._control, self._session, self._externals.declared, self._heads.externals)
        self._assumables = Assumables(self._session, assumable)
        self._actions = ActionIndex(self._control, self._session, program.first_step, self._assumables.literals)
        self._ends = HorizonLiterals(self._control, self._session, self.horizon)
        for observer in (self._observer, self._heads) if program.defines_externals else (self._observer,):
            self._control.register_observer(observer)
        with self._refusing():
            program.load_into(self._control, predicts)
        self._clasp = ClaspSearch(self._control, program)
        self._build(horizon, max(PIECE, horizon) if whole else PIECE)

    # ---- Building ----------------------------------------------------------------------------------------------------

    def _build(self, horizon: int, size: int) -> None:
        """Ground base and the steps up to ``horizon``, and put in force what the snapshot holds."""
        snapshot = self.snapshot
        self._given = self._declare_open()
        self._ground([("base", [])], 1, BASE)
        self._externals.end_base()
        self._tell(self.past.facts)
        self._ground_closed(horizon)
        for last in pieces(self.horizon + 1, horizon, size, snapshot.keep_from):
            self._ground_to(last)
        for cycle, executed in snapshot.closed.items():
            self._actions.close_cycle(cycle, executed)
        self._put_in_force(snapshot.items)
        over = {clingo.Number(cycle) for cycle in snapshot.closed.keys() - snapshot.awaiting_returns}
        for one in self._control.symbolic_atoms.by_signature(*RETURN):
            if one.symbol.arguments[2] in over and self.definitions.is_undefined(one.symbol):
                self.definitions.close(one.symbol)
        self._ends.settle(min(snapshot.min_horizon, self.horizon))

    def _declare_open(self) -> Set[clingo.Symbol]:
        """Make the heads of open signatures known: as facts, which are returned, or as externals."""
        heads = dict.fromkeys(one.head for one in self.snapshot.statements if one.head is not None)
        opened = [
            head
            for head in heads
            if self.program.is_open_signature(head) and not self.snapshot.is_too_late(self.program, head)
        ]
        facts = self.snapshot.permanent_facts(self._assumables.facts)
        self._externals.stepless.update(opened)
        self._ground([self.program.open_part(atom, atom in facts) for atom in opened], 1)
        return facts.intersection(opened)

    def _tell(self, facts: Iterable[clingo.Symbol]) -> None:
        """Make ``facts`` of retired steps known to the steps."""
        assumable = [atom for atom in facts if atom in self._assumables.literals]
        text = "".join(f"#external {atom}.\n" if atom in assumable else f"{atom}.\n" for atom in facts)
        if text:
            self._control.add(*PAST, text)
            self._ground([(PAST[0], [])], self.past.first - 1)
        for atom in assumable:
            self._add(TimedStatement(Statement(atom), FOREVER, 0))

    def _ground(self, parts: Parts, step: int, steps: range = range(0)) -> None:
        self._session.close()
        with self._refusing():
            self._control.ground(parts)
        self.ground_parts.append((steps, parts))
        self._externals.note(self._observer.fresh, step)
        self._observer.fresh.clear()
        self._heads.sort(self._externals.declared)
        self._actions.expire()
        self._ends.expire()
        for signature in HIDDEN:
            self._hidden.update(one.symbol for one in self._control.symbolic_atoms.by_signature(*signature))

    @contextmanager
    def _refusing(self) -> Iterator[None]:
        """Tell what clingo refuses."""
        try:
            yield
        except RuntimeError as error:
            raise SolverError(refusal(error, self.messages, self.program)) from None

    def _ground_to(self, last: int) -> None:
        """Ground the steps up to ``last`` at once, which is much quicker than one by one."""
        if self._dropped():
            raise DroppedError("stopped while the program was grounded again; the request was discarded")
        steps = range(self.horizon + 1, last + 1)
        self.horizon = last
        self._pieces[steps[0]] = steps
        self._ground(
            [(part, [clingo.Number(step)]) for step in steps for part in ("cumulative", "volatile")], steps[0], steps
        )
        for window in (one for one in self.program.windows if one > 0):
            for step in steps:
                guard = self._control.symbolic_atoms[self.program.guard(window, step)]
                if guard is not None:
                    self._ends.define_window(guard.literal, step, window)
        self._ends.link(last)
        self.definitions.resolve_absent()

    def _ground_closed(self, horizon: int) -> None:
        """Ground the steps whose cycles are closed, with their actions, if no fact of these is assumable.

        Else a robot might be anywhere in each of them, and they would cost as much as the steps to come.
        """
        if not self.program.heads_apart or self.assumable or self.is_cyclic:
            return
        snapshot, first = self.snapshot, self.horizon + 1
        committed = {one.body[0].atom for one in snapshot.permanent if one.is_commitment}
        end = min(horizon, snapshot.closed_until(first))
        for last in pieces(first, end, CLOSED_PIECE, snapshot.keep_from):
            steps = range(self.horizon + 1, last + 1)
            self._ground_to(last)
            for cycle in steps:
                self._actions.close_cycle(cycle, snapshot.closed[cycle])
                for action in sorted(committed & snapshot.closed[cycle]):
                    self.definitions.add(TimedStatement(commitment(action), FOREVER, 0))
            self.simplify()

    # ---- Statements --------------------------------------------------------------------------------------------------

    def _put_in_force(self, entries: Iterable[SnapshotItem]) -> None:
        """Put in force what a snapshot holds, in order; nothing is searched before all is."""
        for one in entries:
            if isinstance(one, ForgottenSteps):
                self.forget(one.first, one.last, spared=one.spared)
            elif isinstance(one, ClosedHeads):
                self._close(one.atoms)
            else:
                self._take(one)

    def forget(self, first: int, last: int, base: bool = True, spared: Collection[clingo.Symbol] = ()) -> None:
        """Let what steps ``first`` to ``last`` declare external and nothing defines be false (``base`` counts as 1).

        Not so the ``spared`` atoms.
        """
        self._close(atom for atom in self.undefined_between(first, last, base) if atom not in spared)

    def _close(self, atoms: Iterable[clingo.Symbol]) -> None:
        for atom in atoms:
            self.definitions.close(atom)
            self.false.add(atom)

    def _take(self, told: TimedStatement) -> None:
        """Put a statement in force if it defines its head, have it wait for its step, or ignore it."""
        statement, known, head = told.statement, self.definitions, told.statement.head
        if head is None or (head not in self._given and (known.is_open(head, told.update) or self._is_strange(head))):
            self._add(told)
        elif head in self._given:  # it is known as a fact, which says more
            if not statement.body and told.lifetime == FOREVER:
                self.in_force.append(told)
        elif not statement.body and known.is_true(head):
            return
        elif self.snapshot.is_too_late(self.program, head):
            self._warn(told, _TOO_LATE.format(head, self.past.first))
        elif not known.is_closed(head) and not known.knows(head) and self.program.may_declare(head, self.horizon + 1):
            self.waiting.append(told)
        else:
            self._warn(told, NOT_EXTERNAL.format(head))

    def _add(self, told: TimedStatement) -> None:
        self.in_force.append(told)
        subject = told.statement.subject
        assumed = None if subject is None else self._assumables.literals.get(subject)
        guards = [] if assumed is None else [assumed]
        if isinstance(told.lifetime, int):
            guards.append(self._ends.beyond(told.lifetime + 1))
        self.definitions.add(told, guards, assumed is not None)

    def _warn(self, told: TimedStatement, text: str) -> None:
        if told.update == self.snapshot.number:
            self.warnings.append(text)

    def _is_strange(self, atom: clingo.Symbol) -> bool:
        """Whether the program does not mention ``atom``, so that an update can define it freely."""
        signature, program = signature_of(atom), self.program
        is_mentioned = signature in program.signatures or signature in program.open_signatures
        if is_mentioned and not holds_string_apart(atom):
            return False
        return not self.definitions.knows(atom) and not self.definitions.is_closed(atom)

    # ---- What it tells -----------------------------------------------------------------------------------------------

    @property
    def is_conflicting(self) -> bool:
        """Whether the program is unsatisfiable for any externals and further steps."""
        return bool(self._control.is_conflicting)

    @property
    def named(self) -> Iterator[Tuple[clingo.Symbol, int]]:
        """The atoms that rules define, with their literals."""
        return ((one.symbol, one.literal) for one in self._control.symbolic_atoms if one.literal)

    @property
    def known(self) -> List[clingo.Symbol]:
        """All atoms that may be true by what is ground and, after a search, by what follows from it."""
        self._session.close()
        self._control.cleanup()
        return [one.symbol for one in self._control.symbolic_atoms]

    @property
    def atoms_per_step(self) -> int:
        """How many atoms there are for each step; at least 1."""
        return max(1, len(self._control.symbolic_atoms) // max(1, self.horizon + 1 - self.past.first))

    @property
    def assumable(self) -> FrozenSet[clingo.Symbol]:
        """The facts of which each question says whether they were told."""
        return self._assumables.facts

    def actions(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the ``_action_lib`` atoms of the cycles first..last that are not closed."""
        return self._actions.between(first, last)

    def undefined_between(self, first: int, last: int, base: bool = True) -> List[clingo.Symbol]:
        """Return the externals that steps ``first`` to ``last`` declare and nothing defines (``base`` counts as 1)."""
        found = self._externals.between(first, last, base)
        return [atom for atom in found if self.definitions.is_undefined(atom) and atom.name != GUARD]

    def claimed_steps(self) -> int:
        """Return how many steps the program claims that a plan from the present step on takes; 0 for no claim.

        What is known for good counts, after a search all that follows from what was told.
        """
        self._session.close()
        self._control.cleanup()
        claims = [one.symbol for one in self._control.symbolic_atoms.by_signature(*STEPS) if one.is_fact]
        return max((steps_claimed(claim, self.snapshot.step) for claim in claims), default=0)

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

    # ---- Growing -----------------------------------------------------------------------------------------------------

    def grow_to(self, last: int) -> None:
        """Ground the steps up to ``last`` at once, with what falls due there; raises as building does."""
        self._ground_to(last)
        waiting, self.waiting = self.waiting, []
        for told in waiting:
            assert told.statement.head is not None
            if self.definitions.is_open(told.statement.head, told.update):
                self._add(told)
            else:
                self.waiting.append(told)
        self._put_in_force(self.snapshot.with_horizon(last, self.program).items[len(self.snapshot.items) :])

    @property
    def _is_complete(self) -> bool:
        """Whether further steps leave what is ground as it is: if it has no answer, they bring none."""
        defined = self.program.defines_externals and not self.program.steps_apart
        return not (self.definitions.awaited or self._ends.coming or defined)

    # ---- Questions ---------------------------------------------------------------------------------------------------

    def ask(self, question: Question, stopped: Stop) -> Reply:
        """Search for the answer; the reply is unknown if ``stopped`` or ``question.until`` came first."""
        self._actions.forbid_late()
        until = question.until
        ended = stopped if until is None else (lambda: stopped() or until())
        lacking = self._lacking(question.lacking)
        kept = {one.symbol: one.literal for one in self._named(question.kept)}
        claim = self._claim() if question.believes else None
        blameable = [*self._assumables.assumptions(question.disabled), *([] if claim is None else [-claim])]
        blameable += kept.values()
        horizon = self._ends.range(question.first, question.last)
        self._session.close()
        assumed: List[Any] = [*blameable, *horizon, *question.given]  # clasp blames the first
        blames = bool(blameable) and question.blames
        limits = Limits(question.models, question.conflicts, question.best, question.advised)
        answers = _Answers(question)
        this = proxy(self)  # since the control keeps the function, which must not keep the control
        with self._refusing():
            if question.brief:
                result = self._clasp.run_in_place(limits, assumed, lambda model: this._keep(model, answers))
                core: List[int] = []
            else:
                result, core = self._clasp.run(
                    limits, assumed, lambda model: this._keep(model, answers), ended, blames=blames
                )
        for literal in lacking:
            self._session.release(literal)
        if (result.interrupted or result.unknown) and (question.proven or not answers.found):
            return UNKNOWN
        if result.satisfiable or answers.found:
            return answers.reply()
        if self.is_conflicting:
            lasts = all(
                one.lifetime == FOREVER for one in self.snapshot.timed_statements
            )  # else it may lapse with a statement
            return Reply(False, hopeless=True, permanent=lasts)
        if not blames:
            return Reply(False)
        blame = set(core)
        timeless = not question.given and not lacking and blame.isdisjoint(horizon)
        facts = self._assumables.among(blame)
        blamed = frozenset(one for one, literal in kept.items() if literal in blame)
        return Reply(False, core=facts, blamed=blamed, hopeless=timeless and self._is_complete)

    def _keep(self, model: clingo.Model, answers: "_Answers") -> None:
        """Take a model for an answer; if there is something to optimize, one that is proven best or will do."""
        question = answers.question
        if question.best and question.proven and model.cost and not model.optimality_proven:
            return
        if question.shows or self.shown is None:
            self.shown = frozenset(model.symbols(shown=True)) - self._hidden
        answers.found.append(self.shown | self._retired)
        answers.horizon = self._ends.horizon_of(model, question.first, question.last)
        answers.read.append(tuple(one(model) for one in question.reads))
        if self._return_rules is not None:
            answers.predicted = self._predict(model, self._return_rules)
        differ = [one.literal for one in self._named(question.differ)]
        if differ and question.models != 1:
            model.context.add_clause([-one if model.is_true(one) else one for one in differ])

    def _named(self, atoms: Iterable[clingo.Symbol]) -> Iterator[clingo.SymbolicAtom]:
        """Yield what clingo knows of those of the ``atoms`` that it knows."""
        return (one for one in map(self._control.symbolic_atoms.__getitem__, atoms) if one is not None)

    def _lacking(self, atoms: Sequence[clingo.Symbol]) -> List[int]:
        """Have at least one of the ``atoms`` be false, until the literals that are returned are released."""
        if not atoms:
            return []
        guard = self._session.new_external(HOLDS)
        self._session.backend.add_rule([], [guard, *(one.literal for one in self._named(atoms))])
        return [guard]

    def _claim(self) -> Optional[int]:
        """Return the literal of the program's claim that there is no plan; None if it can't be true.

        It may be wrong if something was told of a later step.
        """
        if STEPS not in self.program.head_signatures or self.snapshot.mentions_later_steps(self.program):
            return None
        known = self._control.symbolic_atoms[no_plan_from(self.snapshot.step)]
        return (known.literal or None) if known is not None else None

    def _predict(self, model: clingo.Model, rules: ReturnRules) -> Predicted:
        """Return what is predicted of a model whose shown atoms are known."""

        def is_true(atom: clingo.Symbol) -> Optional[bool]:
            known = self._control.symbolic_atoms[atom]
            return model.is_true(known.literal) if known is not None and known.literal else None

        def may_be_told(atom: clingo.Symbol) -> bool:
            return not self.definitions.is_asked(atom) and self.definitions.is_open(atom)

        return predict(self._actions.among(self.shown or ()), rules, may_be_told, is_true)


class _Answers:
    """The answers to a question.

    Attributes:
        question: the question.
        found: the shown atoms of each answer.
        horizon: that of the last answer.
        predicted: what is predicted of it.
        read: what was read of each answer.

    """

    def __init__(self, question: Question) -> None:
        self.question = question
        self.found: List[FrozenSet[clingo.Symbol]] = []
        self.horizon = question.last
        self.predicted = Predicted()
        self.read: List[Tuple[FrozenSet[clingo.Symbol], ...]] = []

    def reply(self) -> Reply:
        """Return the reply that there are these."""
        answers = self.found if self.question.proven else self.found[-1:]
        return Reply(True, tuple(answers), self.horizon, predicted=self.predicted, read=tuple(self.read))


def pieces(first: int, end: int, size: int, keep_from: int) -> Iterator[int]:
    """Yield the last steps of the pieces from ``first`` to ``end``; one ends where steps may be retired."""
    while first <= end:
        last = min(first + size - 1, end)
        if first < keep_from <= last:
            last = keep_from - 1
        yield last
        first = last + 1


def _closes_loops(program: ReactiveProgram, snapshot: Snapshot) -> bool:
    """Whether a statement closes a positive loop."""
    rules = [one for one in snapshot.statements if one.head is not None and one.body]
    dependencies = program.dependencies.copy() if rules else program.dependencies
    for one in rules:
        heads, bodies = statement_edges(one)
        if any(dependencies.reaches(head, bodies) for head in heads):
            return True
        dependencies.add(heads, bodies)
    return False


def _unused_facts(program: ReactiveProgram, snapshot: Snapshot) -> Iterator[str]:
    """Yield, once for each predicate, what to tell of facts of the last update that nothing has any use for."""
    known = set(program.open_signatures)
    for statement, _, number in snapshot.timed_statements:
        if statement.head is None or signature_of(statement.head) in known:
            continue
        known.add(signature_of(statement.head))
        if number == snapshot.number and not statement.body:
            text = unused_fact(program, statement.head, snapshot.statements)
            yield from [] if text is None else [text]
