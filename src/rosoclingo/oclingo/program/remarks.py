"""What is odd about a program: it can be used, but hardly as it is meant. Each remark names place and mend."""

from difflib import get_close_matches
from typing import Any, Collection, Dict, Iterable, Iterator, List, Optional, Sequence, Set, Tuple

import clingo
from clingo.ast import AST, ASTSequence, ASTType

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.checks import KEYWORDS, places
from rosoclingo.oclingo.program.parts import Part
from rosoclingo.oclingo.progression.terms import Signature

_OWN = "__oclingo"


def undefined(parts: Sequence[Part], defined: Set[Signature]) -> List[Fault]:
    """Return, once for each, the predicates that the program mentions though nothing can make them true.

    ``defined`` are the predicates of rules' heads and externals.
    """
    silenced = {one for part in parts for one in _signatures_of(part, ASTType.Defined)}
    found: Dict[Signature, Fault] = {}
    for signature, statement in [*_in_bodies(parts), *_shown(parts)]:
        if signature not in found and signature not in defined | silenced and not signature.name.startswith(_OWN):
            begin = statement.location.begin
            message = f"no rule and no #external defines {signature}: it is never true"
            place = (begin.filename, begin.line, begin.column)
            found[signature] = Fault(*place, message, _mend(signature, defined))
    return list(found.values())


def _in_bodies(parts: Sequence[Part]) -> Iterator[Tuple[Signature, AST]]:
    for place in places(parts):
        if not place.occurrence.head:
            yield place.occurrence.signature, place.statement


def _shown(parts: Sequence[Part]) -> Iterator[Tuple[Signature, AST]]:
    for part in parts:
        for statement in part.statements:
            # "#show." itself is a signature without a name
            if statement.ast_type == ASTType.ShowSignature and statement.name:
                yield Signature(statement.name, statement.arity, bool(statement.positive)), statement


def _signatures_of(part: Part, kind: ASTType) -> Iterator[Signature]:
    for one in part.statements:
        if one.ast_type == kind:
            yield Signature(one.name, one.arity, bool(one.positive))


def _mend(signature: Signature, known: Set[Signature]) -> str:
    near = likely(signature, known | set(KEYWORDS.values()) if signature.name.startswith("_") else known)
    if near is not None:
        return f"is {near} meant? else write #defined {signature}."
    return f"write a rule or an #external for it, or #defined {signature}."


def likely(signature: Signature, known: Iterable[Signature]) -> Optional[Signature]:
    """Return the one of ``known`` that ``signature`` may have been meant to be, None where nothing is like it."""
    names: Dict[str, List[Signature]] = {}
    for one in sorted(known):
        if one != signature and not one.name.startswith(_OWN):
            names.setdefault(one.name, []).append(one)
    close = get_close_matches(signature.name, names, 1)
    if not close:
        return None
    return min(names[close[0]], key=lambda one: abs(one.arity - signature.arity))


def unknown_constants(parts: Sequence[Part], given: Iterable[str]) -> List[str]:
    """Return a remark for each constant that is given a value though the program has no such name."""
    statements = [one for part in parts for one in part.statements]
    own = {one.name for one in statements if one.ast_type == ASTType.Definition}
    strange = set(given) - own
    if strange:
        strange -= {name for statement in statements for name in constant_names(statement)}
    form = "constant {}: the program has no #const {} ({})"
    return [form.format(name, name, likely_constant(name, own)) for name in sorted(strange)]


def likely_constant(name: str, own: Collection[str]) -> str:
    """Return which of a program's ``own`` constants may be meant by ``name``, or which there are."""
    close = get_close_matches(name, sorted(own), 1)
    if close:
        return f"is {close[0]} meant?"
    return f"its constants are {', '.join(sorted(own))}" if own else "it has none"


def constant_names(node: AST) -> Iterator[str]:
    """Yield the names of all constants in a statement."""
    kind = clingo.SymbolType.Function
    if node.ast_type == ASTType.SymbolicTerm and node.symbol.type is kind and not node.symbol.arguments:
        yield node.symbol.name
    for key in node.child_keys:
        child = getattr(node, key)
        inner: Iterable[Any] = child if isinstance(child, ASTSequence) else [child]
        for one in inner:
            if isinstance(one, AST):
                yield from constant_names(one)
