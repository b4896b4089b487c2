"""Strings in updates as oClingo read them.

oClingo took a string in an update for an identifier that is spelled with quotes: it prints alike, but no string of
the program equals it. ``golden.json``'s case *bodies* shows it. Solvers that stand in for oClingo do the same; the
core doesn't.
"""

from dataclasses import replace
from operator import is_not
from typing import Tuple

import clingo

from rosoclingo.oclingo.progression.updates import Item, Literal, Statement, StreamUpdate, Withdraw

MARK = "__oclingo_quoted"
"""The name under which :func:`marked` hides a constant that is spelled as a string."""


def strings_apart(update: StreamUpdate) -> StreamUpdate:
    """Return ``update`` with every string turned into a constant of the same text, quotes included."""
    items: Tuple[Item, ...] = tuple(map(_item, update.items))
    return replace(update, items=items) if any(map(is_not, items, update.items)) else update


def holds_string_apart(atom: clingo.Symbol) -> bool:
    """Tell whether ``atom`` holds such a constant, so that no program can know it."""
    if atom.name.startswith('"'):
        return True
    return any(one.type == clingo.SymbolType.Function and holds_string_apart(one) for one in atom.arguments)


def marked(symbol: clingo.Symbol) -> clingo.Symbol:
    """Return ``symbol`` with such constants so that they can be told from strings when they are printed."""
    if symbol.type != clingo.SymbolType.Function:
        return symbol
    if symbol.name.startswith('"'):
        return clingo.Function(MARK, [clingo.String(symbol.name)])
    return clingo.Function(symbol.name, [marked(one) for one in symbol.arguments], symbol.positive)


def from_marked(symbol: clingo.Symbol) -> clingo.Symbol:
    """Return the symbol that :func:`marked` took."""
    if symbol.type != clingo.SymbolType.Function:
        return symbol
    if symbol.name == MARK:
        return clingo.Function(symbol.arguments[0].string)
    return clingo.Function(symbol.name, [from_marked(one) for one in symbol.arguments], symbol.positive)


def _item(item: Item) -> Item:
    if isinstance(item, Withdraw):
        return Withdraw(_symbol(item.atom)) if _holds_string(item.atom) else item
    return _statement(item) if isinstance(item, Statement) else item


def _statement(statement: Statement) -> Statement:
    atoms = [one.atom for one in statement.body]
    if not any(map(_holds_string, atoms if statement.head is None else [statement.head, *atoms])):
        return statement
    head = None if statement.head is None else _symbol(statement.head)
    return Statement(head, tuple(Literal(_symbol(one.atom), one.positive) for one in statement.body))


def _holds_string(symbol: clingo.Symbol) -> bool:
    kind = symbol.type
    if kind == clingo.SymbolType.Function:
        return any(map(_holds_string, symbol.arguments))
    return bool(kind == clingo.SymbolType.String)


def _symbol(symbol: clingo.Symbol) -> clingo.Symbol:
    if symbol.type == clingo.SymbolType.String:
        return clingo.Function(str(symbol))
    if symbol.type == clingo.SymbolType.Function and symbol.arguments:
        return clingo.Function(symbol.name, [_symbol(one) for one in symbol.arguments], symbol.positive)
    return symbol
