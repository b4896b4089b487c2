"""Detection of endless recursion: procedures that call themselves before any action.

A recursion is finite if an argument counts down, or up, to a bound.
"""

from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Optional, Set, Tuple

from rosoclingo.golog.grammar import Procedures, Signature, choice, parameters, signature, statements
from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.reachable import reachable

COUNTING = "if N > 0 { p(N - 1); }"
"""An example of a finite recursion, for messages."""

_LOOPS = ("while", "star", "every", "achieve")
_TOGETHER = ("seq", "conc", "prio", "order", "interrupts")
_MIRRORED = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}


class _Beginning(NamedTuple):
    """The beginning of a program: its calls before any action, and whether it can end without an action."""

    calls: List[SyntaxNode]
    idle: bool


def endless_calls(procedures: Procedures, file: int) -> Iterator[Tuple[SyntaxNode, str, str]]:
    """Yield call, message and fix for each procedure of a file with a possibly endless recursion.

    ``procedures`` are all callable procedures.
    """
    bodies = {one: declared.procedure.parts[-1] for one, declared in procedures.items()}
    idle: Set[Signature] = set()
    begins: Dict[Signature, _Beginning] = {}
    before = -1
    while before != len(idle):
        before = len(idle)
        begins = {one: _beginning_of(body, procedures, idle) for one, body in bodies.items()}
        idle |= {one for one, begin in begins.items() if begin.idle}
    calls = {
        one: _without_finite_recursion(begins[one].calls, declared.procedure) for one, declared in procedures.items()
    }
    for one, declared in procedures.items():
        for call in calls[one] if declared.number == file else ():
            if one in reachable([signature(call)], lambda procedure: map(signature, calls[procedure])):
                remedy = f"write an action before the call, count down ({COUNTING}), or use a loop (while, star)"
                yield call, f"{one[0]} can call itself endlessly without an action in between", remedy
                break


def _beginning_of(one: SyntaxNode, procedures: Procedures, idle: Set[Signature]) -> _Beginning:
    """Return the beginning of a statement; ``idle`` are the procedures that can end without an action."""
    kind = one.kind
    if kind == "step":
        called = signature(one.parts[0])
        return _Beginning(one.parts if called in procedures else [], called in idle)
    if kind in ("any", "test", "await", "until"):
        return _Beginning([], kind != "any")
    inner = statements(one)[:1] if kind in ("try", "undoing") else statements(one)
    parts, calls = [_beginning_of(part, procedures, idle) for part in inner], []  # type: List[_Beginning], List[SyntaxNode]
    for part in parts:
        calls += part.calls
        if kind == "seq" and not part.idle:
            break
    if kind in _LOOPS or (kind == "if" and len(parts) == 1):
        return _Beginning(calls, True)
    return _Beginning(calls, (all if kind in _TOGETHER else any)(part.idle for part in parts))


# ---- finite recursion ----------------------------------------------------------------------------------------------


class _Bound(NamedTuple):
    """A bound of a parameter: it is above (direction -1) or below (1) a number or the ``other`` parameter."""

    name: str
    direction: int
    other: Optional[str]


_Bounds = FrozenSet[_Bound]


def _without_finite_recursion(calls: List[SyntaxNode], procedure: SyntaxNode) -> List[SyntaxNode]:
    """Remove the direct recursive calls of a procedure if an argument approaches a bound in all of them.

    The bound is in a condition of ``if``, ``while``, ``pick`` or ``test``, as in ``if N > 0 { p(N - 1); }``. The solver
    then needs no instances beyond it.
    """
    known = frozenset(one.text for one in parameters(procedure))
    own = [call for call in calls if signature(call) == signature(procedure)]
    ways = [
        frozenset(_approaches(call, bounds, procedure))
        for call, bounds in _bounded(procedure.parts[-1], procedure, known, frozenset())
        if any(call is one for one in own)
    ]
    if not own or not frozenset.intersection(*ways):
        return calls
    return [call for call in calls if signature(call) != signature(procedure)]


def _bounded(
    one: SyntaxNode, procedure: SyntaxNode, known: FrozenSet[str], bounds: _Bounds
) -> Iterator[Tuple[SyntaxNode, _Bounds]]:
    """Yield the recursive calls in a statement, each with the bounds of the parameters in scope."""
    if one.kind == "step":
        if signature(one.parts[0]) == signature(procedure):
            yield one.parts[0], bounds
    elif one.kind in ("pick", "every"):
        variables, condition, body = choice(one)
        known -= {variable.text for variable in variables}
        bounds = frozenset(bound for bound in bounds if {bound.name, bound.other or bound.name} <= known)
        yield from _bounded(body, procedure, known, bounds | _bounds(condition, known))
    else:
        inside = bounds | _bounds(one.parts[0], known) if one.kind in ("if", "while") else bounds
        for part in statements(one):
            yield from _bounded(part, procedure, known, inside)
            inside = bounds if one.kind == "if" else inside
            if one.kind == "seq" and part.kind in ("test", "await"):
                inside |= _bounds(part.parts[0], known)


def _bounds(condition: SyntaxNode, known: FrozenSet[str]) -> _Bounds:
    """Return the bounds that a comparison, or a conjunction of comparisons, sets."""
    if condition.kind == "and":
        return frozenset(bound for part in condition.parts for bound in _bounds(part, known))
    if condition.kind != "comparison" or condition.text not in _MIRRORED:
        return frozenset()
    (left, right), operator = condition.parts, condition.text
    return frozenset([*_bound(left, operator, right, known), *_bound(right, _MIRRORED[operator], left, known)])


def _bound(left: SyntaxNode, operator: str, right: SyntaxNode, known: FrozenSet[str]) -> Iterator[_Bound]:
    if left.kind != "variable" or left.text not in known:
        return
    direction = -1 if operator in (">", ">=") else 1
    if right.kind == "variable" and right.text in known:
        yield _Bound(left.text, direction, right.text)
    elif right.kind == "constant" and right.text.isdecimal():
        yield _Bound(left.text, direction, None)


def _approaches(call: SyntaxNode, bounds: _Bounds, procedure: SyntaxNode) -> Iterator[Tuple[int, int]]:
    """Yield the positions of the arguments that approach a bound in a call, with the direction, 1 or -1."""
    names = [one.text for one in parameters(procedure)]
    same = {name for name, one in zip(names, call.parts) if one.kind == "variable" and one.text == name}
    for place, (name, argument) in enumerate(zip(names, call.parts)):
        for bound in bounds:
            if bound.name == name and bound.other in {None, *same} and _direction(argument, name) == bound.direction:
                yield place, bound.direction


def _direction(term: SyntaxNode, name: str) -> int:
    """Return 1 for a variable plus a number, -1 for a variable minus a number, else 0."""
    if term.kind != "operation" or term.text not in ("+", "-"):
        return 0
    left, step = term.parts
    if left.kind != "variable" or left.text != name or step.kind != "constant" or not step.text.strip('0"'):
        return 0
    return (1 if term.text == "+" else -1) if step.text.isdecimal() else 0
