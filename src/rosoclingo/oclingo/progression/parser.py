"""The parser of online progressions, the inverse of ``str()`` of :mod:`~rosoclingo.oclingo.progression.updates`.

Its only exception is :class:`ProgressionError`, with line and column.
"""

from dataclasses import replace
from typing import Callable, Dict, Iterator, List, NamedTuple, Optional, Tuple

import clingo

from rosoclingo.oclingo.errors import ProgressionError
from rosoclingo.oclingo.progression.terms import TokenStream, read_atom, read_number, read_term
from rosoclingo.oclingo.progression.updates import (
    Assert,
    CloseCycles,
    Cumulative,
    Expire,
    Forget,
    Item,
    Literal,
    Reset,
    Retract,
    Statement,
    Stop,
    StreamUpdate,
    Volatile,
    Withdraw,
)


class PlacedUpdate(NamedTuple):
    """An update and the places of its items as lines and columns, counted from 1."""

    update: StreamUpdate
    places: Tuple[Tuple[int, int], ...]


def parse_update(text: str) -> StreamUpdate:
    """Return the only update of ``text``; raise :class:`ProgressionError` if it has none or several."""
    updates = parse_updates(text)
    if len(updates) != 1:
        raise ProgressionError(1, 1, f"expected one update, ended by #endstep., found {len(updates)}")
    return updates[0]


def parse_updates(text: str) -> List[StreamUpdate]:
    """Return the updates of ``text``, each ended by ``#endstep.``, ``#end step.`` or ``#stop.``"""
    return list(iterate_updates(text))


def iterate_updates(text: str) -> Iterator[StreamUpdate]:
    """Yield the updates of ``text`` one by one; an error is raised after the updates before it."""
    return (one.update for one in iterate_placed(text))


def iterate_placed(text: str) -> Iterator[PlacedUpdate]:
    """Yield the updates of ``text`` as :func:`iterate_updates` does, with the places of their items."""
    tokens = TokenStream(text)
    while tokens.next.kind != "end":
        yield _read_update(tokens)


def strings_as_constants(update: StreamUpdate) -> StreamUpdate:
    """Return ``update`` with a constant for each string, spelled like the string with its quotes.

    oClingo read strings in this way (case *bodies* of ``oclingo_golden.json``). The constant prints like the string,
    but differs from every string of the program.
    """
    text = str(update)
    if '"' not in text:
        return update
    return replace(_read_update(TokenStream(text, strings_as_constants=True)).update, warnings=update.warnings)


def _read_update(tokens: TokenStream) -> PlacedUpdate:
    step: Optional[int] = None
    bound: Optional[int] = None
    items: List[Item] = []
    places: List[Tuple[int, int]] = []
    warnings: List[str] = []
    name = ""
    while name not in ("#endstep", "#stop"):
        place = tokens.place(tokens.next.offset)
        if tokens.next.kind == "end":
            tokens.fail("incomplete update: expected a statement or '#endstep.'")
        if tokens.next.kind != "directive":
            items.append(_read_statement(tokens))
            places.append(place)
            continue
        name = "".join(tokens.next.text.split())
        known = sorted(["#step", "#endstep", *_DIRECTIVES])
        if name not in known:
            tokens.fail(f"unknown directive; known directives are {', '.join(known)}")
        tokens.take()
        if name in _DIRECTIVES:
            items.append(_DIRECTIVES[name](tokens))
            places.append(place)
        elif name == "#step":
            given = read_number(tokens, "the step")
            limit = read_number(tokens, "the bound") if tokens.accept(":") else None
            if step is None:
                step, bound = given, limit
            else:
                text = f"New '#step {given}.' without prior '#endstep.' encountered in line {place[0]}. Ignoring...."
                warnings.append(text)
        tokens.expect(".", f"to end {name}")
    return PlacedUpdate(StreamUpdate(step, bound, tuple(items), tuple(warnings)), tuple(places))


def _read_range(tokens: TokenStream) -> Tuple[int, int]:
    first = read_number(tokens, "a step")
    return first, read_number(tokens, "the last step") if tokens.accept("..") else first


def _read_name(tokens: TokenStream, directive: str) -> clingo.Symbol:
    tokens.expect(":", f"and a term after {directive}")
    return read_term(tokens)


_DIRECTIVES: Dict[str, Callable[[TokenStream], Item]] = {
    "#cumulative": lambda tokens: Cumulative(),
    "#volatile": lambda tokens: Volatile(read_number(tokens, "the window") if tokens.accept(":") else None),
    "#forget": lambda tokens: Forget(*_read_range(tokens)),
    "#closed": lambda tokens: CloseCycles(*_read_range(tokens)),
    "#over": lambda tokens: Expire(read_number(tokens, "a step")),
    "#withdraw": lambda tokens: Withdraw(read_atom(tokens)),
    "#anew": lambda tokens: Reset(),
    "#assert": lambda tokens: Assert(_read_name(tokens, "#assert")),
    "#retract": lambda tokens: Retract(_read_name(tokens, "#retract")),
    "#stop": lambda tokens: Stop(),
}


def _read_statement(tokens: TokenStream) -> Statement:
    head = None if tokens.at(":-") else read_atom(tokens)
    body: List[Literal] = []
    if tokens.accept(":-") and not tokens.at("."):
        body.append(_read_literal(tokens))
        while tokens.accept(","):
            body.append(_read_literal(tokens))
    tokens.expect(".", "to end the statement")
    return Statement(head, tuple(body))


def _read_literal(tokens: TokenStream) -> Literal:
    positive = not tokens.accept("not")
    return Literal(read_atom(tokens), positive)
