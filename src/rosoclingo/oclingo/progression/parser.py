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
        yield _UpdateReader(tokens).read()


def strings_as_constants(update: StreamUpdate) -> StreamUpdate:
    """Return ``update`` with a constant for each string, spelled like the string with its quotes.

    oClingo read strings in this way (case *bodies* of ``oclingo_golden.json``). The constant prints like the string,
    but differs from every string of the program.
    """
    text = str(update)
    if '"' not in text:
        return update
    return replace(_UpdateReader(TokenStream(text, strings_as_constants=True)).read().update, warnings=update.warnings)


class _UpdateReader:
    """Reads one update from a token stream."""

    def __init__(self, tokens: TokenStream) -> None:
        self._tokens = tokens
        self._step: Optional[int] = None
        self._bound: Optional[int] = None
        self._items: List[Item] = []
        self._places: List[Tuple[int, int]] = []
        self._warnings: List[str] = []

    def read(self) -> PlacedUpdate:
        """Return the next update; raises ProgressionError."""
        while True:
            if self._tokens.next.kind != "directive":
                if self._tokens.next.kind == "end":
                    self._tokens.fail("incomplete update: expected a statement or '#endstep.'")
                self._record_place()
                self._items.append(_read_statement(self._tokens))
            elif self._read_directive():
                update = StreamUpdate(self._step, self._bound, tuple(self._items), tuple(self._warnings))
                return PlacedUpdate(update, tuple(self._places))

    def _record_place(self) -> None:
        """Record the place of the next item."""
        self._places.append(self._tokens.place(self._tokens.next.offset))

    def _read_directive(self) -> bool:
        """Read a directive; return whether it ends the update."""
        name = "".join(self._tokens.next.text.split())
        if name == "#step":
            self._read_step()
        elif name in _DIRECTIVES:
            self._record_place()
            self._tokens.take()
            self._items.append(_DIRECTIVES[name](self._tokens))
        elif name == "#endstep":
            self._tokens.take()
        else:
            known = ", ".join(sorted(["#step", "#endstep", *list(_DIRECTIVES)]))
            self._tokens.fail(f"unknown directive; known directives are {known}")
        self._tokens.expect(".", f"to end {name}")
        return name in ("#endstep", "#stop")

    def _read_step(self) -> None:
        line, _ = self._tokens.place(self._tokens.take().offset)
        step = read_number(self._tokens, "the step")
        bound = read_number(self._tokens, "the bound") if self._tokens.accept(":") else None
        if self._step is None:
            self._step, self._bound = step, bound
        else:
            text = f"New '#step {step}.' without prior '#endstep.' encountered in line {line}. Ignoring...."
            self._warnings.append(text)


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
