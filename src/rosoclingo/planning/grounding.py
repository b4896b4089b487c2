"""A snapshot's program, ground in one :class:`clingo.Control` and asked questions.

A grounding is never changed, except that its horizon grows; it can be dropped and built again at any time.
"""

from contextlib import contextmanager
from typing import Any, Collection, Dict, FrozenSet, Iterable, Iterator, List, Optional, Sequence, Set, Tuple
from weakref import proxy

import clingo
from clingo.propagator import Propagator

from rosoclingo.oclingo.errors import DroppedError, SolverError
from rosoclingo.oclingo.program.action_rules import ACTION, RETURN, STEPS, no_plan_from, steps_claimed
from rosoclingo.oclingo.program.clingo_messages import Messages
from rosoclingo.oclingo.program.lint.likeness import asked, likely
from rosoclingo.oclingo.program.parts import GUARD
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.return_rules import ReturnRules
from rosoclingo.oclingo.program.signatures import statement_edges
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.strings import holds_string_apart
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import Statement, commitment
from rosoclingo.oclingo.solving.atom_index import ExternalIndex
from rosoclingo.oclingo.solving.atom_table import HOLDS, BackendSession, Externals, Heads
from rosoclingo.oclingo.solving.clasp_search import ClaspSearch, Limits
from rosoclingo.oclingo.solving.cycles import ActionIndex, CycleIndex
from rosoclingo.oclingo.solving.results import refusal
from rosoclingo.planning.assumables import Assumables
from rosoclingo.planning.definitions import Definitions
from rosoclingo.planning.horizons import HorizonLiterals
from rosoclingo.planning.prediction import Predicted, predict
from rosoclingo.planning.question import UNKNOWN, Question, Reply, Stop
from rosoclingo.planning.snapshot import NOT_EXTERNAL, ClosedHeads, Forgotten, Past, Snapshot, Told

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

