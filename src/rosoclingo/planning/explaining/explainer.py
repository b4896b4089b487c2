"""Finds out why there is no plan: the fewest rules that forbid it, the facts that they need, and where they bite.

The program's constraints are let go one way or the other on one grounding (see
:mod:`~rosoclingo.planning.explaining.relaxed_program`), and so are the facts of the stream, as where the core looks for
goals to give up (:mod:`~rosoclingo.planning.strategies.probe`). Each question that has no answer has a core, which
makes the next ones small. The facts of the program cost a grounding each, and come last.
"""

from typing import Callable, Dict, FrozenSet, Iterable, List, NamedTuple, Optional, Sequence, Tuple, TypeVar

import clingo

from rosoclingo.oclingo.program.action_rules import ACTION
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.planning.explaining.induction import breaks_for_ever
from rosoclingo.planning.explaining.named_rules import RuleKind
from rosoclingo.planning.explaining.near_miss import Ends, never_true
from rosoclingo.planning.explaining.questions import Facts, Questions, Stream
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
Blame = Tuple[Tuple[T, Optional[bool]], ...]
"""Things to blame, each with whether it hinders."""


class _Without(NamedTuple):
    """A plan that there is without one rule, and without the rules ``besides`` it, which are as few as can be."""

    verdict: Reply
    besides: Rules


def explain(program: ReactiveProgram, stream: Stream, halt: Stop = lambda: False) -> Optional[WhyNot]:
    """Return why there is no plan; None where there is one.

    ``halt`` ends it, with what was found by then. Raises SolverError where the stream is refused, and UndecidedError
    where ``halt`` came before it was even known that there is no plan.
    """
    relaxed = RelaxedProgram.of(program)
    questions = Questions(relaxed, stream, may_idle(program, halt), halt)
    return _Explainer(program, relaxed, questions, range(questions.step, questions.step + stream.steps + 1)).run()


