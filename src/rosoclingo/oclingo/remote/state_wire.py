"""A stream's state as a message between a ``SolverProcess`` and its worker."""

from typing import Any, Iterable, List, Sequence

from rosoclingo.oclingo.progression.parser import parse_update
from rosoclingo.oclingo.progression.updates import Statement
from rosoclingo.oclingo.remote.wire import Message, symbol_list, symbols_from_text, symbols_to_text
from rosoclingo.oclingo.solving.stream_state import Entry, Lifetime, Past, StreamState, Term


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
    )


def _statements_to_text(statements: Iterable[Statement]) -> str:
    return "\n".join(map(str, statements))


def _statements_from_text(text: str) -> List[Statement]:
    items = parse_update(f"{text}\n#endstep.").items
    return [item for item in items if isinstance(item, Statement)]


def _entries_to_message(entries: Sequence[Entry]) -> Message:
    lifetimes = [_lifetime_to_value(entry.lifetime) for entry in entries]
    return {"statements": _statements_to_text(entry.statement for entry in entries), "lifetimes": lifetimes}


def _entries_from_message(message: Message) -> List[Entry]:
    lifetimes = [_lifetime_from_value(value) for value in message["lifetimes"]]
    return [Entry(*pair) for pair in zip(_statements_from_text(message["statements"]), lifetimes)]


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
