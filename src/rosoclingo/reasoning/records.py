"""Conversion of the core's state to JSON values: symbols, actions, plans and histories."""

from functools import lru_cache
from typing import Any, Dict, Iterable, List, Tuple

from clingo import Symbol

from rosoclingo.planning.history import Checkpoint, History, entry_from_message, entry_to_message
from rosoclingo.planning.text import symbol_list, symbols_to_text
from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.keywords import Action, action_of

#: The sections of a state by name, in order of arrival.
Record = Dict[str, Any]


#: Maximum number of cached texts, and maximum length of a cached text.
CACHED, SHORT = 4096, 200

_texts: Dict[Symbol, str] = {}


def text_of(symbol: Symbol) -> str:
    """Return a symbol as text for :func:`symbol_of`; short texts are cached."""
    text = _texts.get(symbol)
    if text is None:
        text = symbols_to_text([symbol])
        if len(text) <= SHORT:
            if len(_texts) >= CACHED:
                _texts.clear()
            _texts[symbol] = text
    return text


def symbol_of(text: str) -> Symbol:
    """Return the symbol of :func:`text_of`."""
    return symbol_list(text)[0]


@lru_cache(maxsize=128)  # each step needs the latest actions
def action_to_text(action: Action) -> str:
    """Return an action as text for :func:`symbol_of`."""
    return text_of(action.atom)


def actions_to_text(actions: Iterable[Action]) -> str:
    """Return actions, in order, as text."""
    return ",".join(text_of(action.atom) for action in actions)


def actions_of(text: str) -> Tuple[Action, ...]:
    """Return the actions of :func:`actions_to_text`."""
    return tuple(map(action_of, symbol_list(text)))


@lru_cache(maxsize=4)
def plan_to_value(plan: TaskPlan) -> Record:
    """Return a task plan as a plain value."""
    return {"actions": actions_to_text(plan.actions), "faults": list(plan.faults)}


def plan_of(value: Record) -> TaskPlan:
    """Return the plan of :func:`plan_to_value`."""
    return TaskPlan(actions_of(value["actions"]), tuple(value["faults"]))


def group(record: Record, name: str) -> Dict[str, Any]:
    """Return the sections ``name:KEY`` by their keys, in order."""
    start = name + ":"
    return {key[len(start) :]: value for key, value in record.items() if key.startswith(start)}


def keys_of(record: Record, name: str) -> List[str]:
    """Return the keys of the sections ``name:KEY``, in order."""
    return list(group(record, name))


class LogRecorder:
    """Records the entries of a history as sections; the name of a section stays the same while the entry exists."""

    def __init__(self) -> None:
        self._sections: Dict[History, Tuple[str, Any]] = {}
        self._count = 0

    def record(self, log: History) -> Record:
        """Return the sections of a history."""
        sections: Dict[History, Tuple[str, Any]] = {}
        for one in _needed(log):
            sections[one] = self._sections.get(one) or self._section(one)
        self._sections = sections
        return dict(sections.values())

    def _section(self, log: History) -> Tuple[str, Any]:
        assert log.entry is not None
        self._count += 1
        return f"log:{self._count}", entry_to_message(log.entry)


def log_of(record: Record) -> History:
    """Return the history of :meth:`LogRecorder.record`."""
    return History().with_entries(*map(entry_from_message, group(record, "log").values()))


def _needed(log: History) -> List[History]:
    """Return the histories since the last checkpoint before the last update, oldest first.

    A core that resumes can then still replace the last update.
    """
    found: List[History] = []
    before, passed, one = log.before_update, False, log
    while one.entry is not None:
        found.append(one)
        passed = passed or before is None or one is before
        if one.before is None or (passed and isinstance(one.entry, Checkpoint)):
            break
        one = one.before
    return found[::-1]
