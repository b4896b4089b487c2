"""Throttling of log messages about problems: repeated problems are counted, and the count is logged later."""

import re
from dataclasses import dataclass, field
from typing import Dict, List, Set, Tuple

from rosoclingo.reasoning.events import Problem
from rosoclingo.reasoning.keywords import shortened

#: Seconds of a period, in which no text is logged twice, and after which the count is logged.
QUIET = 60.0

#: Maximum number of problems of one kind that are logged in a period; further ones are counted.
FEW = 3

#: Maximum number of different problems of an interface, or of the core itself, that are logged in a period.
MANY = 10

#: Maximum number of interfaces that are distinguished in a period.
MOST_ORIGINS = 100

#: Maximum number of characters of a logged problem; longer texts are shortened in the middle.
LONGEST_LINE = 900

_NUMBERS = re.compile("[0-9]+")
_STRINGS = re.compile(r'"(?:[^"\\]|\\.)*"')
_INNERMOST = re.compile(r"\([^()]*\)")


@dataclass
class _Bucket:
    """The problems of one kind or one interface in a period: the logged texts, and the number of other problems."""

    since: float
    logged: Set[str] = field(default_factory=set)
    unlogged: int = 0
    latest: str = ""


class LogThrottle:
    """Limits the number of log messages about problems.

    Problems of an interface are equal if their texts differ only in numbers; problems of the core are equal if their
    texts are. Problems are of one kind if they differ only in numbers, strings and text in brackets, that is, in the
    arguments of atoms.

    Attributes:
        count: the number of all problems.
        latest: the text of the last problem.
        time: its time in seconds, minus infinity before the first.

    """

    def __init__(self) -> None:
        self.count = 0
        self.latest, self.time = "", float("-inf")
        self._buckets: Dict[Tuple[str, str], _Bucket] = {}  # by origin and kind; an empty kind stands for all kinds
        self._counted: List[str] = []

    def take(self, problem: Problem, now: float) -> str:
        """Return the log message for a problem, empty for none; ``now`` is in seconds of a monotonic clock."""
        self.count, self.time = self.count + 1, now
        self.latest = shortened(f"cycle {problem.cycle}: {problem.message}", LONGEST_LINE)
        self._forget(now)
        origin, text = self._origin(problem.origin), shortened(problem.message, LONGEST_LINE)
        text = _NUMBERS.sub("", text) if origin else text
        every = self._buckets.setdefault((origin, ""), _Bucket(now))
        key = origin, _kind_of(text)
        kind = self._buckets.get(key, _Bucket(now))
        is_new = text not in kind.logged and len(kind.logged) < FEW and len(every.logged) < MANY
        bucket = every if text not in kind.logged and len(every.logged) >= MANY else kind
        if not is_new:
            bucket.unlogged, bucket.latest = bucket.unlogged + 1, self.latest
            return ""
        self._buckets[key] = kind
        for one in (kind, every):
            one.logged.add(text)
        if len(every.logged) == MANY:
            return self.latest + "; its further problems are only counted for a minute"
        return self.latest + ("; more of this kind are only counted for a minute" if len(kind.logged) == FEW else "")

    def _origin(self, origin: str) -> str:
        """Return the origin under which a problem is counted; interfaces beyond the limit share one."""
        origin, known = shortened(origin), {one for one, _ in self._buckets}
        return origin if origin in known or len(known) < MOST_ORIGINS else "other interfaces"

    def counted(self, now: float) -> List[str]:
        """Return log messages with the number of suppressed problems of past periods, each once."""
        self._forget(now)
        lines, self._counted = self._counted, []
        return lines

    def _forget(self, now: float) -> None:
        """End past periods, and count their suppressed problems."""
        for key in [key for key, bucket in self._buckets.items() if now - bucket.since >= QUIET]:
            (origin, kind), bucket = key, self._buckets.pop(key)
            whose = "of this kind" if kind else f"from '{origin}'" if origin else "of the core's own"
            if bucket.unlogged:
                self._counted.append(f"{bucket.unlogged} more {whose} in a minute, the last: {bucket.latest}")


def _kind_of(text: str) -> str:
    """Return a text without numbers, strings and arguments; never empty."""
    text, before = _STRINGS.sub("", _NUMBERS.sub("", text)), ""
    while text != before:
        text, before = _INNERMOST.sub("", text), text
    return text or "?"
