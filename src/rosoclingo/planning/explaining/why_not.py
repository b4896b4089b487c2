"""Why there is no plan, as plain values and in words."""

from dataclasses import asdict, dataclass
from typing import Any, Dict, Iterable, List, Optional, Tuple

from rosoclingo.planning.explaining.named_rules import NamedRule, RuleKind
from rosoclingo.planning.explaining.near_miss import NeverTrue

#: Of so many facts at most each is named where all they do is that there is something to do.
MANY = 12


_BEYOND = (
    "No rule stands in the way: nothing that the program can do leads there, or not in so many steps",
    "(a place, a connection or an action may be missing).",
)


@dataclass(frozen=True)
class BlamedRule:
    """A rule because of which there is no plan.

    Attributes:
        rule: the rule.
        steps: at which its instances forbid something; none where that is not known, or it is of no step.
        besides: the other rules that would have to go for a plan without this one, as few as can be; none where there
            is one without this rule alone; None where that is not known.
        breach: where the plan that there is without it breaks it: the step, None in base, and the values of its
            variables; None where that is not known.
        words: what its author says of that, or of the rule; empty where nothing.

    """

    rule: NamedRule
    steps: Tuple[int, ...] = ()
    besides: Optional[Tuple[NamedRule, ...]] = None
    breach: Optional[Tuple[Optional[int], Dict[str, str]]] = None

    @property
    def words(self) -> str:
        """What its author says of it, with the values of the plan that breaks it."""
        return self.rule.saying(self.breach[1] if self.breach else {})


@dataclass(frozen=True)
class BlamedFact:
    """A fact because of which there is no plan: of the stream, as is an action done, or of the program.

    Attributes:
        text: the fact.
        rule: where the program has it; None for a fact of the stream.
        hinders: whether there would be something to do without it; False where it merely asks for something, or lets
            it be asked for; None where that is not known, as of programs without actions.

    """

    text: str
    rule: Optional[NamedRule] = None
    hinders: Optional[bool] = None


@dataclass(frozen=True)
class BrokenPlan:
    """A plan that breaks these rules and no other: its actions to come, in order."""

    rules: Tuple[NamedRule, ...]
    actions: Tuple[str, ...]


@dataclass(frozen=True)
class WhyNot:
    """Why there is no plan: rules and facts which together allow none, whatever becomes of the others.

    A rule of the others may be let go, a fact of the others that the rules depend on may never have been told.

    Attributes:
        step: the step of the update.
        last: the last step that a plan might have had.
        never: whether it is known that no longer plan does, either.
        rules: constraints and bounds of choices.
        told: facts of the stream.
        facts: facts of the program.
        smallest: whether fewer rules would not do.
        complete: whether all of this was found out in time; otherwise some that are named may be of no matter.
        plan: a plan that breaks as few rules as can be, one of ``rules`` among them; None where none is known.
        lacking: what a plan would need at its end and what no rule ever makes true, with the rules that come nearest.

    """

    step: int
    last: int
    never: bool = False
    rules: Tuple[BlamedRule, ...] = ()
    told: Tuple[BlamedFact, ...] = ()
    facts: Tuple[BlamedFact, ...] = ()
    smallest: bool = False
    complete: bool = False
    plan: Optional[BrokenPlan] = None
    lacking: Tuple[NeverTrue, ...] = ()

    def to_message(self) -> Dict[str, Any]:
        """Return it as a plain value that JSON knows."""
        return asdict(self, dict_factory=_plain)

    def text(self) -> str:
        """Return it in words, in several lines."""
        return "\n".join([*self._heading(), *self._of_rules(), *self._of_facts(), *self._of_plan()]) + "\n"

    def _heading(self) -> List[str]:
        steps = self.last - self.step
        within = f"No plan of at most {steps} step{'' if steps == 1 else 's'}"
        return [f"{within}, and none of any length." if self.never else f"{within}; there may be a longer one."]

    def _of_rules(self) -> List[str]:
        if not self.rules:
            text = "No constraint forbids it: the rules that define things have no answer, or the facts contradict."
            return [text] if self.complete else ["It was not found out in time why."]
        kind = "These rules forbid it together" if len(self.rules) > 1 else "This rule forbids it"
        doubt = "" if self.complete else " (not all of it was found out in time)"
        lines = [f"{kind}{doubt}:", *(line for one in self.rules for line in _lines_of(one, self.last))]
        volatile = all(one.rule.kind is RuleKind.VOLATILE for one in self.rules)
        lacking = [line for one in self.lacking for line in one.lines()]
        return [*lines, *(lacking or _BEYOND)] if volatile and not self.never else [*lines, *lacking]

    def _of_facts(self) -> List[str]:
        facts = [*self.told, *self.facts]
        hindering = [one for one in facts if one.hinders is not False]
        asking = [one for one in facts if one.hinders is False]
        lines = ["given these facts:", *(f"  {_fact(one)}" for one in hindering)] if hindering else []
        if asking:
            texts = [one.text for one in asking]
            more = [f"and {len(texts) - MANY} more"] if len(texts) > MANY else []
            lines += ["without one of these there would be nothing to do:", "  " + " ".join([*texts[:MANY], *more])]
        return lines

    def _of_plan(self) -> List[str]:
        if self.plan is None:
            return []
        rules = " and ".join(_short(rule) for rule in self.plan.rules)
        return [f"There would be a plan without {rules}:", f"  {' '.join(self.plan.actions) or 'nothing to do'}"]


def _lines_of(one: BlamedRule, last: int) -> List[str]:
    rule = one.rule
    lines = [f"  {rule.place}: {one.words or rule.kind.value}", *(f"      {line}" for line in rule.text.splitlines())]
    where = _where(one, last)
    if where:
        lines.append(f"    {where}")
    if one.breach is not None:
        lines.append(f"    {_breach(*one.breach)}")
    if one.besides:
        lines.append(
            f"    it is not enough to leave it out: {' and '.join(map(_short, one.besides))} would forbid it, too"
        )
    return lines


def _where(one: BlamedRule, last: int) -> str:
    """Say at which steps a rule forbids something."""
    if not one.steps:
        return ""
    if one.rule.kind is RuleKind.VOLATILE and one.steps[-1] == last:
        return "at the end of the plan, whatever its length" if len(one.steps) > 1 else f"at the last step, {last}"
    return f"at step{'' if len(one.steps) == 1 else 's'} {ranges(one.steps)}"


def _breach(step: Optional[int], values: Dict[str, str]) -> str:
    at = "" if step is None else f" at step {step}"
    of = ", ".join(f"{name}={value}" for name, value in values.items())
    return f"a plan without it breaks it{at}{' with ' if of else ''}{of}"


def _fact(one: BlamedFact) -> str:
    told = "done" if one.text.startswith("_action_lib(") else "told"
    return f"{one.rule.place if one.rule is not None else told}: {one.text}"


def _short(rule: NamedRule) -> str:
    return f"{rule.file}:{rule.line}"


def ranges(numbers: Iterable[int]) -> str:
    """Return ascending numbers as text, those in a row together: 1-3, 5."""
    found: List[List[int]] = []
    for number in numbers:
        if found and number == found[-1][-1] + 1:
            found[-1].append(number)
        else:
            found.append([number])
    return ", ".join(str(row[0]) if len(row) == 1 else f"{row[0]}-{row[-1]}" for row in found)


def _plain(pairs: Iterable[Tuple[str, Any]]) -> Dict[str, Any]:
    return {name: value.value if isinstance(value, RuleKind) else value for name, value in pairs}
