"""Facts that wait for the core's worker: a bounded queue for each node that sends some."""

import re
import threading
from collections import OrderedDict, deque
from typing import Container, Deque, Dict, List, NamedTuple, Optional, Sequence, Tuple

from rosoclingo.reasoning.keywords import LONGEST, RETURN, shortened
from rosoclingo.reasoning.returns import MOST_FACTS, MOST_WAITING, too_many_facts

#: Limit of characters of one node's queued facts.
MOST_TEXT = 1 << 24

#: Limit of one node's returns that are queued beyond the limit of facts.
MOST_RETURNS = 1000

#: Limit of kinds of ignored facts that are counted separately between two reports.
MOST_KINDS = 100

_NAME = re.compile(r"\s*-?\s*([_']*[a-z][A-Za-z0-9_']*)")


class Sent(NamedTuple):
    """A message of a node; without facts it announces that the node serves the interface."""

    node: str
    interface: str
    facts: Tuple[str, ...]


class Ignored(NamedTuple):
    """Ignored facts of one kind: the last one, and the reason, empty if it follows from the fact."""

    interface: str
    text: str
    why: str
    times: int


class _Line:
    """The messages of one node, in order."""

    def __init__(self) -> None:
        self.messages: Deque[Sent] = deque()
        self.number = self.size = self.returns = 0

    def add(self, message: Sent, sign: int = 1) -> None:
        """Count a message as queued; with the ``sign`` -1 no longer."""
        self.number += sign * max(1, len(message.facts))
        self.size += sign * sum(map(len, message.facts))
        self.returns += sign * any(map(_is_return, message.facts))


class FactQueue:
    """The facts of all nodes, put by rospy's threads and taken by the worker; ``names`` are of declared externals.

    Facts of one node keep their order. The nodes take turns, and every other turn is for a node with a queued return.
    Facts whose predicate has another name, or that exceed a limit, are only counted.
    """

    def __init__(self, names: Container[str]) -> None:
        self._names = names
        self._lock = threading.Lock()
        self._lines: OrderedDict[str, _Line] = OrderedDict()
        self._ignored: Dict[Tuple[str, str, str], Ignored] = {}
        self._urgent = False  # whether the next turn is for a return

    @property
    def waiting(self) -> bool:
        """Whether anything waits to be taken."""
        return bool(self._lines)

    def put(self, node: str, interface: str, facts: Sequence[str]) -> bool:
        """Queue a message of a node; return True if the queue was empty before, so the worker has to be called."""
        interface, good = shortened(interface), []
        bad: List[Tuple[str, str]] = []
        for text in facts[:MOST_FACTS]:
            if len(text) > LONGEST or self._is_hopeless(text):
                bad.append((text[: LONGEST + 1], ""))
            else:
                good.append(text)
        if len(facts) > MOST_FACTS:
            bad.append(("", too_many_facts(len(facts), interface)))
        with self._lock:
            called = bool(self._lines)
            if good or not facts:
                bad += self._add(node, interface, good)
            for text, why in bad:
                self._ignore(node, interface, text, why)
            return not called and bool(self._lines)

    def take(self) -> Optional[Sent]:
        """Return the next message, None if the queue is empty."""
        with self._lock:
            if not self._lines:
                return None
            self._urgent = not self._urgent
            urgent = (name for name, line in self._lines.items() if line.returns)
            node = next(urgent, "") if self._urgent else ""
            node = node or next(iter(self._lines))
            line = self._lines.pop(node)
            message = line.messages.popleft()
            line.add(message, -1)
            if line.messages:
                self._lines[node] = line
            return message

    def take_ignored(self) -> List[Ignored]:
        """Return the facts that were ignored since the last call."""
        with self._lock:
            ignored, self._ignored = self._ignored, {}
        return list(ignored.values())

    def _add(self, node: str, interface: str, facts: Sequence[str]) -> List[Tuple[str, str]]:
        """Append a message; return the facts that exceed a limit, with the reason."""
        line = self._lines.get(node) or _Line()
        number, size = MOST_WAITING - line.number, MOST_TEXT - line.size
        kept, left = [], []
        for text in facts:
            number, size = number - 1, size - len(text)
            if (number >= 0 and size >= 0) or (_is_return(text) and number >= -MOST_RETURNS):
                kept.append(text)
            else:
                number, size = number + 1, size + len(text)
                left.append((text, f"too much of {node} is queued"))
        if kept or (not facts and number > 0):
            message = Sent(node, interface, tuple(kept))
            line.messages.append(message)
            line.add(message)
            self._lines[node] = line
        return left

    def _ignore(self, node: str, interface: str, text: str, why: str) -> None:
        name = _NAME.match(text)
        key = (node, interface, why or (name.group(1) if name else ""))
        if key not in self._ignored and len(self._ignored) >= MOST_KINDS:
            key, interface = ("", "", ""), "other interfaces"
        before = self._ignored.get(key)
        self._ignored[key] = Ignored(interface, text, why, before.times + 1 if before else 1)

    def _is_hopeless(self, text: str) -> bool:
        """Tell, by the name, whether a text is no declared atom; a comment can precede the name."""
        name = _NAME.match(text)
        return "%" not in text if name is None else name.group(1) not in self._names


def _is_return(text: str) -> bool:
    name = _NAME.match(text)
    return name is not None and name.group(1) == RETURN
