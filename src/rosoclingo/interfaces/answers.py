"""From the end of a goal to the facts that answer the core: the return term and further facts.  No ROS."""

import re
from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Pattern, Tuple

from clingo import Function, Symbol

from rosoclingo.common.labels import UnknownLabelError
from rosoclingo.interfaces.templates import Ended, FillError, Scope, evaluate
from rosoclingo.interfaces.values import TermError, as_term, as_text, read_atom

SUCCEEDED = "succeeded"
LOST = "server_lost"
INTERRUPTED = "interrupted"

# Return term by how the goal ended, where no rule says otherwise; the parameter itself stands for success.
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


class Rule(NamedTuple):
    """Says what to answer if a goal ended in this way; None and {} match everything."""

    returns: Any
    status: Optional[str] = None
    text: Optional[Pattern[str]] = None
    when: Mapping[str, Any] = {}
    facts: Tuple[str, ...] = ()

    def matches(self, ended: Ended) -> bool:
        """True if the status, the server's words and the named fields of the result are as the rule wants."""
        if self.status is not None and self.status != ended.status:
            return False
        if self.text is not None and not self.text.search(ended.text):
            return False
        return all(equal(_field(ended.result, name), wanted) for name, wanted in self.when.items())


class Answer(NamedTuple):
    """What goes back to the core: the value V of `_return(A,V,C)`, further facts, and what could not be filled."""

    value: Symbol
    facts: Tuple[str, ...] = ()
    warnings: Tuple[str, ...] = ()


def answer(rules: Tuple[Rule, ...], scope: Scope) -> Answer:
    """The answer of the first matching rule, else of DEFAULT_RETURNS; `scope.ended` must be set."""
    ended = scope.ended if scope.ended is not None else Ended("aborted")
    rule = next((each for each in rules if each.matches(ended)), None)
    if rule is None:
        return Answer(default_value(ended, scope))
    warnings: List[str] = []
    value = _value(rule, scope, warnings)
    facts = tuple(fact for template in rule.facts for fact in _fact(template, scope, warnings))
    return Answer(default_value(ended, scope) if value is None else value, facts, tuple(warnings))


def default_value(ended: Ended, scope: Scope) -> Symbol:
    """The return term where no rule says otherwise: the parameter on success, else a reason named like the status."""
    if ended.status == SUCCEEDED:
        return scope.parameter
    return Function(DEFAULT_RETURNS.get(ended.status, ended.status))


def conclude(verdict: Optional[str], ended: Optional[Ended]) -> Ended:
    """How the action ended as the core sees it: the interface's own verdict stands unless the server succeeded."""
    if verdict is None:
        return ended if ended is not None else Ended("aborted")
    if ended is None:
        return Ended(verdict)
    return ended if ended.status == SUCCEEDED else ended._replace(status=verdict)


def _value(rule: Rule, scope: Scope, warnings: List[str]) -> Optional[Symbol]:
    try:
        return as_term(evaluate(rule.returns, scope))
    except (FillError, UnknownLabelError) as error:
        warnings.append(f"return {rule.returns!r}: {error}")
        return None


def _fact(template: str, scope: Scope, warnings: List[str]) -> Tuple[str, ...]:
    try:
        return (str(read_atom(as_text(evaluate(template, scope)))),)
    except (FillError, TermError, UnknownLabelError) as error:
        warnings.append(f"fact {template!r}: {error}")
        return ()


def _field(result: Any, name: str) -> Any:
    for step in name.split("."):
        result = getattr(result, step, None)
    return result


def equal(value: Any, wanted: Any) -> bool:
    """Equality, and for a text in slashes a match of the regular expression between them."""
    pattern = pattern_of(wanted)
    if pattern is not None:
        return re.search(pattern, as_text(value)) is not None
    return bool(value == wanted)


def pattern_of(wanted: Any) -> Optional[str]:
    """The regular expression that a condition's text in slashes holds; None where it is none."""
    slashed = isinstance(wanted, str) and len(wanted) > 1 and wanted[0] == wanted[-1] == "/"
    return str(wanted[1:-1]) if slashed else None
