"""Detection of endless recursion: procedures that call themselves before any action.

A recursion is finite if an argument counts down, or up, to a bound.
"""

from typing import Dict, FrozenSet, Iterator, List, NamedTuple, Sequence, Set, Tuple

from rosoclingo.golog.grammar import Procedures, Signature, choice, parameters, signature, statements
from rosoclingo.oclingo.grammars import SyntaxNode
from rosoclingo.oclingo.reachable import reachable

COUNTING = "if N > 0 { p(N - 1); }"
"""An example of a finite recursion, for messages."""

_LOOPS = ("while", "star", "every", "achieve")
_TOGETHER = ("seq", "conc", "prio", "order", "interrupts")


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


def _without_finite_recursion(calls: List[SyntaxNode], procedure: SyntaxNode) -> List[SyntaxNode]:
    """Remove the direct recursive calls of a procedure if an argument approaches a bound in all of them.

    The bound is in a condition of ``if``, ``while``, ``pick`` or ``test``, as in ``if N > 0 { p(N - 1); }``. The solver
    then needs no instances beyond it.
    """
    own = [call for call in calls if signature(call) == signature(procedure)]
    names = [one.text for one in parameters(procedure)]
    ways = [
        frozenset(_counters(call, names, in_scope, conditions))
        for call, in_scope, conditions in _calls(procedure.parts[-1], frozenset(names), ())
        if any(call is one for one in own)
    ]
    if not own or not frozenset.intersection(*ways):
        return calls
    return [call for call in calls if signature(call) != signature(procedure)]


def _calls(
    one: SyntaxNode, in_scope: FrozenSet[str], conditions: Sequence[SyntaxNode]
) -> Iterator[Tuple[SyntaxNode, FrozenSet[str], Sequence[SyntaxNode]]]:
    """Yield the calls in a statement, each with the parameters ``in_scope`` and the conditions that hold before it."""
    if one.kind == "step":
        yield one.parts[0], in_scope, conditions
    inside = conditions
    if one.kind in ("pick", "every"):
        variables, condition, _ = choice(one)
        in_scope, inside = in_scope - {variable.text for variable in variables}, [*conditions, condition]
    elif one.kind in ("if", "while"):
        inside = [*conditions, one.parts[0]]
    for part in statements(one):
        yield from _calls(part, in_scope, inside)
        if one.kind == "if":
            inside = conditions
        elif one.kind == "seq" and part.kind in ("test", "await"):
            inside = [*inside, part.parts[0]]


def _counters(
    call: SyntaxNode, names: Sequence[str], in_scope: FrozenSet[str], conditions: Sequence[SyntaxNode]
) -> Iterator[Tuple[int, int]]:
    """Yield the positions of the arguments that approach a bound in a call, with the direction, 1 or -1.

    ``names`` are the parameters of the procedure. The ``conditions`` hold before the call.
    """
    passed_on = frozenset(name for name, one in zip(names, call.parts) if one.kind == "variable" and one.text == name)
    for place, (name, argument) in enumerate(zip(names, call.parts)):
        direction = _direction(argument, name) if name in in_scope else 0
        if direction and any(_bounds(one, name, direction, passed_on & in_scope) for one in conditions):
            yield place, direction


def _bounds(condition: SyntaxNode, name: str, direction: int, fixed: FrozenSet[str]) -> bool:
    """Return whether a condition bounds a variable in a direction, by a number or a ``fixed`` variable."""
    if condition.kind == "and":
        return any(_bounds(part, name, direction, fixed) for part in condition.parts)
    if condition.kind != "comparison" or condition.text[0] not in "<>":
        return False
    less, greater = condition.parts if condition.text[0] == "<" else condition.parts[::-1]
    counter, bound = (less, greater) if direction == 1 else (greater, less)
    if counter.kind != "variable" or counter.text != name:
        return False
    return bound.text in fixed if bound.kind == "variable" else bound.kind == "constant" and bound.text.isdecimal()


def _direction(term: SyntaxNode, name: str) -> int:
    """Return 1 for a variable plus a number, -1 for a variable minus a number, else 0."""
    if term.kind != "operation" or term.text not in ("+", "-"):
        return 0
    left, step = term.parts
    if left.kind != "variable" or left.text != name or step.kind != "constant" or not step.text.strip('0"'):
        return 0
    return (1 if term.text == "+" else -1) if step.text.isdecimal() else 0
