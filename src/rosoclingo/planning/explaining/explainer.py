"""Computes explanations why there is no plan.

An explanation has the fewest rules that exclude a plan, the facts that they depend on, and the steps of the conflict.
On one grounding, assumptions relax constraints (see :mod:`~rosoclingo.planning.explaining.relaxed_program`) and facts
of the stream (see :mod:`~rosoclingo.planning.strategies.probe`). Unsat cores reduce later questions. To relax a fact of
the program, the program has to be regrounded, so these facts come last.
"""

from typing import Callable, Dict, FrozenSet, Iterable, List, Optional, Sequence, Tuple, TypeVar

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.induction import excludes_longer_plans
from rosoclingo.planning.explaining.named_rules import RuleKind
from rosoclingo.planning.explaining.near_miss import never_true
from rosoclingo.planning.explaining.questions import Questions, Stream
from rosoclingo.planning.explaining.reach import Reach, UncertainError
from rosoclingo.planning.explaining.relaxed_program import KEEP, WHOLE, RelaxedProgram
from rosoclingo.planning.explaining.why_not import BlamedFact, BlamedRule, BrokenPlan, WhyNot
from rosoclingo.planning.history import Plan
from rosoclingo.planning.idling import may_idle
from rosoclingo.planning.minimal_sets import (
    Mus,
    Oracle,
    UndecidedError,
    Witness,
    find_mus,
    find_smallest_mus,
    grow,
    remember,
    yes_or_no,
)
from rosoclingo.planning.question import Reply, Stop

T = TypeVar("T")
Rules = FrozenSet[int]
Blamed = Tuple[Tuple[T, Optional[bool]], ...]
"""Facts without which there is a plan, and whether they hinder, see :class:`BlamedFact`."""

Relaxations = Dict[int, Tuple[Reply, Rules]]
"""For each of some rules: the shortest plan without it, and the fewest rules to remove along with it."""


def explain(program: ReactiveProgram, stream: Stream, halt: Stop = lambda: False) -> Optional[WhyNot]:
    """Explain why there is no plan; None if there is one.

    After a stop by ``halt`` the explanation is incomplete. Raises SolverError if the stream is rejected, and
    UndecidedError if ``halt`` stops the search for a plan.
    """
    relaxed = RelaxedProgram.of(program)
    questions = Questions(relaxed, stream, may_idle(program, halt), halt)
    return _Explainer(program, relaxed, questions, range(questions.step, questions.step + stream.steps + 1)).run()


