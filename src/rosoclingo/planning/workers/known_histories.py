"""The histories that a worker knows, as seen from its parent and from itself."""

from collections import OrderedDict
from typing import Dict, List, Optional

from rosoclingo.planning.history import Checkpoint, History, entry_from_message, entry_to_message
from rosoclingo.planning.workers.wire import Message

MOST = 32
"""Histories that a worker keeps, with their snapshots, so that to go back costs no reading."""


class Told:
    """The parent's view: which histories a worker knows, by number."""

    def __init__(self) -> None:
        self._numbers: OrderedDict[History, int] = OrderedDict()
        self._count = 0

    def telling(self, log: History) -> Message:
        """Return what tells the worker of ``log``: the nearest history that it knows, and the entries that follow."""
        unknown: List[History] = []
        known: Optional[History] = log
        while known is not None and known.entry is not None and known not in self._numbers:
            unknown.append(known)
            known = None if isinstance(known.entry, Checkpoint) else known.before
        start = None if known is None else self._numbers.get(known)
        unknown.reverse()
        entries = [one.entry for one in unknown if one.entry is not None]
        number = self._keep(log)
        forgotten = [self._numbers.popitem(last=False)[1] for _ in range(len(self._numbers) - MOST)]
        told = {"from": start, "entries": [*map(entry_to_message, entries)]}
        return {"history": {**told, "number": number, "forgotten": forgotten}}

    def note(self, log: History, number: int) -> None:
        """Note that the worker has come to ``log``, which it keeps by a ``number`` of :meth:`next_number`."""
        self._numbers[log] = number

    def next_number(self) -> int:
        """Return a number for the history to which a command leads."""
        self._count += 1
        return self._count

    def _keep(self, log: History) -> int:
        if log not in self._numbers:
            self._numbers[log] = self.next_number()
        self._numbers.move_to_end(log)
        return self._numbers[log]


class KnownHistories:
    """The worker's own view."""

    def __init__(self) -> None:
        self._histories: Dict[int, History] = {}

    def take(self, message: Message) -> History:
        """Return the history that the parent tells of."""
        log = self._histories.get(message["from"], History())
        log = log.then(*map(entry_from_message, message["entries"]))
        for number in message["forgotten"]:
            self._histories.pop(number, None)
        self._histories[message["number"]] = log
        return log

    def keep(self, number: int, log: History) -> None:
        """Keep a history under the number that the parent knows it by."""
        self._histories[number] = log
