"""Patterns of atoms: atoms of rules with variables, and partly known atoms."""

from typing import Dict, Mapping, Optional, Tuple, Union

import clingo
from clingo.ast import ASTType, UnaryOperator

from rosoclingo.oclingo.program.nodes import Node, parse
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.progression.terms import Signature

Pattern = Union[None, str, clingo.Symbol, Tuple[str, Tuple["Pattern", ...]]]  # type: ignore[misc]
"""A term: None for any term, a variable's name, a ground term, or a function's name with arguments."""

Bound = Dict[str, Pattern]


def pattern_of(text: str, constants: Mapping[str, clingo.Symbol]) -> Pattern:
    """Return the pattern of an atom from its text in a rule."""
    term = parse(f"{text}.")[-1].head.atom.symbol
    bare = term.argument if term.ast_type == ASTType.UnaryOperation else term
    name = f"-{_name(bare)}" if bare is not term else _name(bare)
    arguments = bare.arguments if bare.ast_type == ASTType.Function else ()
    return name, tuple(_term(one, constants) for one in arguments)


def _name(term: Node) -> str:
    return str(term.name if term.ast_type == ASTType.Function else term.symbol.name)


def _term(term: Node, constants: Mapping[str, clingo.Symbol]) -> Pattern:
    if term.ast_type == ASTType.Variable:
        return None if term.name == "_" else str(term.name)
    if term.ast_type == ASTType.Function and not term.external:
        return _joined(term.name, tuple(_term(one, constants) for one in term.arguments))
    if term.ast_type == ASTType.UnaryOperation and term.operator_type != UnaryOperator.Minus:
        return None
    return evaluate(term, dict(constants))


def atom_pattern(atom: clingo.Symbol) -> Pattern:
    """Return the pattern of a ground atom."""
    return (atom.name if atom.positive else f"-{atom.name}"), tuple(atom.arguments)


def signature_in(pattern: Pattern) -> Signature:
    """Return the signature of an atom's pattern."""
    assert isinstance(pattern, tuple)
    name, arguments = pattern
    return Signature(name.lstrip("-"), len(arguments), not name.startswith("-"))


def filled(pattern: Pattern, bound: Bound) -> Pattern:
    """Return a pattern with its variables replaced; unbound variables match any term."""
    if isinstance(pattern, str):
        return bound.get(pattern)
    if isinstance(pattern, tuple):
        return pattern[0], tuple(_grounded(filled(one, bound)) for one in pattern[1])
    return pattern


def fits(pattern: Pattern, wanted: Pattern, bound: Bound) -> bool:
    """Return whether a pattern unifies with ``wanted``, which has no variables; extends ``bound``."""
    if pattern is None:
        return True
    if isinstance(pattern, str):
        known = bound.get(pattern)
        if known is not None and not fits(known, wanted, bound):
            return False
        bound[pattern] = wanted if known is None else known
        return True
    if wanted is None:
        return True
    mine, its = _parts(pattern), _parts(wanted)
    if mine is None or its is None:
        return mine is its and pattern == wanted
    same = mine[0] == its[0] and len(mine[1]) == len(its[1])
    return same and all(fits(one, other, bound) for one, other in zip(mine[1], its[1]))


def shown(pattern: Pattern, time: Optional[int] = None) -> str:
    """Return a pattern as text; the argument at position ``time`` is printed as ``t``."""
    if pattern is None:
        return "_"
    if not isinstance(pattern, tuple):
        return str(pattern)
    name, arguments = pattern
    texts = ["t" if number == time else shown(one) for number, one in enumerate(arguments)]
    return f"{name}({','.join(texts)})" if texts or not name else name


def _parts(pattern: Pattern) -> Optional[Tuple[str, Tuple[Pattern, ...]]]:
    """Return name and arguments of a compound term, None for other terms."""
    if isinstance(pattern, tuple):
        return pattern
    if isinstance(pattern, clingo.Symbol) and pattern.type is clingo.SymbolType.Function and pattern.arguments:
        return (pattern.name if pattern.positive else f"-{pattern.name}"), tuple(pattern.arguments)
    return None


def _joined(name: str, arguments: Tuple[Pattern, ...]) -> Pattern:
    return (name, arguments) if arguments or not name else clingo.Function(name)


def _grounded(pattern: Pattern) -> Pattern:
    """Return a compound term as a symbol if it is ground."""
    if isinstance(pattern, tuple) and all(isinstance(one, clingo.Symbol) for one in pattern[1]):
        arguments = [one for one in pattern[1] if isinstance(one, clingo.Symbol)]
        return clingo.Function(pattern[0].lstrip("-"), arguments, not pattern[0].startswith("-"))
    return pattern
