"""The program of a snapshot, grounded in one :class:`clingo.Control`, and searches in it.

A grounding never changes, except that its horizon grows. It can be dropped and rebuilt at any time.
"""

from typing import (
    Any,
    Callable,
    FrozenSet,
    Iterable,
    Iterator,
    List,
    Mapping,
    Optional,
    Sequence,
    Set,
    Tuple,
)
from weakref import proxy

import clingo
from clingo.propagator import Propagator

from rosoclingo.oclingo.errors import StoppedError
from rosoclingo.oclingo.program.action_rules import RUNNING, STEPS, no_plan_from, steps_claimed
from rosoclingo.oclingo.program.parts import GUARD
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.update_reader import with_their_failures
from rosoclingo.oclingo.progression.lifetimes import FOREVER
from rosoclingo.oclingo.progression.terms import signature_of
from rosoclingo.oclingo.progression.updates import Statement, commitment
from rosoclingo.oclingo.solving.clasp_search import SearchLimits
from rosoclingo.oclingo.solving.cycles import ActionIndex
from rosoclingo.oclingo.solving.definitions import HOLDS
from rosoclingo.oclingo.solving.results import NOT_EXTERNAL, refusing, unused_facts
from rosoclingo.oclingo.solving.stepwise_grounding import Parts, StepwiseGrounding
from rosoclingo.oclingo.solving.stream_state import ClosedHeads, ForgottenSteps, StateItem, TimedStatement
from rosoclingo.planning.assumables import Assumables
from rosoclingo.planning.horizons import HorizonLiterals
from rosoclingo.planning.prediction import PredictedReturns, predict
from rosoclingo.planning.question import UNKNOWN, Question, Reply, Stop, never
from rosoclingo.planning.return_rules import ReturnRules, return_rules
from rosoclingo.planning.snapshot import Past, Snapshot

PIECE = 64
"""Greatest number of steps that are grounded in one call of clingo."""

PIECE_ATOMS = 50_000
"""Number of atoms to ground in one call of clingo, which no stop can interrupt."""

CLOSED_PIECE = 4
"""Number of steps with closed cycles that are grounded in one call of clingo."""

PAST: Tuple[str, List[str]] = ("__oclingo_past", [])
"""Name and parameters of the program part with the facts of compacted steps."""

FOLLOWING = 8
"""Number of steps after the present one in which updates about running actions need no regrounding.

In these steps, each action has an external and all that depends on it, so searches with more of them take longer.
"""

RUNNING_ACTIONS = "#external _running(A,P,t) : _action_lib(A,P,t), t <= {}."
"""Externals for the actions that can go on until a step."""

_TOO_LATE = "Head {} comes too late: steps before {} are compacted. The entire rule will be ignored."


