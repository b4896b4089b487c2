"""Answers to the core: the return term and further facts for a goal that has ended.  No ROS."""

import re
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Pattern, Tuple

from clingo import Function, Symbol, SymbolType

from rosoclingo.common.labels import UnknownLabelError
from rosoclingo.interfaces.templates import (
    ActionScope,
    FillError,
    GoalEnd,
    evaluate,
    fill_term,
    is_reference,
    references,
    term_with,
)
from rosoclingo.interfaces.values import TermError, as_string, as_term, as_text, read_atom, read_term

SUCCEEDED = "succeeded"
LOST = "server_lost"
INTERRUPTED = "interrupted"

# The default return term by the status of the goal; the parameter stands for success.
DEFAULT_RETURNS: Dict[str, str] = {
    SUCCEEDED: "$parameter",
    "aborted": "failed",
    "rejected": "rejected",
    "preempted": "preempted",
    "recalled": "preempted",
    "timeout": "timeout",
    LOST: LOST,
    "interface_lost": "interface_lost",
    INTERRUPTED: INTERRUPTED,
    "unknown_label": "unknown_label",
    "bad_parameter": "bad_parameter",
}

#: Reasons with which every action can fail.
REASONS = tuple(reason for status, reason in DEFAULT_RETURNS.items() if status != SUCCEEDED)


_PLACEHOLDER = Function("x")


class Rule(NamedTuple):
    """An answer for goals with matching status, text and result; None and {} match everything.

    With ``success`` the action counts as done, regardless of the server's status.
    """

    returns: Any
    status: Optional[str] = None
    text: Optional[Pattern[str]] = None
    when: Mapping[str, Any] = {}
    facts: Tuple[str, ...] = ()
    success: bool = False

    def matches(self, ended: GoalEnd) -> bool:
        """Return whether the rule's status, text and result fields match the end of a goal."""
        if self.status is not None and self.status != ended.status:
            return False
        if self.text is not None and not self.text.search(ended.text):
            return False
        return all(equal(_field(ended.result, name), wanted) for name, wanted in self.when.items())


class Answer(NamedTuple):
    """An answer to the core: the value V of `_return(A,V,C)`, further facts, and warnings about unfilled templates.

    Only an answer with ``success`` can return the action's parameter. None means success if the goal has succeeded.
    """

    value: Symbol
    facts: Tuple[str, ...] = ()
    warnings: Tuple[str, ...] = ()
    success: Optional[bool] = None


def answer(rules: Tuple[Rule, ...], scope: ActionScope) -> Answer:
    """Return the answer of the first matching rule, else of DEFAULT_RETURNS."""
    ended = scope.ended
    rule = next((each for each in rules if each.matches(ended)), None)
    if rule is None:
        return Answer(default_value(ended, scope))
    warnings: List[str] = []
    value = _tried("return", rule.returns, _filled, scope, warnings)
    filled = [_tried("fact", template, _fact, scope, warnings) for template in rule.facts]
    facts = tuple(str(fact) for fact in filled if fact is not None)
    if value is None:
        return Answer(default_value(ended, scope), facts, tuple(warnings))
    success = True if rule.success else None if _refers(rule.returns) else False
    return Answer(value, facts, tuple(warnings), success)


def default_value(ended: GoalEnd, scope: ActionScope) -> Symbol:
    """Return the default return term: the parameter on success, else the reason for the status."""
    if ended.status == SUCCEEDED:
        return scope.parameter
    return Function(DEFAULT_RETURNS.get(ended.status, ended.status))


def conclude(verdict: Optional[str], ended: Optional[GoalEnd]) -> GoalEnd:
    """Return the end of the action for the core: the interface's verdict, unless the server reports success."""
    if verdict is None:
        return ended if ended is not None else GoalEnd("aborted")
    if ended is None:
        return GoalEnd(verdict)
    return ended if ended.status == SUCCEEDED else ended._replace(status=verdict)


def in_words(ended: GoalEnd, server: str) -> str:
    """Return a log text about the end of an action."""
    why = ended.text or (f"the action server {server} does not answer" if ended.status == LOST else "")
    return f"{ended.status}: {why}" if why else ended.status


def fact_fault(template: str) -> str:
    """Return the fault of a fact's template that no value can fix; empty for none, and for a single reference."""
    if is_reference(template):
        return ""
    try:
        read_atom(term_with(template, _PLACEHOLDER))
    except TermError as error:
        return str(error)
    return ""


def _tried(
    kind: str, template: Any, fill: Callable[[Any, ActionScope], Symbol], scope: ActionScope, warnings: List[str]
) -> Optional[Symbol]:
    """Return the symbol of a filled template; None and a warning if it cannot be filled."""
    try:
        return fill(template, scope)
    except (FillError, TermError, UnknownLabelError) as error:
        warnings.append(f"{kind} {template!r}: {error}")
        return None


def _filled(template: Any, scope: ActionScope) -> Symbol:
    """Return the value of a rule: a term if the filled text is one, else an ASP string."""
    if not _refers(template) or is_reference(template):
        return as_term(evaluate(template, scope))
    try:
        shape = read_term(term_with(template, _PLACEHOLDER))
    except TermError:
        return as_string(as_text(evaluate(template, scope)))
    try:
        return read_term(fill_term(template, scope))
    except (FillError, TermError):
        if shape.type is SymbolType.Function and not shape.arguments:
            return as_string(as_text(evaluate(template, scope)))
        raise


def _refers(template: Any) -> bool:
    """Return whether a template depends on the action or on its end."""
    return isinstance(template, str) and bool(references(template))


def _fact(template: str, scope: ActionScope) -> Symbol:
    return read_atom(as_text(evaluate(template, scope)) if is_reference(template) else fill_term(template, scope))


def _field(result: Any, name: str) -> Any:
    for step in name.split("."):
        result = getattr(result, step, None)
    return result


def equal(value: Any, wanted: Any) -> bool:
    """Return whether a value equals the wanted value, or matches it if that is a `/regular expression/`."""
    pattern = pattern_of(wanted)
    if pattern is not None:
        return re.search(pattern, as_text(value)) is not None
    return bool(value == wanted)


def pattern_of(wanted: Any) -> Optional[str]:
    """Return the regular expression of a condition's text in slashes, None for any other value."""
    slashed = isinstance(wanted, str) and len(wanted) > 1 and wanted[0] == wanted[-1] == "/"
    return str(wanted[1:-1]) if slashed else None
