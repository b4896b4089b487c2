"""Patterns of terms: symbols in which names in upper case are variables, and :data:`ANY` stands for any term."""

import re
from functools import lru_cache
from itertools import product
from typing import Dict, FrozenSet, Optional, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import evaluate

Bound = Dict[str, clingo.Symbol]
"""The values of variables."""

Patterns = Tuple[clingo.Symbol, ...]
"""The patterns of a term: several for a pool or an interval."""

ANY = clingo.Function("__oclingo_any")

MOST = 300
"""Values of one term that are told apart."""

_VARIABLE = re.compile("_*[A-Z]")


def patterns_of(term: Node, values: Dict[str, clingo.Symbol]) -> Patterns:
    """Return the patterns of a term of a rule, given the values of constants and of the step."""
    kind = term.ast_type
    if kind == ASTType.Variable:
        return (ANY if term.name == "_" else clingo.Function(term.name),)
    if kind == ASTType.UnaryOperation and term.argument.ast_type == ASTType.Function:
        return tuple(clingo.Function(one.name, one.arguments, False) for one in patterns_of(term.argument, values))
    if kind == ASTType.Pool:
        found = tuple(one for part in term.arguments for one in patterns_of(part, values))
        return found if len(found) <= MOST else (ANY,)
    if kind == ASTType.Function and not term.external:
        rows = [patterns_of(one, values) for one in term.arguments]
        return _products(term.name, rows)
    if kind == ASTType.Interval:
        return _range(term, values)
    value = evaluate(term, values)
    return (ANY if value is None else value,)


def _products(name: str, rows: "list[Patterns]") -> Patterns:
    number = 1
    for row in rows:
        number *= len(row)
    if number > MOST:
        rows = [row if len(row) == 1 else (ANY,) for row in rows]
    return tuple(clingo.Function(name, row) for row in product(*rows))


def _range(term: Node, values: Dict[str, clingo.Symbol]) -> Patterns:
    ends = [evaluate(one, values) for one in (term.left, term.right)]
    numbers = [one.number for one in ends if one is not None and one.type is clingo.SymbolType.Number]
    if len(numbers) < 2 or numbers[1] - numbers[0] >= MOST:
        return (ANY,)
    return tuple(map(clingo.Number, range(numbers[0], numbers[1] + 1)))


def filled(pattern: clingo.Symbol, bound: Bound) -> clingo.Symbol:
    """Return a pattern with its variables replaced; unbound variables match any term."""
    if is_variable(pattern):
        return bound.get(pattern.name, ANY)
    if _is_compound(pattern):
        return clingo.Function(pattern.name, [filled(one, bound) for one in pattern.arguments], pattern.positive)
    return pattern


def fits(pattern: clingo.Symbol, wanted: clingo.Symbol, bound: Bound) -> bool:
    """Return whether a pattern unifies with ``wanted``, which has no variables; extends ``bound``."""
    if is_variable(pattern):
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


def shown(pattern: clingo.Symbol, time: Optional[int] = None) -> str:
    """Return a pattern as text; the argument at position ``time`` is printed as ``t``, any term as ``_``."""
    if time is not None:
        arguments = [clingo.Function("t") if number == time else one for number, one in enumerate(pattern.arguments)]
        pattern = clingo.Function(pattern.name, arguments, pattern.positive)
    return str(pattern).replace(ANY.name, "_")


@lru_cache(maxsize=1 << 14)
def names_of(pattern: clingo.Symbol) -> FrozenSet[str]:
    """Return the variables of a pattern; the name of :data:`ANY` for a part that can be anything."""
    if is_variable(pattern) or pattern == ANY:
        return frozenset({pattern.name})
    return frozenset().union(*map(names_of, arguments_in(pattern)))


@lru_cache(maxsize=1 << 14)
def is_variable(term: clingo.Symbol) -> bool:
    """Return whether a pattern is a variable."""
    return term.type is clingo.SymbolType.Function and not term.arguments and bool(_VARIABLE.match(term.name))


@lru_cache(maxsize=1 << 14)
def arguments_in(term: clingo.Symbol) -> Tuple[clingo.Symbol, ...]:
    """Return the arguments of a term, none of one that has no parts."""
    return tuple(term.arguments) if term.type is clingo.SymbolType.Function else ()


def _is_compound(term: clingo.Symbol) -> bool:
    return bool(arguments_in(term))
