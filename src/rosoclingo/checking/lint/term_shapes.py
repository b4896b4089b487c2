"""Terms of rules, made ready once to be compared with many ground terms: clingo's own nodes are slow to ask."""

from functools import lru_cache
from typing import Dict, FrozenSet, Iterable, List, Mapping, NamedTuple, Optional, Set, Tuple, Union

import clingo
from clingo.ast import ASTType

from rosoclingo.oclingo.program.domains import names_in
from rosoclingo.oclingo.program.nodes import Node
from rosoclingo.oclingo.program.signatures import evaluate

Values = Optional[FrozenSet[clingo.Symbol]]
"""The values that a term may have; None for any."""

Bindings = Dict[str, FrozenSet[clingo.Symbol]]
"""The values that variables may have; one that is not there may have any."""

Head = Union[clingo.Symbol, Tuple[str, bool, int]]
"""Values with different ones are never equal, but for WILD: name, sign and arity, or a value without arguments."""

Inside = Dict[str, Set[clingo.Symbol]]

WILD = clingo.Function("__oclingo_any")
"""Stands inside a compound value for a part that may be anything."""

MOST = 300
"""So many values of one argument are told apart."""

_DEEPEST = 6  # terms of more levels are not told apart
_VARIABLE, _STEP, _COMPOUND, _POOL, _FIXED, _ANY = range(6)


class Shape(NamedTuple):
    """A term.

    Attributes:
        kind: what it is: a variable, the step, a compound term or tuple, a pool, fixed values, anything else.
        name: of a variable or a compound term.
        parts: of a compound term or a pool.
        values: those that are fixed.
        names: the variables in it.

    """

    kind: int
    name: str = ""
    parts: Tuple["Shape", ...] = ()
    values: FrozenSet[clingo.Symbol] = frozenset()
    names: Tuple[str, ...] = ()

    @property
    def variable(self) -> str:
        """The variable that it is; empty for any other term, and for ``_``."""
        return self.name if self.kind == _VARIABLE and self.name != "_" else ""

    @property
    def is_constant(self) -> bool:
        """Whether it has one value."""
        return self.kind == _FIXED and len(self.values) == 1


def fixed(symbol: clingo.Symbol) -> Shape:
    """Return the shape of a ground term."""
    return Shape(_FIXED, values=frozenset({symbol}))


def shape_of(term: Node, step: str, constants: Mapping[str, clingo.Symbol]) -> Shape:
    """Return the shape of a term in a part with this parameter, empty in base."""
    kind = term.ast_type
    if kind == ASTType.Variable:
        return Shape(_VARIABLE, term.name, names=(term.name,))
    if kind == ASTType.SymbolicTerm and step and str(term) == step:
        return Shape(_STEP)
    if kind == ASTType.Pool or (kind == ASTType.Function and not term.external):
        parts = tuple(shape_of(one, step, constants) for one in term.arguments)
        names = tuple(name for part in parts for name in part.names)
        pool = kind == ASTType.Pool
        return Shape(_POOL if pool else _COMPOUND, "" if pool else term.name, parts, names=names)
    values = _range(term, constants) if kind == ASTType.Interval else _value(term, step, constants)
    return Shape(_ANY, names=tuple(names_in(term))) if values is None else Shape(_FIXED, values=values)


def _value(term: Node, step: str, constants: Mapping[str, clingo.Symbol]) -> Values:
    value = None if _mentions(term, step) else evaluate(term, dict(constants))
    return None if value is None else frozenset({value})


def _range(term: Node, constants: Mapping[str, clingo.Symbol]) -> Values:
    ends = [evaluate(one, dict(constants)) for one in (term.left, term.right)]
    numbers = [one.number for one in ends if one is not None and one.type == clingo.SymbolType.Number]
    if len(numbers) < 2 or numbers[1] - numbers[0] > MOST:
        return None
    return frozenset(clingo.Number(one) for one in range(numbers[0], numbers[1] + 1))


def _mentions(term: Node, step: str) -> bool:
    if term.ast_type == ASTType.SymbolicTerm:
        return bool(step) and str(term) == step
    return any(_mentions(getattr(term, key), step) for key in ("left", "right", "argument") if hasattr(term, key))


# ---- what a shape may be --------------------------------------------------------------------------------------------


