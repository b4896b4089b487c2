"""The history of the solver as rows of the persisted state."""

from typing import Dict, List

from rosoclingo.planning.history import Checkpoint, Entry, History
from rosoclingo.reasoning.records import PersistentPart, Record, tables


class RecordedHistory(PersistentPart):
    """The entries that a resumed core needs; the name of an entry's row stays the same while the entry exists.

    Attributes:
        history: the history of these entries.

    """

    GROUP = "history"
    TABLES = tables(_entries=("log", str, Entry))

    def __init__(self) -> None:
        self.history = History()
        self._names: Dict[History, str] = {}  # the name of the last entry
        self._count = 0
        self._entries: Dict[str, Entry] = {}

    def follow(self, history: History) -> None:
        """Continue with a new ``history``."""
        names, self._names, self._entries = self._names, {}, {}
        for one in _needed(history):
            assert one.entry is not None
            self._count += one not in names
            self._names[one] = names.get(one, str(self._count))
            self._entries[self._names[one]] = one.entry
        self.history = history

    def restore(self, record: Record) -> None:
        """Restore the history from its rows."""
        super().restore(record)
        self.history = History()
        for name, entry in self._entries.items():
            self.history = self.history.with_entries(entry)
            self._names[self.history], self._count = name, int(name)


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
