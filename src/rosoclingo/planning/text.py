"""Conversion of snapshots and symbols to plain values for JSON, and back."""

from typing import Any, Dict, FrozenSet, Iterable, List, Sequence, Tuple, Union

import clingo

from rosoclingo.oclingo.progression.lifetimes import FOREVER, Lifetime, Term
from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import Statement
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
        **_items_to_message(snapshot.items),
        "closed": [[cycle, symbols_to_text(executed)] for cycle, executed in snapshot.closed.items()],
        "past": None if snapshot.past is None else _past_to_message(snapshot.past),
    }


def snapshot_from_message(message: Message) -> Snapshot:
    """Return the snapshot from the value of :func:`snapshot_to_message`."""
    return Snapshot(
        **{name: message[name] for name in _NUMBERS},
        items=_items_from_message(message),
        closed={cycle: symbols_from_text(executed) for cycle, executed in message["closed"]},
        past=None if message["past"] is None else _past_from_message(message["past"]),
    )


def _items_to_message(items: Sequence[StateItem]) -> Message:
    """Return statements, their updates and lifetimes, and the other items with their places; FOREVER is left out."""
    entries = [one for one in items if isinstance(one, TimedStatement)]
    lifetimes = [[place, _lifetime_to_value(one.lifetime)] for place, one in enumerate(entries)]
    return {
        "statements": "\n".join(str(one.statement) for one in entries),
        "updates": [one.update for one in entries],
        "lifetimes": [one for one in lifetimes if one[1] != FOREVER],
        "others": [
            [place, *_other_to_values(one)] for place, one in enumerate(items) if not isinstance(one, TimedStatement)
        ],
    }


def _items_from_message(message: Message) -> Tuple[StateItem, ...]:
    lifetimes = {place: _lifetime_from_value(value) for place, value in message["lifetimes"]}
    pairs = zip(_statements_from_text(message["statements"]), message["updates"])
    items: List[StateItem] = [
        TimedStatement(one, lifetimes.get(place, FOREVER), number) for place, (one, number) in enumerate(pairs)
    ]
    for place, text, steps in message["others"]:
        atoms = symbols_from_text(text)
        items.insert(place, ForgottenSteps(steps[0], steps[1], atoms) if steps else ClosedHeads(atoms))
    return tuple(items)


def _other_to_values(one: Union[ForgottenSteps, ClosedHeads]) -> List[Any]:
    if isinstance(one, ClosedHeads):
        return [symbols_to_text(one.atoms), []]
    return [symbols_to_text(one.spared), [one.first, one.last]]


def _statements_from_text(text: str) -> List[Statement]:
    return [item for item in parse_update(f"{text}\n#endstep.").items if isinstance(item, Statement)]


def _lifetime_to_value(lifetime: Lifetime) -> Any:
    return [symbols_to_text([lifetime.term])] if isinstance(lifetime, Term) else lifetime


def _lifetime_from_value(value: Any) -> Lifetime:
    return Term(symbol_list(value[0])[0]) if isinstance(value, list) else value


def _past_to_message(past: Past) -> Message:
    steps = [step for step, _ in past.shown]
    atoms = symbols_to_text([atom for _, atom in past.shown])
    return {"first": past.first, "facts": symbols_to_text(past.facts), "steps": steps, "shown": atoms}


def _past_from_message(message: Message) -> Past:
    shown = zip(message["steps"], symbol_list(message["shown"]))
    return Past(message["first"], symbols_from_text(message["facts"]), tuple(shown))