class _Explainer:
    """Explains one stream; ``steps`` are the present step and those of plans."""

    def __init__(self, program: ReactiveProgram, relaxed: RelaxedProgram, questions: Questions, steps: range) -> None:
        self._program, self._relaxed, self._questions, self._steps = program, relaxed, questions, steps
        self._all = [rule.number for rule in relaxed.constraints]
        self._complete = True

    def run(self) -> Optional[WhyNot]:
        """Explain why there is no plan; None if there is one."""
        oracle = remember(self._ask_rules, [])
        if oracle(frozenset(self._all)).satisfiable:
            return None
        mus = self._checked(find_smallest_mus(self._all, oracle))
        rules = frozenset(mus.items)
        never: bool = self._in_time(lambda: self._questions.ask(_selectors(rules)).hopeless, False)
        stream_facts: Blamed[clingo.Symbol] = self._in_time(lambda: self._find_stream_facts(rules), ())
        relaxations: Relaxations = {}
        self._in_time(lambda: self._relax_each(rules, oracle, relaxations), None)
        steps: Dict[int, Tuple[int, ...]] = self._in_time(lambda: self._find_steps(mus.items), {})
        program_facts: Blamed[int] = self._in_time(lambda: self._find_program_facts(rules), ())
        rule_of = self._relaxed.rules
        blamed = tuple(self._blamed(number, relaxations, steps.get(number, ())) for number in mus.items)
        ends = [(one.rule, one.breach[1]) for one in blamed if one.rule.kind is RuleKind.VOLATILE and one.breach]
        reach = self._reach() if self._complete else None
        last = self._steps[-1]
        return WhyNot(
            self._steps[0],
            last,
            never or (reach is not None and excludes_longer_plans(self._relaxed, rules, reach, last)),
            blamed,
            tuple(BlamedFact(f"{atom}.", hinders=hinders) for atom, hinders in stream_facts),
            tuple(BlamedFact(rule_of[one].text, rule_of[one], hinders) for one, hinders in program_facts),
            mus.smallest,
            self._complete,
            self._broken_plan(relaxations),
            () if reach is None else never_true(self._program, reach, ends),
        )

    def _reach(self) -> Optional[Reach]:
        try:
            return Reach(self._program, self._questions.known())
        except UncertainError:
            return None

    def _checked(self, mus: Mus[T]) -> Mus[T]:
        """Return ``mus``; mark the explanation as incomplete if it is not minimal."""
        self._complete &= mus.minimal
        return mus

    def _in_time(self, find: Callable[[], T], otherwise: T) -> T:
        """Return the result of ``find``; after a stop, return ``otherwise`` and mark the explanation as incomplete."""
        try:
            return find()
        except UndecidedError:
            self._complete = False
            return otherwise

    # -- rules

    def _ask_rules(self, kept: Rules) -> Witness[int]:
        selectors = _selectors(kept)
        reply = self._questions.ask(selectors)
        if reply.satisfiable:
            broken = {one.number for one in self._relaxed.breaches(reply.answers[-1])}
            return Witness(True, frozenset(self._all) - broken)
        return Witness(False, frozenset(atom.arguments[0].number for atom in reply.core.intersection(selectors)))

    def _relax_each(self, rules: Rules, oracle: Oracle[int], found: Relaxations) -> None:
        """For each rule, find the shortest plan without it that obeys a maximal set of the other rules."""
        for number in sorted(rules):
            possible = frozenset(self._all) - {number}
            if not oracle(possible).satisfiable:
                possible = grow(rules - {number}, self._all, oracle)
            kept = _selectors(possible)
            plan = self._questions.shortest(kept, self._questions.ask(kept))
            found[number] = plan, frozenset(self._all) - possible - {number}

    def _find_steps(self, rules: Iterable[int]) -> Dict[int, Tuple[int, ...]]:
        """Find the steps at which the rules are in conflict, preferring early steps."""
        first = self._program.first_step
        places = [clingo.Function("base"), *map(clingo.Number, range(first, self._steps[-1] + 1))]
        selectors = [clingo.Function(KEEP, [clingo.Number(rule), place]) for place in places for rule in rules]

        def ask(kept: FrozenSet[clingo.Symbol]) -> Witness[clingo.Symbol]:
            """Return whether there is a plan that obeys the rules at the selected steps."""
            reply = self._questions.ask(kept)
            return Witness(bool(reply.satisfiable), kept if reply.satisfiable else reply.core & kept)

        found: Dict[int, List[int]] = {}
        for atom in self._checked(find_mus(selectors, ask)).items:
            rule, place = atom.arguments
            if place.type is clingo.SymbolType.Number:
                found.setdefault(rule.number, []).append(place.number)
        return {rule: tuple(sorted(steps)) for rule, steps in found.items()}

    def _blamed(self, number: int, relaxations: Relaxations, steps: Tuple[int, ...]) -> BlamedRule:
        rules = self._relaxed.rules
        if number not in relaxations:
            return BlamedRule(rules[number], steps)
        plan, besides = relaxations[number]
        breaches = (one for one in self._relaxed.breaches(plan.answers[-1]) if one.number == number)
        breach = next(((one.step, dict(one.values)) for one in breaches), None)
        return BlamedRule(rules[number], steps, tuple(rules[one] for one in sorted(besides)), breach)

    def _broken_plan(self, relaxations: Relaxations) -> Optional[BrokenPlan]:
        """Return a plan that violates the fewest rules, apart from plans that only end too early."""
        rules = self._relaxed.rules
        some = [one for one in relaxations if rules[one].kind is not RuleKind.VOLATILE]
        if not some:
            return None
        best = min(some, key=lambda one: len(relaxations[one][1]))
        plan, besides = relaxations[best]
        broken = tuple(rules[one] for one in (best, *sorted(besides)))
        return BrokenPlan(broken, tuple(map(str, self._actions(plan))))

    # -- facts

    def _find_stream_facts(self, rules: Rules) -> Blamed[clingo.Symbol]:
        """Find the facts of the stream without which a plan obeys the rules."""
        kept = _selectors(rules)
        core = self._questions.ask(kept).core & self._questions.facts
        return self._find_blamed(sorted(core), lambda facts: self._questions.ask(kept, facts))

    def _find_program_facts(self, rules: Rules) -> Blamed[int]:
        """Find the facts of the program without which a plan obeys the rules."""
        facts, kept = self._relaxed.facts_behind(rules), _selectors(rules)
        everything = frozenset(facts)
        return self._find_blamed(
            facts, lambda some: self._questions.with_program(self._relaxed.without(everything - some)).ask(kept)
        )

    def _find_blamed(self, facts: Sequence[T], ask: Callable[[FrozenSet[T]], Reply]) -> Blamed[T]:
        """Find the facts that are necessary for the conflict, and whether they hinder.

        None of these hinders if several hindering facts suffice independently. Then only one minimal set is kept.
        """
        everything = frozenset(facts)
        alone = {fact: reply for fact in facts for reply in [ask(everything - {fact})] if reply.satisfiable}
        if all(self._hinders(reply) is False for reply in alone.values()):
            alone = self._in_time(lambda: self._one_conflict(facts, alone, ask), alone) or alone
        return tuple((fact, self._hinders(reply)) for fact, reply in alone.items())

    def _one_conflict(
        self, facts: Sequence[T], needed: Dict[T, Reply], ask: Callable[[FrozenSet[T]], Reply]
    ) -> Dict[T, Reply]:
        """Remove facts until all remaining ones are necessary; ``needed`` ones already are.

        A removal can make other facts unnecessary, as a plan can also depend on the removed fact.
        """
        rest = [fact for fact in facts if fact not in needed]
        if not rest:
            return needed
        oracle: Oracle[T] = yes_or_no(lambda some: bool(ask(some.union(needed)).satisfiable))
        mus = find_mus(rest, remember(oracle, [Witness(False, frozenset(rest))]))
        if not mus.minimal:
            raise UndecidedError
        facts = [fact for fact in facts if fact in needed or fact in mus.items]
        replies = {fact: ask(frozenset(facts) - {fact}) for fact in facts}
        return self._one_conflict(facts, {fact: reply for fact, reply in replies.items() if reply.satisfiable}, ask)

    def _hinders(self, without: Reply) -> Optional[bool]:
        """Return whether a plan without a fact has actions; None if the program has no actions."""
        return bool(self._actions(without)) if ACTION in self._program.head_signatures else None

    def _actions(self, plan: Reply) -> List[clingo.Symbol]:
        actions = Plan.from_atoms(plan.answers[-1], plan.horizon).rest(self._steps[0]).actions
        return sorted(actions, key=lambda one: (one.arguments[2].number, one))


def _selectors(rules: Iterable[int]) -> List[clingo.Symbol]:
    """Return the selectors of rules at all steps."""
    return [clingo.Function(WHOLE, [clingo.Number(rule)]) for rule in sorted(rules)]
