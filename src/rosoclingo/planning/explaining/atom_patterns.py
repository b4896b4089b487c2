"""Patterns of atoms: symbols in which names in upper case are variables, and ``_`` stands for any term."""

import re
from typing import Dict, Mapping, Optional

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.nodes import Node, parse
from rosoclingo.oclingo.program.signatures import evaluate

Bound = Dict[str, clingo.Symbol]
"""The values of variables."""

ANY = clingo.Function("_")

_VARIABLE = re.compile("_*[A-Z]")


def pattern_of(text: str, constants: Mapping[str, clingo.Symbol]) -> clingo.Symbol:
    """Return the pattern of an atom from its text in a rule."""
    term = parse(f"{text}.")[-1].head.atom.symbol
    atom = term.argument if term.ast_type == ASTType.UnaryOperation else term
    if atom.ast_type == ASTType.Function:
        return clingo.Function(atom.name, [_term(one, constants) for one in atom.arguments], atom is term)
    return clingo.Function(atom.symbol.name, [], atom is term)


def _term(term: Node, constants: Mapping[str, clingo.Symbol]) -> clingo.Symbol:
    if term.ast_type == ASTType.Variable:
        return clingo.Function(term.name)
    if term.ast_type == ASTType.Function and not term.external:
        return clingo.Function(term.name, [_term(one, constants) for one in term.arguments])
    value = evaluate(term, dict(constants))
    return ANY if value is None else value


def filled(pattern: clingo.Symbol, bound: Bound) -> clingo.Symbol:
    """Return a pattern with its variables replaced; unbound variables match any term."""
    if _is_variable(pattern):
        return bound.get(pattern.name, ANY)
    if _is_compound(pattern):
        return clingo.Function(pattern.name, [filled(one, bound) for one in pattern.arguments], pattern.positive)
    return pattern


def fits(pattern: clingo.Symbol, wanted: clingo.Symbol, bound: Bound) -> bool:
    """Return whether a pattern unifies with ``wanted``, which has no variables; extends ``bound``."""
    if _is_variable(pattern):
        known = bound.get(pattern.name)
        if known is None and wanted != ANY:
            bound[pattern.name] = wanted
        return known is None or fits(known, wanted, bound)
    if ANY in (pattern, wanted):
        return True
    if not (_is_compound(pattern) and _is_compound(wanted)):
        return pattern == wanted
    same = pattern.match(wanted.name, len(wanted.arguments), wanted.positive)
    return same and all(fits(one, other, bound) for one, other in zip(pattern.arguments, wanted.arguments))


def shown(pattern: clingo.Symbol, time: Optional[int]) -> str:
    """Return an atom's pattern as text; the argument at position ``time`` is printed as ``t``."""
    arguments = [clingo.Function("t") if number == time else one for number, one in enumerate(pattern.arguments)]
    return str(clingo.Function(pattern.name, arguments, pattern.positive))


def _is_compound(term: clingo.Symbol) -> bool:
    return term.type is clingo.SymbolType.Function and bool(term.arguments)


def _is_variable(term: clingo.Symbol) -> bool:
    return term.type is clingo.SymbolType.Function and not term.arguments and bool(_VARIABLE.match(term.name))
