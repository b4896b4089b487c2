"""Procedures that call themselves with a number that goes down, or up, to a bound: these calls come to an end."""

from typing import FrozenSet, Iterator, NamedTuple, Optional, Tuple

from rosoclingo.languages.golog.scanner import Token
from rosoclingo.languages.golog.tree import (
    Around,
    Both,
    Branch,
    Check,
    Choosing,
    Comparison,
    Compound,
    Condition,
    Constant,
    Loop,
    Operation,
    Procedure,
    Sequence,
    Several,
    Statement,
    Step,
    Term,
    Variable,
)

_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


class Way(NamedTuple):
    """The argument at a place, from 0, goes up or down (1 or -1) in a call."""

    place: int
    direction: int


class _Bound(NamedTuple):
    """A parameter lies above (direction -1) or below (1) a number, None, or another parameter."""

    name: str
    direction: int
    other: Optional[str]


_Bounds = FrozenSet[_Bound]


def ways_of_calls(procedure: Procedure) -> Iterator[Tuple[Token, FrozenSet[Way]]]:
    """Yield the word of each call of itself that a procedure has, with the ways that arguments go to a bound.

    The bound stands in a condition of ``if``, ``while``, ``pick``, ``test``, as in ``if N > 0 { p(N - 1); }``; so the
    solver need not look at what lies beyond it.
    """
    parameters = frozenset(one.token.text for one in procedure.parameters)
    for call, bounds in _calls(procedure.body, procedure, parameters, frozenset()):
        yield call.token, frozenset(_ways(call, bounds, procedure))


def _calls(
    one: Statement, procedure: Procedure, known: FrozenSet[str], bounds: _Bounds
) -> Iterator[Tuple[Compound, _Bounds]]:
    """Yield the calls in a statement where parameters that are ``known``, not named anew, have ``bounds``."""
    if isinstance(one, Step):
        if one.what.token.text == procedure.name.text and len(one.what.arguments) == len(procedure.parameters):
            yield one.what, bounds
    elif isinstance(one, Choosing):
        known -= {variable.token.text for variable in one.variables}
        bounds = frozenset(bound for bound in bounds if {bound.name, bound.other or bound.name} <= known)
        yield from _calls(one.body, procedure, known, bounds | _bounds(one.condition, known))
    else:
        for part, more in _parts(one, known):
            yield from _calls(part, procedure, known, bounds | more)


def _parts(one: Statement, known: FrozenSet[str]) -> Iterator[Tuple[Statement, _Bounds]]:
    """Yield the statements in another one, each with the bounds that conditions before it have."""
    bounds: _Bounds = frozenset()
    if isinstance(one, Sequence):
        for part in one.statements:
            yield part, bounds
            bounds |= _bounds(part.condition, known) if isinstance(part, Check) else bounds
    elif isinstance(one, Branch):
        yield one.yes, _bounds(one.condition, known)
        yield one.no, bounds
    elif isinstance(one, Loop):
        yield one.body, _bounds(one.condition, known)
    elif isinstance(one, Several):
        yield from ((part, bounds) for part in one.parts)
    elif isinstance(one, Around):
        yield one.body, bounds
        if one.other is not None:
            yield one.other, bounds


def _bounds(condition: Condition, known: FrozenSet[str]) -> _Bounds:
    """Return the bounds that a condition has if all its parts have to hold."""
    if isinstance(condition, Both):
        return _bounds(condition.left, known) | _bounds(condition.right, known)
    if not isinstance(condition, Comparison) or condition.operator not in _MIRRORED:
        return frozenset()
    left, right, operator = condition.left, condition.right, condition.operator
    return frozenset([*_bound(left, operator, right, known), *_bound(right, _MIRRORED[operator], left, known)])


def _bound(left: Term, operator: str, right: Term, known: FrozenSet[str]) -> Iterator[_Bound]:
    if not isinstance(left, Variable) or left.token.text not in known:
        return
    direction = -1 if operator in (">", ">=") else 1
    if isinstance(right, Variable) and right.token.text in known:
        yield _Bound(left.token.text, direction, right.token.text)
    elif isinstance(right, Constant) and right.token.kind == "number":
        yield _Bound(left.token.text, direction, None)


def _ways(call: Compound, bounds: _Bounds, procedure: Procedure) -> Iterator[Way]:
    names = [one.token.text for one in procedure.parameters]
    same = {
        name
        for name, argument in zip(names, call.arguments)
        if isinstance(argument, Variable) and argument.token.text == name
    }
    for place, (name, argument) in enumerate(zip(names, call.arguments)):
        for bound in bounds:
            if bound.name == name and bound.other in {None, *same} and _goes(argument, name) == bound.direction:
                yield Way(place, bound.direction)


def _goes(term: Term, name: str) -> int:
    """Return 1 for a variable and a number that is added to it, -1 for one that is taken away, else 0."""
    if not isinstance(term, Operation) or term.token.text not in ("+", "-"):
        return 0
    if not isinstance(term.left, Variable) or term.left.token.text != name:
        return 0
    step = term.right
    if not isinstance(step, Constant) or step.token.kind != "number" or not int(step.token.text):
        return 0
    return 1 if term.token.text == "+" else -1