def matches(shape: Shape, symbol: clingo.Symbol, inside: Inside) -> bool:
    """Tell whether a term may be ``symbol``; what its variables are then is added to ``inside``."""
    if shape.kind == _FIXED:
        return symbol in shape.values or symbol == WILD
    if shape.kind == _VARIABLE:
        inside.setdefault(shape.name, set()).add(symbol)
        return True
    if symbol == WILD:
        for name in shape.names:
            inside.setdefault(name, set()).add(WILD)
        return True
    if shape.kind == _COMPOUND:
        if symbol.type != clingo.SymbolType.Function or symbol.name != shape.name or not symbol.positive:
            return False
        arguments = symbol.arguments
        if len(arguments) != len(shape.parts):
            return False
        return all(matches(part, value, inside) for part, value in zip(shape.parts, arguments))
    if shape.kind == _POOL:
        return any([matches(part, symbol, inside) for part in shape.parts])  # noqa: C419 each tells of its variables
    return bool(shape.kind == _ANY or symbol.type == clingo.SymbolType.Number)


def value_of(shape: Shape, bound: Bindings) -> Values:
    """Return what a term may be where variables are as ``bound``."""
    found = _value_of(shape, bound)
    if shape.kind == _VARIABLE:  # what it has was looked at when it was found
        return found
    return None if found is None or len(found) > MOST or any(_depth(one) > _DEEPEST for one in found) else found


def _value_of(shape: Shape, bound: Bindings) -> Values:
    if shape.kind == _VARIABLE:
        return bound.get(shape.name)
    if shape.kind == _FIXED:
        return shape.values
    if shape.kind == _POOL:
        return _union(_value_of(part, bound) for part in shape.parts)
    return _compound(shape, bound) if shape.kind == _COMPOUND else None


def _compound(shape: Shape, bound: Bindings) -> Values:
    rows: List[Tuple[clingo.Symbol, ...]] = [()]
    for part in shape.parts:
        values = value_of(part, bound)
        values = frozenset({WILD}) if values is None else values
        if len(values) * len(rows) > MOST:
            return None
        rows = [(*row, value) for row in rows for value in values]
    return frozenset(clingo.Function(shape.name, row) for row in rows)


def _union(parts: Iterable[Values]) -> Values:
    found: FrozenSet[clingo.Symbol] = frozenset()
    for part in parts:
        if part is None:
            return None
        found |= part
    return found


@lru_cache(maxsize=1 << 12)
def _depth(symbol: clingo.Symbol) -> int:
    return max((1 + _depth(one) for one in _parts(symbol).arguments), default=0)


# ---- sets of values -------------------------------------------------------------------------------------------------


def common(one: FrozenSet[clingo.Symbol], other: FrozenSet[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
    """Return what both sets may hold; too much where parts of values may be anything."""
    found, open_one, open_other = set(one & other), _open(one), _open(other)
    if open_one or open_other:  # two values that are fixed are one or they are not
        for mine, its, open_its in ((one - other, other, open_other), (other - one, one, open_one)):
            all_of, open_of = _by_head(its), _by_head(open_its)
            for value in mine:
                candidates = all_of if is_open(value) else open_of
                alike = candidates.get(_parts(value).head, ())
                if (value == WILD and its) or WILD in candidates or any(_may_equal(value, x) for x in alike):
                    found.add(value)
    return frozenset(found)


@lru_cache(maxsize=1 << 10)
def _open(values: FrozenSet[clingo.Symbol]) -> FrozenSet[clingo.Symbol]:
    return frozenset(filter(is_open, values))


@lru_cache(maxsize=1 << 10)
def _by_head(values: FrozenSet[clingo.Symbol]) -> Dict[Head, List[clingo.Symbol]]:
    found: Dict[Head, List[clingo.Symbol]] = {}
    for value in values:
        found.setdefault(_parts(value).head, []).append(value)
    return found


class Parts(NamedTuple):
    """A value taken apart: what two values have in common that may be equal, and the arguments of a compound one."""

    head: Head
    arguments: Tuple[clingo.Symbol, ...] = ()


@lru_cache(maxsize=1 << 14)
def _parts(symbol: clingo.Symbol) -> Parts:
    if symbol.type != clingo.SymbolType.Function or not symbol.arguments:
        return Parts(symbol)
    arguments = tuple(symbol.arguments)
    return Parts((symbol.name, symbol.positive, len(arguments)), arguments)


@lru_cache(maxsize=1 << 12)
def is_open(symbol: clingo.Symbol) -> bool:
    """Tell whether a part of a value may be anything."""
    return symbol == WILD or any(map(is_open, _parts(symbol).arguments))


@lru_cache(maxsize=1 << 14)
def _may_equal(one: clingo.Symbol, other: clingo.Symbol) -> bool:
    if one == other or WILD in (one, other):
        return True
    mine, its = _parts(one), _parts(other)
    return bool(mine.arguments) and mine.head == its.head and all(map(_may_equal, mine.arguments, its.arguments))


def restrict(found: Bindings, name: str, values: FrozenSet[clingo.Symbol]) -> bool:
    """Let a variable have these values alone; False where none is left."""
    if name != "_":
        found[name] = common(found[name], values) if name in found else values
        return bool(found[name])
    return bool(values)