_STRANGE = "No rule and no #external of the program mentions {}: it takes it, but nothing depends on it{}."
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
        names: the literals of the atoms that base has; clingo drops the names of those that are false for good.
        shown: the shown atoms of the last answer.
        definitions: the statements that define their heads.
        in_force: the statements that are.
        waiting: statements whose heads only steps to come declare.
        false: externals that nothing will define any more.
        satisfied: whether there was an answer.
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
        self.is_cyclic = self._closes_loops()
        self._control = clingo.Control(program.arguments(), logger=self.messages.log)
        self._session = BackendSession(self._control)
        self._observer, self._heads = Externals(), Heads()
        self.ground_parts: List[Tuple[range, Parts]] = []
        self._pieces: Dict[int, range] = {}  # by their first step
        self._externals = ExternalIndex(self._control, program, self._pieces)
        self.definitions = Definitions(self._control, self._session, self._externals.declared, self._heads.externals)
        self._assumables = Assumables(self._session, assumable)
        self._actions = ActionIndex(self._control, self._session, ACTION, program.first_step, self._assumables.literals)
        self._returns = CycleIndex(self._control, RETURN)
        self._return_rules = program.return_rules if predicts else None
        for observer in (self._observer, self._heads) if program.defines_externals else (self._observer,):
            self._control.register_observer(observer)
        with self._refusing():
            program.load_into(self._control, predicts)
        self._clasp = ClaspSearch(self._control, program)
        self._hidden: Set[clingo.Symbol] = set()
        self.waiting, self.in_force = [], []  # type: List[Told], List[Told]
        self.false: Set[clingo.Symbol] = set()
        self._dropped, self._whole, self.satisfied = dropped, whole, False
        self.shown: FrozenSet[clingo.Symbol] = frozenset()
        self.warnings: List[str] = list(snapshot.odd)
        self.past = snapshot.past or Past(program.first_step, frozenset())
        self._retired = frozenset(atom for _, atom in self.past.shown)
        self.horizon = self.past.first - 1
        self._ends = HorizonLiterals(self._control, self._session, self.horizon)
        self._given: Set[clingo.Symbol] = set()  # facts of open signatures
        self.names: Dict[clingo.Symbol, int] = {}
        self._before_steps = 0  # atoms that are no step's
        self._build(horizon)

    # ---- Building ----------------------------------------------------------------------------------------------------

    def _build(self, horizon: int) -> None:
        """Ground base and the steps up to ``horizon``, and put in force what the snapshot holds."""
        self._given = self._declare_open()
        self._ground([("base", [])], 1, BASE)
        self.names = {one.symbol: one.literal for one in self._control.symbolic_atoms}
        self._externals.end_base()
        self._tell(self.past.facts)
        self._before_steps = len(self._control.symbolic_atoms)
        said = self._ground_closed(min(horizon, self._last_known))
        size = PIECE if not self._whole else max(PIECE, horizon)
        for last in pieces(self.horizon + 1, horizon, size, self.snapshot.keep_from):
            self._ground_to(last)
        self._put_in_force(said)
        self._ends.settle(min(self.snapshot.settled, self.horizon))

    def _declare_open(self) -> Set[clingo.Symbol]:
        """Make the heads of open signatures known: as facts, which are returned, or as externals."""
        heads = dict.fromkeys(one.head for one in self.snapshot.statements if one.head is not None)
        opened = [
            head
            for head in heads
            if self.program.is_open_signature(head) and not self.snapshot.is_too_late(self.program, head)
        ]
        facts = self.snapshot.facts_without(self._assumables.facts)
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
            self.definitions.add(Told(Statement(atom), FOREVER, 0), [self._assumables.literals[atom]], True)

    def _ground(self, parts: Parts, step: int, steps: range = range(0)) -> None:
        self._session.close()
        with self._refusing():
            self._control.ground(parts)
        self.ground_parts.append((steps, parts))
        self._literals: Dict[clingo.Symbol, int] = {}  # of what was looked up since, 0 if no rule defines it
        self._externals.note(self._observer.fresh, step)
        self._observer.fresh.clear()
        self._heads.sort(self._externals.declared)
        self._returns.expire()
        self._actions.expire()
        self._ends.expire()

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
        for step in steps:
            self._bound(step)
        self._ends.link(last)
        self.definitions.resolve_absent()

    def _bound(self, step: int) -> None:
        """Tie the volatile rules of ``step`` to the horizon."""
        for window in self.program.windows:
            guard = self._control.symbolic_atoms[self.program.guard(window, step)]
            if guard is not None and window > 0:
                self._ends.define_window(guard.literal, step, window)
                self._hidden.add(guard.symbol)

    @property
    def _last_known(self) -> int:
        """Return the last step before which all actions are known."""
        first = self.horizon + 1
        known = self.program.heads_apart and not self.assumable and not self.is_cyclic
        return self.snapshot.closed_until(first) if known else self.horizon

    def _ground_closed(self, known: int) -> Set[Statement]:
        """Ground the steps up to ``known``, whose cycles are closed, with their actions; return the commitments used.

        Else a robot might be anywhere in each of them, and they would cost as much as the steps to come.
        """
        permanent, said = set(self.snapshot.permanent), set()  # type: Set[Statement], Set[Statement]
        first = self.horizon + 1
        for last in pieces(first, known, CLOSED_PIECE, self.snapshot.keep_from):
            self._ground_to(last)
            if not self.is_conflicting:
                for cycle in range(first, last + 1):
                    executed = self.snapshot.closed[cycle]
                    self._actions.close_cycle(cycle, executed)
                    for one in filter(permanent.__contains__, map(commitment, sorted(executed))):
                        self.definitions.add(Told(one, FOREVER, 0), ())
                        said.add(one)
                self.simplify()
            first = last + 1
        return said

    def _put_in_force(self, said: Set[Statement]) -> None:
        """Add what the snapshot holds, except for commitments that were ``said``; nothing is searched before."""
        snapshot = self.snapshot
        for cycle, executed in snapshot.closed.items():
            self._actions.close_cycle(cycle, executed)
        for one in snapshot.told:
            if isinstance(one, Forgotten):
                self.forget(one.first, one.last, spared=one.spared)
            elif isinstance(one, ClosedHeads):
                for atom in one.atoms:
                    self.definitions.close(atom)
                self.false |= one.atoms
            elif one.lifetime == FOREVER and one.statement in said:
                self.in_force.append(one)
            else:
                self._take(one)
        for cycle in sorted(snapshot.closed.keys() - snapshot.returning):
            for atom, _ in self._returns.pop_cycle(cycle):
                if self.definitions.is_open(atom) and atom not in self.definitions.lapsing:
                    self.definitions.close(atom)

    def forget(self, first: int, last: int, base: bool = True, spared: Collection[clingo.Symbol] = ()) -> None:
        """Let what steps ``first`` to ``last`` declare external and nothing defines be false (``base`` counts as 1).

        Not so the ``spared`` atoms.
        """
        for atom in self.declared_between(first, last, base):
            if atom not in self.definitions.lapsing and atom not in spared and atom.name != GUARD:
                self.definitions.close(atom)
                self.false.add(atom)

    # ---- Statements --------------------------------------------------------------------------------------------------

    def _take(self, told: Told) -> None:
        """Put a statement in force if it may define its head, have it wait for its step, or ignore it."""
        statement, known, head = told.statement, self.definitions, told.statement.head
        is_new = told.update == self.snapshot.number
        if head is None or (head not in self._given and known.is_open(head, told.update)):
            self._add(told)
        elif head in self._given:  # it is known as a fact, which says more
            if not statement.body and told.lifetime == FOREVER:
                self.in_force.append(told)
        elif self._is_strange(head):
            self._add(told)
            if is_new:
                self._remark(told)
        elif not statement.body and known.is_true(head):
            return
        elif self.snapshot.is_too_late(self.program, head):
            self._warn(is_new, _TOO_LATE.format(head, self.past.first))
        elif not known.is_closed(head) and not known.knows(head) and self._may_come(head):
            self.waiting.append(told)
        else:
            self._warn(is_new, NOT_EXTERNAL.format(head))

    def _add(self, told: Told) -> None:
        self.in_force.append(told)
        statement, lifetime = told.statement, told.lifetime
        assumed = None if statement.subject is None else self._assumables.literals.get(statement.subject)
        guards = [] if assumed is None else [assumed]
        if isinstance(lifetime, int):
            guards.append(self._ends.beyond(lifetime + 1))
        self.definitions.add(told, guards, assumed is not None)

    def _warn(self, is_new: bool, text: str) -> None:
        if is_new:
            self.warnings.append(text)

    def _may_come(self, atom: clingo.Symbol) -> bool:
        return self.program.may_declare(atom, self.horizon + 1)

    def _is_strange(self, atom: clingo.Symbol) -> bool:
        """Whether the program does not mention ``atom``, so that an update may define it freely."""
        signature = signature_of(atom)
        known = self.program.signatures | self.program.open_signatures
        strange = signature not in known or holds_string_apart(atom)
        return strange and not self.definitions.knows(atom) and not self.definitions.is_closed(atom)

    def _remark(self, told: Told) -> None:
        """Tell, once, of a fact that neither the program nor a statement of the stream has any use for."""
        assert told.statement.head is not None
        signature = signature_of(told.statement.head)
        both = {signature, signature._replace(positive=not signature.positive)}
        if told.statement.body or both & self.program.signatures:
            return
        for one in self.snapshot.entries:
            if one is told:
                break
            if one.statement.head is not None and signature_of(one.statement.head) == signature:
                return  # told before
        if not any(signature_of(one.atom) in both for rule in self.snapshot.statements for one in rule.body):
            meant = asked(likely(signature, self.program.external_signatures))
            self.warnings.append(_STRANGE.format(signature, f" ({meant})" if meant else ""))

    # ---- What it tells -----------------------------------------------------------------------------------------------

    def _closes_loops(self) -> bool:
        """Whether a statement closes a positive loop."""
        rules = [one for one in self.snapshot.statements if one.head is not None and one.body]
        dependencies = self.program.dependencies.copy() if rules else None
        for one in rules:
            assert dependencies is not None
            heads, bodies = statement_edges(one)
            if any(dependencies.reaches(head, bodies) for head in heads):
                return True
            dependencies.add(heads, bodies)
        return False

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
        """How many atoms a step has, on average; at least 1."""
        found, steps = len(self._control.symbolic_atoms) - self._before_steps, self.horizon + 1 - self.past.first
        return max(1, found // max(1, steps))

    @property
    def assumable(self) -> FrozenSet[clingo.Symbol]:
        """The facts of which each question says whether they were told."""
        return self._assumables.facts

    def actions(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the ``_action_lib`` atoms of the cycles first..last that are not closed."""
        return self._actions.between(first, last)

    def declared_between(self, first: int, last: int, base: bool = True) -> List[clingo.Symbol]:
        """Return the open externals that were declared at steps ``first`` to ``last`` (``base`` counts as 1)."""
        return [atom for atom in self._externals.between(first, last, base) if self.definitions.is_open(atom)]

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

    def settle(self) -> None:
        """Say that no question will be about a horizon before the present step."""
        self._ends.settle(self.snapshot.settled)

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
        for one in self.snapshot.searched(last, self.program).told[len(self.snapshot.told) :]:
            if isinstance(one, Forgotten):
                self.forget(one.first, one.last, spared=one.spared)

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
        blameable = [*self._assumables.assumptions(question.untold), *([] if claim is None else [-claim])]
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
        satisfied = bool(result.satisfiable or answers.found)
        self.satisfied = self.satisfied or satisfied
        if (result.interrupted or result.unknown) and (question.proven or not answers.found):
            return UNKNOWN
        if satisfied:
            return answers.reply()
        if self.is_conflicting:
            lasts = all(one.lifetime == FOREVER for one in self.snapshot.entries)  # else it may lapse with a statement
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
        if question.shows:
            self.shown = frozenset(model.symbols(shown=True)) - self._hidden - self._ends.names
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
        if STEPS not in self.program.head_signatures or self.snapshot.tells_of_later(self.program):
            return None
        known = self._control.symbolic_atoms[no_plan_from(self.snapshot.step)]
        return (known.literal or None) if known is not None else None

    def _predict(self, model: clingo.Model, rules: ReturnRules) -> Predicted:
        """Return what is predicted of a model whose shown atoms are known."""
        literals = self._literals

        def is_true(atom: clingo.Symbol) -> Optional[bool]:
            if atom not in literals:
                known = self._control.symbolic_atoms[atom]
                literals[atom] = 0 if known is None else known.literal
            return model.is_true(literals[atom]) if literals[atom] else None

        def may_be_told(atom: clingo.Symbol) -> bool:
            return not self.definitions.is_asked(atom) and self.definitions.is_open(atom)

        return predict(self._actions.among(self.shown), rules, may_be_told, is_true)


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
