"""Procedures that call themselves before they have done anything: what is left of them would have no end."""

from typing import AbstractSet, Dict, Iterator, List, Mapping, NamedTuple, Set, Tuple

from rosoclingo.languages.golog.descent import ways_of_calls
from rosoclingo.languages.golog.scanner import Token
from rosoclingo.languages.golog.tree import (
    AnyAction,
    Around,
    Branch,
    Check,
    Choosing,
    Loop,
    Procedure,
    Sequence,
    Several,
    Statement,
    Step,
)

Signature = Tuple[str, int]

COUNTING = "if N > 0 { p(N - 1); }"
"""A call that comes to an end, whatever has been done."""


class _Begin(NamedTuple):
    """How a program may begin: the calls before any action, and whether it may be over without one."""

    calls: List[Tuple[Signature, Token]]
    idle: bool


def endless_calls(
    procedures: Mapping[Signature, Procedure], own: AbstractSet[Signature]
) -> Iterator[Tuple[Token, str, str]]:
    """Yield, for each of a file's ``own`` procedures that may call itself before any action, the call's word.

    With it come what is wrong and the mend. The ``procedures`` are all that may be called.
    """
    idle: Set[Signature] = set()
    begins: Dict[Signature, _Begin] = {}
    before = -1
    while before != len(idle):
        before = len(idle)
        begins = {signature: _begin(one.body, procedures, idle) for signature, one in procedures.items()}
        idle |= {signature for signature, begin in begins.items() if begin.idle}
    begins = {signature: _without_ends(begin, signature, procedures[signature]) for signature, begin in begins.items()}
    for signature, begin in begins.items():
        for called, token in begin.calls if signature in own else ():
            if signature in _reached(called, begins):
                name = signature[0]
                mend = f"let an action come before the call, count down ({COUNTING}), or write a loop (while, star)"
                yield token, f"{name} may come to call itself again before it has done anything, without end", mend
                break


def _without_ends(begin: _Begin, signature: Signature, procedure: Procedure) -> _Begin:
    """Leave out the calls of a procedure of itself if an argument goes to a bound in all of them."""
    own = {token for called, token in begin.calls if called == signature}
    ways = [ways for token, ways in ways_of_calls(procedure) if token in own]
    if not own or not frozenset.intersection(*ways):
        return begin
    return begin._replace(calls=[(called, token) for called, token in begin.calls if called != signature])


def _reached(signature: Signature, begins: Mapping[Signature, _Begin]) -> Set[Signature]:
    found, waiting = {signature}, [signature]
    while waiting:
        for called, _ in begins[waiting.pop()].calls:
            if called not in found:
                found.add(called)
                waiting.append(called)
    return found


def _begin(one: Statement, procedures: Mapping[Signature, Procedure], idle: Set[Signature]) -> _Begin:
    """Return how a statement may begin; ``idle`` are the procedures known to be over without an action, at times."""

    def all_of(*parts: Statement) -> List[_Begin]:
        return [_begin(part, procedures, idle) for part in parts]

    if isinstance(one, Step):
        called = (one.what.token.text, len(one.what.arguments))
        return _Begin([(called, one.what.token)], called in idle) if called in procedures else _Begin([], False)
    if isinstance(one, AnyAction):
        return _Begin([], False)
    if isinstance(one, Check):
        return _Begin([], True)
    if isinstance(one, Sequence):
        calls: List[Tuple[Signature, Token]] = []
        for part in all_of(*one.statements):
            calls += part.calls
            if not part.idle:
                return _Begin(calls, False)
        return _Begin(calls, True)
    if isinstance(one, Several):
        parts = all_of(*one.parts)
        some = any(part.idle for part in parts) if one.kind == "choice" else all(part.idle for part in parts)
        return _Begin([call for part in parts for call in part.calls], some)
    return _begin_of_one(one, all_of(*_inner(one)))


def _inner(one: Statement) -> List[Statement]:
    if isinstance(one, Branch):
        return [one.yes, one.no]
    if isinstance(one, (Loop, Choosing)):
        return [one.body]
    assert isinstance(one, Around)
    return [one.body]


def _begin_of_one(one: Statement, parts: List[_Begin]) -> _Begin:
    calls = [call for part in parts for call in part.calls]
    always = isinstance(one, Loop) or (isinstance(one, Around) and one.kind == "star")
    always = always or (isinstance(one, Choosing) and one.kind == "every")
    return _Begin(calls, always or any(part.idle for part in parts))