class _Explainer:
    """Explains one stream; ``steps`` are the present one and those that a plan may reach."""

    def __init__(self, program: ReactiveProgram, relaxed: RelaxedProgram, questions: Questions, steps: range) -> None:
        self._program, self._relaxed, self._questions, self._steps = program, relaxed, questions, steps
        self._all = [rule.number for rule in relaxed.constraints]
        self._complete = True

    def run(self) -> Optional[WhyNot]:
        """Return why there is no plan; None where there is one."""
        oracle = remember(self._ask_rules, [])
        if oracle(frozenset(self._all)).satisfiable:
            return None
        found = self._note(find_smallest_mus(self._all, oracle))
        rules = frozenset(found.items)
        never: bool = self._in_time(lambda: self._questions.ask(_wholes(rules)).hopeless, False)
        told: Blame[clingo.Symbol] = self._in_time(lambda: self._find_told(rules), ())
        plans: Dict[int, _Without] = {}
        self._in_time(lambda: self._plan_without(rules, oracle, plans), None)
        steps: Dict[int, Tuple[int, ...]] = self._in_time(lambda: self._find_steps(found.items), {})
        facts: Blame[int] = self._in_time(lambda: self._find_facts(rules, self._questions.told), ())
        rule_of = self._relaxed.rules
        blamed = tuple(self._blamed(number, plans.get(number), steps.get(number, ())) for number in found.items)
        reach = self._reach() if self._complete else None
        return WhyNot(
            self._steps[0],
            self._steps[-1],
            never or (reach is not None and breaks_for_ever(self._relaxed, rules, reach, self._steps[-1])),
            blamed,
            tuple(BlamedFact(f"{atom}.", hinders=hinders) for atom, hinders in told),
            tuple(BlamedFact(rule_of[one].text, rule_of[one], hinders) for one, hinders in facts),
            found.smallest,
            self._complete,
            self._nearest(plans),
            () if reach is None else never_true(self._program, reach, _ends(blamed)),
        )

    def _reach(self) -> Optional[Reach]:
        """Return what the program can ever make true, None where that is not known."""
        try:
            return Reach(self._program, self._questions.known())
        except UncertainError:
            return None

    def _note(self, found: Mus[T]) -> Mus[T]:
        self._complete &= found.minimal
        return found

    def _in_time(self, find: Callable[[], T], otherwise: T) -> T:
        """Return what is found, as long as there is time."""
        try:
            return find()
        except UndecidedError:
            self._complete = False
            return otherwise

    # -- rules

    def _ask_rules(self, kept: Rules) -> Witness[int]:
        verdict = self._questions.ask(_wholes(kept))
        if verdict.satisfiable:
            broken = {one.number for one in self._relaxed.breaches(verdict.answers[-1])}
            return Witness(True, frozenset(self._all) - broken)
        return Witness(False, frozenset(atom.arguments[0].number for atom in verdict.blamed))

    def _plan_without(self, rules: Rules, oracle: Oracle[int], found: Dict[int, _Without]) -> None:
        """Find the shortest plan without each of the rules, and with as many others as can be."""
        for number in sorted(rules):
            possible = frozenset(self._all) - {number}
            if not oracle(possible).satisfiable:
                possible = grow(rules - {number}, self._all, oracle)
            kept = _wholes(possible)
            verdict = self._questions.shortest(kept, self._questions.ask(kept))
            found[number] = _Without(verdict, frozenset(self._all) - possible - {number})

    def _find_steps(self, rules: Iterable[int]) -> Dict[int, Tuple[int, ...]]:
        """Find the steps at which it is enough to keep the rules, the later ones left out first."""
        first = self._program.first_step
        places = [clingo.Function("base"), *map(clingo.Number, range(first, self._steps[-1] + 1))]
        selectors = [clingo.Function(KEEP, [clingo.Number(rule), place]) for place in places for rule in rules]

        def ask(kept: FrozenSet[clingo.Symbol]) -> Witness[clingo.Symbol]:
            """Tell whether there is a plan that heeds rules at some steps alone."""
            verdict = self._questions.ask(kept)
            return Witness(bool(verdict.satisfiable), kept if verdict.satisfiable else verdict.blamed)

        found: Dict[int, List[int]] = {}
        for atom in self._note(find_mus(selectors, ask)).items:
            rule, place = atom.arguments
            if place.type is clingo.SymbolType.Number:
                found.setdefault(rule.number, []).append(place.number)
        return {rule: tuple(sorted(steps)) for rule, steps in found.items()}

    def _blamed(self, number: int, without: Optional[_Without], steps: Tuple[int, ...]) -> BlamedRule:
        rule = self._relaxed.rules[number]
        if without is None:
            return BlamedRule(rule, steps)
        breaches = [one for one in self._relaxed.breaches(without.verdict.answers[-1]) if one.number == number]
        breach = (breaches[0].step, dict(breaches[0].values)) if breaches else None
        return BlamedRule(rule, steps, tuple(self._relaxed.rules[one] for one in sorted(without.besides)), breach)

    def _nearest(self, plans: Dict[int, _Without]) -> Optional[BrokenPlan]:
        """Return a plan that breaks one rule and as few others as possible; one that just ends early tells nothing."""
        kinds = {rule.number: rule.kind for rule in self._relaxed.constraints}
        some = [one for one in plans if kinds[one] is not RuleKind.VOLATILE]
        if not some:
            return None
        best = min(some, key=lambda one: len(plans[one].besides))
        broken = (self._relaxed.rules[one] for one in (best, *sorted(plans[best].besides)))
        return BrokenPlan(tuple(broken), tuple(map(str, self._to_do(plans[best].verdict))))

    # -- facts

    def _find_told(self, rules: Rules) -> Blame[clingo.Symbol]:
        """Find the facts of the stream without which the rules would allow a plan."""
        kept = _wholes(rules)
        told = self._questions.told
        return self._to_blame(
            sorted(self._questions.ask(kept, told).core), lambda facts: self._questions.ask(kept, facts)
        )

    def _find_facts(self, rules: Rules, told: Facts) -> Blame[int]:
        """Find the facts of the program without which the rules would allow a plan."""
        facts, kept = [rule.number for rule in self._relaxed.facts_behind(rules)], _wholes(rules)
        everything = frozenset(facts)

        def ask(some: FrozenSet[int]) -> Reply:
            """Tell whether there is a plan with these facts alone."""
            return self._questions.about(self._relaxed.without(everything - some)).ask(kept, told)

        return self._to_blame(facts, ask)

    def _to_blame(self, facts: Sequence[T], ask: Callable[[FrozenSet[T]], Reply]) -> Blame[T]:
        """Find the facts without any one of which there would be a plan, and whether they hinder.

        Where that is so of none that hinders, as several do that are enough each, all but those of one reason are left
        out.
        """
        everything = frozenset(facts)
        alone = {fact: reply for fact in facts for reply in [ask(everything - {fact})] if reply.satisfiable}
        if all(self._hinders(reply) is False for reply in alone.values()):
            alone = self._in_time(lambda: self._one_reason(facts, alone, ask), alone) or alone
        return tuple((fact, self._hinders(reply)) for fact, reply in alone.items())

    def _one_reason(
        self, facts: Sequence[T], needed: Dict[T, Reply], ask: Callable[[FrozenSet[T]], Reply]
    ) -> Dict[T, Reply]:
        """Leave out facts until there would be a plan without any one of those left; of these some are ``needed``.

        Without some facts, others may no longer be needed: a plan can need a fact as well.
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
        return self._one_reason(facts, {fact: reply for fact, reply in replies.items() if reply.satisfiable}, ask)

    def _hinders(self, without: Reply) -> Optional[bool]:
        """Tell whether there is something to do in a plan that there is without a fact."""
        return bool(self._to_do(without)) if ACTION in self._program.head_signatures else None

    def _to_do(self, verdict: Reply) -> List[clingo.Symbol]:
        plan = Plan.of(verdict.answers[-1], verdict.horizon).since(self._steps[0])
        return sorted(plan.actions, key=lambda one: (one.arguments[2].number, one))


def _ends(rules: Iterable[BlamedRule]) -> Ends:
    """Return the constraints on a plan's end, as the plan that there is without each of them breaks it."""
    return [(one.rule, one.breach[1]) for one in rules if one.rule.kind is RuleKind.VOLATILE and one.breach]


def _wholes(rules: Iterable[int]) -> List[clingo.Symbol]:
    """Return the selectors of whole rules."""
    return [clingo.Function(WHOLE, [clingo.Number(rule)]) for rule in sorted(rules)]
