"""Explanations why there is no plan, as values and as text."""

from dataclasses import asdict, dataclass
from typing import Any, Dict, Iterable, List, Optional, Tuple

from rosoclingo.planning.explaining.named_rules import NamedRule, RuleKind
from rosoclingo.planning.explaining.near_miss import NeverTrue

MOST_REQUESTS = 12
"""Greatest number of facts that an explanation lists as the cause of actions."""

_UNREACHED = (
    "Apart from that, no rule excludes a plan: the actions do not lead there, or not within this number of steps",
    "(a place, a connection or an action may be missing).",
)


@dataclass(frozen=True)
class BlamedRule:
    """A rule of a minimal conflict.

    Attributes:
        rule: the rule.
        steps: the steps of the conflicting instances; empty if unknown or if the rule has no step.
        besides: the fewest other rules to remove along with this rule to get a plan; None if unknown.
        breach: the step (None in base) and the variables of an instance that a plan without the rule violates; None if
            unknown.

    """

    rule: NamedRule
    steps: Tuple[int, ...] = ()
    besides: Optional[Tuple[NamedRule, ...]] = None
    breach: Optional[Tuple[Optional[int], Dict[str, str]]] = None

    @property
    def words(self) -> str:
        """The author's comment on the rule, with the values of the breach."""
        return self.rule.comment(self.breach[1] if self.breach else {})


@dataclass(frozen=True)
class BlamedFact:
    """A fact, or an executed action, without which there is a plan.

    Attributes:
        text: the fact.
        rule: its place in the program; None for a fact of the stream.
        hinders: whether the plan without the fact has actions; False for requests and the facts that they depend on;
            None if unknown, as for programs without actions.

    """

    text: str
    rule: Optional[NamedRule] = None
    hinders: Optional[bool] = None


@dataclass(frozen=True)
class BrokenPlan:
    """The actions of a plan that violates only these rules."""

    rules: Tuple[NamedRule, ...]
    actions: Tuple[str, ...]


@dataclass(frozen=True)
class WhyNot:
    """An explanation why there is no plan: rules and facts that together exclude one.

    Attributes:
        step: the step of the update.
        last: the horizon bound.
        never: whether there is provably no longer plan either.
        rules: constraints and bounds of choices.
        stream_facts: facts of the stream.
        facts: facts of the program.
        smallest: whether no smaller set of rules excludes a plan.
        complete: whether the search finished in time; if not, some of the rules and facts can be irrelevant.
        plan: a plan that violates the fewest rules, among them one of ``rules``; None if unknown.
        lacking: atoms that the end of a plan requires and that are never true.

    """

    step: int
    last: int
    never: bool = False
    rules: Tuple[BlamedRule, ...] = ()
    stream_facts: Tuple[BlamedFact, ...] = ()
    facts: Tuple[BlamedFact, ...] = ()
    smallest: bool = False
    complete: bool = False
    plan: Optional[BrokenPlan] = None
    lacking: Tuple[NeverTrue, ...] = ()

    def to_message(self) -> Dict[str, Any]:
        """Return the explanation as a value for JSON."""
        return asdict(self, dict_factory=_plain)

    def text(self) -> str:
        """Return the explanation as text of several lines."""
        steps = self.last - self.step
        within = f"No plan of at most {steps} step{'' if steps == 1 else 's'}"
        heading = f"{within}, and none of any length." if self.never else f"{within}; a longer plan may exist."
        return "\n".join([heading, *self._rule_lines(), *self._fact_lines(), *self._plan_lines()]) + "\n"

    def _rule_lines(self) -> List[str]:
        if not self.rules:
            text = "No constraint excludes a plan: the other rules have no answer set, or the facts are contradictory."
            return [text] if self.complete else ["No reason was found in time."]
        kind = "These rules together exclude a plan" if len(self.rules) > 1 else "This rule excludes a plan"
        limit = "" if self.complete else " (incomplete: out of time)"
        lines = [f"{kind}{limit}:", *(line for one in self.rules for line in _lines_of(one, self.last))]
        volatile = all(one.rule.kind is RuleKind.VOLATILE for one in self.rules)
        lacking = [line for one in self.lacking for line in one.lines()]
        return [*lines, *(lacking or _UNREACHED)] if volatile and not self.never else [*lines, *lacking]

    def _fact_lines(self) -> List[str]:
        facts = [*self.stream_facts, *self.facts]
        hindering = [one for one in facts if one.hinders is not False]
        requests = [one.text for one in facts if one.hinders is False]
        lines = ["given these facts:", *(f"  {_fact(one)}" for one in hindering)] if hindering else []
        if requests:
            more = [f"and {len(requests) - MOST_REQUESTS} more"] if len(requests) > MOST_REQUESTS else []
            lines.append("without any one of these facts there is nothing to do:")
            lines.append("  " + " ".join([*requests[:MOST_REQUESTS], *more]))
        return lines

    def _plan_lines(self) -> List[str]:
        if self.plan is None:
            return []
        rules = " and ".join(_short(rule) for rule in self.plan.rules)
        return [f"Without {rules} there is a plan:", f"  {' '.join(self.plan.actions) or 'nothing to do'}"]


def _lines_of(one: BlamedRule, last: int) -> List[str]:
    rule = one.rule
    lines = [f"  {rule.place}: {one.words or rule.kind.value}", *(f"      {line}" for line in rule.text.splitlines())]
    if one.steps:
        lines.append(f"    {_where(one, last)}")
    if one.breach is not None:
        step, values = one.breach
        at = "" if step is None else f" at step {step}"
        variables = ", ".join(f"{name}={value}" for name, value in values.items())
        lines.append(f"    a plan without this rule violates it{at}{' with ' if variables else ''}{variables}")
    if one.besides:
        lines.append(f"    to get a plan, {' and '.join(map(_short, one.besides))} must be removed as well")
    return lines


def _where(one: BlamedRule, last: int) -> str:
    """Return the steps of a rule in words."""
    if one.rule.kind is RuleKind.VOLATILE and one.steps[-1] == last:
        return "at the end of the plan, for any length" if len(one.steps) > 1 else f"at the last step, {last}"
    return f"at step{'' if len(one.steps) == 1 else 's'} {ranges(one.steps)}"


def _fact(one: BlamedFact) -> str:
    origin = "executed" if one.text.startswith("_action_lib(") else "asserted"
    return f"{one.rule.place if one.rule is not None else origin}: {one.text}"


def _short(rule: NamedRule) -> str:
    return f"{rule.file}:{rule.line}"


def ranges(numbers: Iterable[int]) -> str:
    """Return ascending numbers as text with ranges: 1-3, 5."""
    found: List[List[int]] = []
    for number in numbers:
        if found and number == found[-1][-1] + 1:
            found[-1].append(number)
        else:
            found.append([number])
    return ", ".join(str(row[0]) if len(row) == 1 else f"{row[0]}-{row[-1]}" for row in found)


def _plain(pairs: Iterable[Tuple[str, Any]]) -> Dict[str, Any]:
    return {name: value.value if isinstance(value, RuleKind) else value for name, value in pairs}
