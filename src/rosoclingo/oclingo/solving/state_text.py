"""A stream's state as plain values that JSON knows: what a checkpoint looks like outside this process."""

from typing import Any, Callable, Dict, FrozenSet, Iterable, List, Sequence

import clingo

from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.strings import MARK, from_marked, marked
from rosoclingo.oclingo.progression.updates import Literal, Statement
from rosoclingo.oclingo.solving.stream_state import Lapsing, Lifetime, Past, StreamState, Term

Message = Dict[str, Any]


def symbols_to_text(symbols: Iterable[clingo.Symbol]) -> str:
    """Return ``symbols``, separated by commas."""
    texts = ((str(one), one) for one in symbols)
    return ",".join(str(marked(one)) if '"' in text else text for text, one in texts)


def symbol_list(text: str) -> List[clingo.Symbol]:
    """Return the symbols that :func:`symbols_to_text` printed, in order.

    All are read with one call of clingo's own reader, as the arguments of one tuple; one by one takes twice the time.
    """
    symbols = clingo.parse_term(f"({text},)").arguments if text else []
    return [from_marked(one) for one in symbols] if MARK in text else symbols


def symbols_from_text(text: str) -> FrozenSet[clingo.Symbol]:
    """Return the set of the symbols that :func:`symbols_to_text` printed."""
    return frozenset(symbol_list(text))


def state_to_message(state: StreamState) -> Message:
    """Return ``state`` for :func:`state_from_message`."""
    return {
        "step": state.step,
        "horizon": state.horizon,
        "bound": state.bound,
        "permanent": _statements_to_text(state.permanent),
        "lapsing": _entries_to_message(state.lapsing),
        "waiting": _entries_to_message(state.waiting),
        "open_atoms": symbols_to_text(state.open_atoms),
        "forgotten": symbols_to_text(state.forgotten),
        "forgets_done": state.forgets_done,
        "closed_cycles": [[cycle, symbols_to_text(executed)] for cycle, executed in state.closed_cycles.items()],
        "keep_from": state.keep_from,
        "past": None if state.past is None else _past_to_message(state.past),
        "cyclic": state.cyclic,
        "settled": state.settled,
        "tried": state.tried,
        "told": sorted(state.told),
    }


def state_from_message(message: Message) -> StreamState:
    """Return the state that :func:`state_to_message` took."""
    return StreamState(
        step=message["step"],
        horizon=message["horizon"],
        bound=message["bound"],
        permanent=_statements_from_text(message["permanent"]),
        lapsing=_entries_from_message(message["lapsing"]),
        waiting=_entries_from_message(message["waiting"]),
        open_atoms=symbol_list(message["open_atoms"]),
        forgotten=set(symbols_from_text(message["forgotten"])),
        forgets_done=message["forgets_done"],
        closed_cycles={cycle: symbols_from_text(executed) for cycle, executed in message["closed_cycles"]},
        keep_from=message["keep_from"],
        past=None if message["past"] is None else _past_from_message(message["past"]),
        cyclic=message["cyclic"],
        settled=message["settled"],
        tried=message["tried"],
        told=set(message["told"]),
    )


def _statements_to_text(statements: Iterable[Statement]) -> str:
    texts = ((str(one), one) for one in statements)
    return "\n".join(str(_mapped(one, marked)) if '"' in text else text for text, one in texts)


def _statements_from_text(text: str) -> List[Statement]:
    items = parse_update(f"{text}\n#endstep.").items
    found = [item for item in items if isinstance(item, Statement)]
    return [_mapped(one, from_marked) for one in found] if MARK in text else found


def _mapped(statement: Statement, change: Callable[[clingo.Symbol], clingo.Symbol]) -> Statement:
    head = None if statement.head is None else change(statement.head)
    return Statement(head, tuple(Literal(change(one.atom), one.positive) for one in statement.body))


def _entries_to_message(entries: Sequence[Lapsing]) -> Message:
    lifetimes = [_lifetime_to_value(entry.lifetime) for entry in entries]
    return {"statements": _statements_to_text(entry.statement for entry in entries), "lifetimes": lifetimes}


def _entries_from_message(message: Message) -> List[Lapsing]:
    lifetimes = [_lifetime_from_value(value) for value in message["lifetimes"]]
    return [Lapsing(*pair) for pair in zip(_statements_from_text(message["statements"]), lifetimes)]


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
