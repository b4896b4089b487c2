"""Conversion of snapshots and symbols to plain values for JSON, and back."""

from typing import Any, Dict, FrozenSet, Iterable, Iterator, List, Sequence

import clingo

from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import Assert, Statement
from rosoclingo.oclingo.solving.stream_state import ClosedHeads, ForgottenSteps, StateItem, TimedStatement
from rosoclingo.planning.snapshot import Past, Snapshot

Message = Dict[str, Any]

_NUMBERS = ("step", "horizon", "bound", "min_horizon", "number", "keep_from")
"""The attributes of a snapshot that are numbers or None."""


def symbols_to_text(symbols: Iterable[clingo.Symbol]) -> str:
    """Return ``symbols`` as text, separated by commas."""
    return ",".join(map(str, symbols))


def symbol_list(text: str) -> List[clingo.Symbol]:
    """Return the symbols in the text of :func:`symbols_to_text`, in order.

    One call of clingo parses the symbols as a tuple, in half the time of separate calls.
    """
    return clingo.parse_term(f"({text},)").arguments if text else []


def symbols_from_text(text: str) -> FrozenSet[clingo.Symbol]:
    """Return the symbols in the text of :func:`symbols_to_text` as a set."""
    return frozenset(symbol_list(text))


def snapshot_to_message(snapshot: Snapshot) -> Message:
    """Return ``snapshot`` as a plain value; :func:`snapshot_from_message` reads it."""
    return {
        **{name: getattr(snapshot, name) for name in _NUMBERS},
        "items": [*map(_item_to_row, snapshot.items)],
        "closed": [[cycle, symbols_to_text(executed)] for cycle, executed in snapshot.closed.items()],
        "past": None if snapshot.past is None else _past_to_message(snapshot.past),
    }


def snapshot_from_message(message: Message) -> Snapshot:
    """Return the snapshot from the value of :func:`snapshot_to_message`."""
    return Snapshot(
        **{name: message[name] for name in _NUMBERS},
        items=tuple(_items_from_rows(message["items"])),
        closed={cycle: symbols_from_text(executed) for cycle, executed in message["closed"]},
        past=None if message["past"] is None else _past_from_message(message["past"]),
    )


def _item_to_row(item: StateItem) -> List[Any]:
    if isinstance(item, TimedStatement):
        lifetime = [str(item.lifetime.term)] if isinstance(item.lifetime, Assert) else item.lifetime
        return [str(item.statement), item.update, lifetime]
    if isinstance(item, ForgottenSteps):
        return [item.first, item.last, symbols_to_text(item.spared)]
    return [symbols_to_text(item.atoms)]


def _items_from_rows(rows: Sequence[List[Any]]) -> Iterator[StateItem]:
    """Yield the items of a snapshot; one call of the parser reads all statements."""
    texts = [row[0] for row in rows if len(row) > 1 and isinstance(row[0], str)]
    update = parse_update("\n".join([*texts, "#endstep."]))
    statements = (one for one in update.items if isinstance(one, Statement))
    for row in rows:
        if len(row) == 1:
            yield ClosedHeads(symbols_from_text(row[0]))
        elif isinstance(row[0], int):
            yield ForgottenSteps(row[0], row[1], symbols_from_text(row[2]))
        else:
            lifetime = Assert(clingo.parse_term(row[2][0])) if isinstance(row[2], list) else row[2]
            yield TimedStatement(next(statements), lifetime, row[1])


def _past_to_message(past: Past) -> Message:
    steps = [step for step, _ in past.shown]
    atoms = symbols_to_text([atom for _, atom in past.shown])
    return {"first": past.first, "facts": symbols_to_text(past.facts), "steps": steps, "shown": atoms}


def _past_from_message(message: Message) -> Past:
    shown = zip(message["steps"], symbol_list(message["shown"]))
    return Past(message["first"], symbols_from_text(message["facts"]), tuple(shown))
