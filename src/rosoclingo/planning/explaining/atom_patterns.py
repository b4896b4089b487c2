"""Patterns of terms: symbols with names in upper case as variables, and :data:`ANY` as a wildcard."""

import re
from functools import lru_cache
from itertools import product
from math import prod
from typing import Dict, FrozenSet, Optional, Tuple

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.errors import ProgressionError
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import evaluate
from rosoclingo.oclingo.progression.terms import parse_term

Bound = Dict[str, clingo.Symbol]
"""The values of variables."""

Patterns = Tuple[clingo.Symbol, ...]
"""The patterns of a term: several for a pool or an interval."""

ANY = clingo.Function("__oclingo_any")
"""The wildcard, which matches any term."""

MOST = 300
"""Greatest number of patterns of a term; terms with more become :data:`ANY`."""

_VARIABLE = re.compile("_*[A-Z]")
_TOKEN = re.compile(r'"(?:[^"\\\n]|\\.)*"|[\w\']+')
_MARK = "__oclingo_variable_"


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
        if prod(map(len, rows)) > MOST:
            rows = [row if len(row) == 1 else (ANY,) for row in rows]
        return tuple(clingo.Function(term.name, row) for row in product(*rows))
    if kind == ASTType.Interval:
        return _range(term, values)
    value = evaluate(term, values)
    return (ANY if value is None else value,)


def pattern_in(text: str) -> Optional[clingo.Symbol]:
    """Return the pattern in a text, ``goal(From,_,1)``; None for any other text."""
    try:
        return _with_variables(parse_term(_TOKEN.sub(lambda found: _marked(found.group()), text)))
    except ProgressionError:
        return None


def _marked(token: str) -> str:
    """Return a token, or a constant for a variable."""
    return ANY.name if token == "_" else f"{_MARK}{token}" if _VARIABLE.match(token) else token


def _with_variables(term: clingo.Symbol) -> clingo.Symbol:
    """Replace the constants of :func:`_marked` by variables."""
    if term.type is not clingo.SymbolType.Function:
        return term
    name = term.name[len(_MARK) :] if term.name.startswith(_MARK) else term.name
    return clingo.Function(name, [_with_variables(one) for one in term.arguments], term.positive)


def _range(term: Node, values: Dict[str, clingo.Symbol]) -> Patterns:
    ends = [evaluate(one, values) for one in (term.left, term.right)]
    numbers = [one.number for one in ends if one is not None and one.type is clingo.SymbolType.Number]
    if len(numbers) < 2 or numbers[1] - numbers[0] >= MOST:
        return (ANY,)
    return tuple(map(clingo.Number, range(numbers[0], numbers[1] + 1)))


def substitute(pattern: clingo.Symbol, bound: Bound) -> clingo.Symbol:
    """Replace the variables of a pattern by their values; unbound variables become :data:`ANY`."""
    if is_variable(pattern):
        return bound.get(pattern.name, ANY)
    if arguments_in(pattern):
        return clingo.Function(pattern.name, [substitute(one, bound) for one in pattern.arguments], pattern.positive)
    return pattern


def matches(pattern: clingo.Symbol, term: clingo.Symbol, bound: Bound) -> bool:
    """Return whether a pattern matches a term without variables; extends ``bound``."""
    if is_variable(pattern):
        known = bound.get(pattern.name)
        if known is None and term != ANY:
            bound[pattern.name] = term
        return known is None or matches(known, term, bound)
    if ANY in (pattern, term):
        return True
    if not (arguments_in(pattern) and arguments_in(term)):
        return pattern == term
    same = pattern.match(term.name, len(term.arguments), term.positive)
    return same and all(matches(one, other, bound) for one, other in zip(pattern.arguments, term.arguments))


def format_pattern(pattern: clingo.Symbol, time: Optional[int] = None) -> str:
    """Format a pattern; the argument at position ``time`` is printed as ``t``, :data:`ANY` as ``_``."""
    if time is not None:
        arguments = [clingo.Function("t") if number == time else one for number, one in enumerate(pattern.arguments)]
        pattern = clingo.Function(pattern.name, arguments, pattern.positive)
    return str(pattern).replace(ANY.name, "_")


@lru_cache(maxsize=1 << 14)
def names_of(pattern: clingo.Symbol) -> FrozenSet[str]:
    """Return the variables of a pattern, and the name of :data:`ANY` if it contains that."""
    if is_variable(pattern) or pattern == ANY:
        return frozenset({pattern.name})
    return frozenset().union(*map(names_of, arguments_in(pattern)))


@lru_cache(maxsize=1 << 14)
def is_variable(term: clingo.Symbol) -> bool:
    """Return whether a pattern is a variable."""
    return term.type is clingo.SymbolType.Function and not term.arguments and bool(_VARIABLE.match(term.name))


@lru_cache(maxsize=1 << 14)
def arguments_in(term: clingo.Symbol) -> Tuple[clingo.Symbol, ...]:
    """Return the arguments of a term; none if it is not a function."""
    return tuple(term.arguments) if term.type is clingo.SymbolType.Function else ()