class Grounding(StepwiseGrounding):
    """A grounding of a snapshot, which can be searched for any horizon up to the last grounded step.

    Attributes:
        snapshot: the snapshot it was built from.
        warnings: warnings about ignored statements of the snapshot's last update.
        past: the compacted steps.
        shown: the shown atoms of the last answer, None before the first answer.
        statements: the statements that were added.
        is_cyclic: whether a statement closes a positive loop. clingo detects loops only among rules that are added
            together.
        grows: whether the grounding can grow after a search: it is not cyclic, and no later step can define an atom
            that an earlier step or a statement defines.

    """

    def __init__(
        self,
        program: ReactiveProgram,
        snapshot: Snapshot,
        horizon: int,
        assumable: FrozenSet[clingo.Symbol] = frozenset(),
        stopped: Stop = never,
        predicts: bool = False,
        settles: bool = True,
    ) -> None:
        """Ground ``program`` up to ``horizon``; raises SolverError if clingo rejects it, and StoppedError.

        Args:
            program: the reactive logic program.
            snapshot: the snapshot of the history.
            horizon: the last step to ground.
            assumable: the facts that a question can disable.
            stopped: called between two pieces of steps; if it returns true, StoppedError is raised.
            predicts: whether replies contain predicted returns.
            settles: whether facts of closed cycles that the snapshot lacks are false in this grounding. Otherwise, only
                those of steps that are over.

        """
        super().__init__(program)
        self.snapshot = snapshot
        self.is_cyclic = snapshot.closes_loops(program)
        defined = program.head_signatures.intersection(map(signature_of, snapshot.heads))
        self.grows = program.heads_apart and not self.is_cyclic and not defined
        self.past = snapshot.past or Past(program.first_step, frozenset())
        self.horizon = self.past.first - 1
        self.warnings = [*snapshot.warnings, *unused_facts(program, snapshot)]
        self.shown: Optional[FrozenSet[clingo.Symbol]] = None
        self.statements: List[TimedStatement] = []
        self._settles, self._compacted = settles, frozenset(atom for _, atom in self.past.shown)
        self._return_rules = return_rules(program) if predicts else None
        self._asserted: FrozenSet[clingo.Symbol] = frozenset()
        self._early: Set[TimedStatement] = set()  # the items that were added before the others
        self._assumables = Assumables(self._session, assumable)
        self._actions = ActionIndex(self._control, self._session, program.first_step, self._assumables.literals)
        self._ends = HorizonLiterals(self._control, self._session, self.horizon)
        self._clasp = self._load([] if self._return_rules is None else self._return_parts(self._return_rules))
        self._build(horizon, stopped)

    # ---- Building ----------------------------------------------------------------------------------------------------

    def _return_parts(self, rules: ReturnRules) -> List[Tuple[str, List[str], str]]:
        """Return the program parts with the rules for predicted returns."""
        running, last = RUNNING in self.program.open_signatures, self.snapshot.step + FOLLOWING
        return [*rules.texts, *([("cumulative", ["t"], RUNNING_ACTIONS.format(last))] if running else [])]

    def _build(self, horizon: int, stopped: Stop) -> None:
        """Ground base and the steps up to ``horizon``, and add the snapshot's statements."""
        snapshot = self.snapshot
        opened = [one for one in self._new_open(snapshot) if not snapshot.is_too_late(self.program, one)]
        facts = snapshot.permanent_facts(self.assumable)
        self.open_facts = {one: facts[one] for one in opened if one in facts}
        self._open(opened)
        self._ground_base()
        base_atoms = len(self._control.symbolic_atoms)
        self._add_past(self.past.facts)
        self._ground_closed(horizon)
        self._step_atoms = base_atoms  # an estimate, until an open step is grounded
        for last in pieces(self.horizon + 1, horizon, self.piece, stopped, snapshot.keep_from):
            self.ground_to(last)
        for cycle, executed in snapshot.closed.items():
            self._actions.close_cycle(cycle, executed)
        self._add_items(snapshot.items)
        self._ends.settle(min(snapshot.min_horizon, self.horizon))

    def _add_past(self, facts: Iterable[clingo.Symbol]) -> None:
        """Add the ``facts`` of compacted steps."""
        assumable = [atom for atom in facts if atom in self._assumables.literals]
        text = "".join(f"#external {atom}.\n" if atom in assumable else f"{atom}.\n" for atom in facts)
        if text:
            self._control.add(*PAST, text)
            self._ground([(PAST[0], [])], range(self.past.first - 1, self.past.first))
        for atom in assumable:
            self._add(TimedStatement(Statement(atom), FOREVER, 0))

    def _ground(self, parts: Parts, steps: range) -> None:
        super()._ground(parts, steps)
        self._ends.expire()

    def ground_to(self, last: int) -> None:
        """Ground the steps up to ``last`` in one call."""
        steps, atoms = last - self.horizon, len(self._control.symbolic_atoms)
        super().ground_to(last)
        self._step_atoms = (len(self._control.symbolic_atoms) - atoms) // steps
        self._ends.link(last)

    def _limit(self, guard: int, first: int, last: int) -> None:
        self._ends.define_window(guard, first, last)

    def _ground_closed(self, horizon: int) -> None:
        """Ground the steps of closed cycles together with their actions and facts.

        With known actions and facts, these steps are small: most of their atoms are facts or false. No stop ends this.
        """
        snapshot, first = self.snapshot, self.horizon + 1
        if not self.grows or any(isinstance(one, ForgottenSteps) for one in snapshot.items):
            return  # forgotten steps ignore some facts
        committed = {one.body[0].atom for one in snapshot.permanent if one.is_commitment} - self.assumable
        facts, kept = snapshot.permanent_facts(self.assumable), self._undecided_heads()
        end = min(horizon, snapshot.closed_until(first))
        for last in pieces(first, end, lambda: CLOSED_PIECE, never, snapshot.keep_from):
            steps = range(self.horizon + 1, last + 1)
            self.ground_to(last)
            for cycle in steps:
                self._actions.close_cycle(cycle, snapshot.closed[cycle])
                for action in sorted(committed & snapshot.closed[cycle]):
                    self.definitions.add(TimedStatement(commitment(action), FOREVER, 0))
            is_over = last < snapshot.keep_from
            for atom in self._externals.between(steps[0], last, base=False) if is_over or self._settles else ():
                if atom not in kept and atom.name != GUARD and self.definitions.is_undefined(atom):
                    self._settle(atom, facts, is_over)
            self.simplify()

    def _undecided_heads(self) -> Set[clingo.Symbol]:
        """Return the atoms that other items than permanent facts concern, and the assumable facts."""
        timed = self.snapshot.timed_statements
        heads = {one.statement.head for one in timed if one.statement.body or one.lifetime != FOREVER}
        closed = (one.atoms for one in self.snapshot.items if isinstance(one, ClosedHeads))
        return {one for one in heads if one is not None}.union(with_their_failures(self.assumable), *closed)

    def _settle(self, atom: clingo.Symbol, facts: Mapping[clingo.Symbol, int], is_over: bool) -> None:
        """Add an external of a closed cycle as a fact if it is among ``facts``; otherwise it is false.

        It stays false for later updates as well if its step ``is_over``.
        """
        if atom in facts:
            entry = TimedStatement(Statement(atom), FOREVER, facts[atom])
            self._early.add(entry)
            self._add(entry)
        else:
            self.definitions.close(atom, *([] if is_over else [self.snapshot.number]))

    # ---- Statements --------------------------------------------------------------------------------------------------

    def _add_items(self, items: Iterable[StateItem]) -> None:
        """Apply ``items`` of the snapshot; warn about ignored statements of its last update."""
        for entry in self._apply(one for one in items if one not in self._early):
            head = entry.statement.head
            if entry.update != self.snapshot.number or head is None or head in self.open_facts:
                continue
            late = self.snapshot.is_too_late(self.program, head)
            self.warnings.append(_TOO_LATE.format(head, self.past.first) if late else NOT_EXTERNAL.format(head))

    def _add(self, entry: TimedStatement) -> None:
        self.statements.append(entry)
        subject = entry.statement.subject
        assumed = None if subject is None else self._assumables.literals.get(subject)
        guards = [] if assumed is None else [assumed]
        if isinstance(entry.lifetime, int):
            guards.append(self._ends.beyond(entry.lifetime + 1))
        self.definitions.add(entry, guards, assumed is not None)

    # ---- Inspection --------------------------------------------------------------------------------------------------

    @property
    def possible_atoms(self) -> List[clingo.Symbol]:
        """All atoms that can be true; atoms that clingo has simplified away are false."""
        self._session.close()
        self._control.cleanup()
        return [one.symbol for one in self._control.symbolic_atoms]

    @property
    def assumable(self) -> FrozenSet[clingo.Symbol]:
        """The facts that a question can disable."""
        return self._assumables.facts

    def actions(self, first: int, last: int) -> List[clingo.Symbol]:
        """Return the ``_action_lib`` atoms of the cycles ``first`` to ``last`` that are not closed."""
        return self._actions.between(first, last)

    def claimed_steps(self) -> int:
        """Return the lower bound that the program claims for the length of a plan; 0 for no claim.

        Only facts count; each search can turn more claims into facts.
        """
        self._session.close()
        self._control.cleanup()
        claims = [one.symbol for one in self._control.symbolic_atoms.by_signature(*STEPS) if one.is_fact]
        return max((steps_claimed(claim, self.snapshot.step) for claim in claims), default=0)

    def inspect(self, propagator: Propagator) -> None:
        """Call ``propagator.init`` on the present program, without a search."""
        self._control.register_propagator(propagator)
        self._actions.forbid_late()
        self.simplify()

    def simplify(self) -> None:
        """Have clasp propagate top-level consequences, which simplify the steps that are grounded later."""
        external = self._session.new_external()
        self._session.close()
        self._control.solve(assumptions=[external, -external])  # contradictory: ends at once
        self._session.release(external)

    # ---- Growing -----------------------------------------------------------------------------------------------------

    def piece(self) -> int:
        """Return the number of steps to ground in the next call of clingo, if they are as large as the last one."""
        return min(PIECE, max(1, PIECE_ATOMS // max(1, self._step_atoms)))

    def grow_to(self, last: int) -> None:
        """Ground the steps up to ``last``, and add deferred statements; raises like the constructor."""
        self.ground_to(last)
        self._accept_deferred()
        self._add_items(self.snapshot.with_horizon(last, self.program).items[len(self.snapshot.items) :])

    @property
    def _is_complete(self) -> bool:
        """Whether further steps cannot change the grounded steps: if these are unsatisfiable, every horizon is."""
        defined = self.program.defines_externals and not self.program.steps_apart
        return not (self.definitions.absent or self._ends.coming or defined)

    # ---- Questions ---------------------------------------------------------------------------------------------------

    def ask(self, question: Question, stopped: Stop) -> Reply:
        """Search for answers; the reply is unknown if ``stopped`` ends the search."""
        self._actions.forbid_late()
        lacking = self._lacking(question.lacking)
        kept = {one.symbol: one.literal for one in self._atoms(question.kept)}
        claim = self._claim() if question.believes else None
        blameable = [*self._assumables.assumptions(question.disabled), *([] if claim is None else [-claim])]
        blameable += kept.values()
        horizon = self._ends.range(question.first, question.last)
        self._session.close()
        for fact in question.asserted ^ self._asserted:
            self._control.assign_external(fact, fact in question.asserted)
        self._asserted = question.asserted
        assumed: List[Any] = [*blameable, *horizon, *question.given]  # clasp prefers the first ones in cores
        limits = SearchLimits(question.models, question.conflicts, question.best, question.advised)
        answers: List[Reply] = []
        this = proxy(self)  # the control holds the callback; a reference cycle would delay its release
        with refusing(self.messages, self.program):
            result, core = self._clasp.run(
                limits, assumed, lambda model: this._keep(model, question, answers), stopped, bool(blameable)
            )
        for literal in lacking:
            self._session.release(literal)
        if (result.interrupted or result.unknown) and (question.proven or not answers):
            return UNKNOWN
        if result.satisfiable or answers:
            counted = answers if question.proven else answers[-1:]
            shown, atoms = tuple(one.answers[0] for one in counted), tuple(one.atoms[0] for one in counted)
            return answers[-1]._replace(answers=shown, atoms=atoms)
        if self.is_conflicting:
            # A statement that lapses could end the conflict.
            lasts = all(one.lifetime == FOREVER for one in self.snapshot.timed_statements)
            return Reply(False, hopeless=True, permanent=lasts)
        if not blameable:
            return Reply(False)
        blame = set(core)
        timeless = not question.given and not lacking and blame.isdisjoint(horizon)
        facts = self._assumables.among(blame).union(one for one, literal in kept.items() if literal in blame)
        return Reply(False, core=facts, hopeless=timeless and self._is_complete)

    def _keep(self, model: clingo.Model, question: Question, answers: List[Reply]) -> None:
        """Record a model as an answer; models that are not proven optimal only if the question accepts them."""
        if question.best and question.proven and model.cost and not model.optimality_proven:
            return
        if question.shows or self.shown is None:
            self.shown = frozenset(model.symbols(shown=True)) - self._hidden
        horizon = self._ends.horizon_of(model, question.first, question.last)
        predicted = PredictedReturns() if self._return_rules is None else self._predict(model, self._return_rules)
        atoms = frozenset(model.symbols(atoms=True) if question.whole else ())
        cost, optimal = tuple(model.cost), bool(model.optimality_proven)
        shown = self.shown | self._compacted
        answers.append(Reply(True, (shown,), horizon, cost, optimal, predicted=predicted, atoms=(atoms,)))
        differ = [one.literal for one in self._atoms(question.differ)]
        if differ and question.models != 1:
            model.context.add_clause([-one if model.is_true(one) else one for one in differ])

    def _atoms(self, atoms: Iterable[clingo.Symbol]) -> Iterator[clingo.SymbolicAtom]:
        """Yield clingo's entries of those ``atoms`` that occur in the grounding."""
        return (one for one in map(self._control.symbolic_atoms.__getitem__, atoms) if one is not None)

    def _lacking(self, atoms: Sequence[clingo.Symbol]) -> List[int]:
        """Require one of the ``atoms`` to be false until the returned literals are released."""
        if not atoms:
            return []
        guard = self._session.new_external(HOLDS)
        self._session.backend.add_rule([], [guard, *(one.literal for one in self._atoms(atoms))])
        return [guard]

    def _claim(self) -> Optional[int]:
        """Return the literal of the program's claim that there is no plan; None if it cannot be true.

        The claim does not hold if facts of later steps were asserted.
        """
        if STEPS not in self.program.head_signatures or self.snapshot.mentions_later_steps(self.program):
            return None
        known = self._control.symbolic_atoms[no_plan_from(self.snapshot.step)]
        return (known.literal or None) if known is not None else None

    def _predict(self, model: clingo.Model, rules: ReturnRules) -> PredictedReturns:
        """Return the predicted returns of a model; :attr:`shown` holds its atoms."""

        def is_true(atom: clingo.Symbol) -> Optional[bool]:
            known = self._control.symbolic_atoms[atom]
            return model.is_true(known.literal) if known is not None and known.literal else None

        def can_arrive(atom: clingo.Symbol) -> bool:
            return not self.definitions.is_in_body(atom) and self.definitions.is_open(atom)

        return predict(self._actions.among(self.shown or ()), rules, can_arrive, is_true)


def pieces(first: int, end: int, size: Callable[[], int], stopped: Stop, keep_from: int = 0) -> Iterator[int]:
    """Yield the last step of each piece of ``first`` to ``end``; one piece ends before ``keep_from``.

    Raises StoppedError between two pieces if ``stopped`` returns true.
    """
    begin = first
    while first <= end:
        if first > begin and stopped():
            raise StoppedError
        last = min(first + size() - 1, end)
        if first < keep_from <= last:
            last = keep_from - 1
        yield last
        first = last + 1
