"""Problems as lines of a log: each is said once, many of a kind are counted, and the count is said after a while."""

import re
from dataclasses import dataclass, field
from typing import Dict, List, Set, Tuple

from rosoclingo.reasoning.events import Problem
from rosoclingo.reasoning.keywords import shortened

#: Seconds in which the same is not said again, and after which it is said how much there was of it.
QUIET = 60.0

#: So many problems of one kind are said within that time, then they are counted.
FEW = 3

#: So many different problems of one interface, and of the core itself, are said within that time.
MANY = 10

#: Limit of interfaces that are distinguished within that time.
MOST_ORIGINS = 100

#: Characters of a problem that are told: its beginning, and its end, where the reason stands.
TOLD = 900

_NUMBERS = re.compile("[0-9]+")
_STRINGS = re.compile(r'"(?:[^"\\]|\\.)*"')
_INNERMOST = re.compile(r"\([^()]*\)")


@dataclass
class _Bucket:
    """Problems of one kind, or of one interface, since a time: the texts in the log, and those that are counted."""

    since: float
    said: Set[str] = field(default_factory=set)
    unsaid: int = 0
    latest: str = ""


class LogThrottle:
    """Limits the lines of a log. ``count`` is the number of all problems, ``latest`` the text of the last one.

    Problems of one interface are the same if their texts differ in numbers only; the core's own if their texts are the
    same. They are of one kind if they differ in numbers, strings and what stands in brackets: the arguments of atoms.
    """

    def __init__(self) -> None:
        self.count = 0
        self.latest = ""
        self._buckets: Dict[Tuple[str, str], _Bucket] = {}  # by origin and kind, without a kind for all of an origin
        self._counted: List[str] = []

    def take(self, problem: Problem, now: float) -> str:
        """Return the line for a problem at ``now`` (seconds of a clock that only goes forward), empty for none."""
        self.count += 1
        self.latest = shortened(f"cycle {problem.cycle}: {problem.message}", TOLD)
        self._forget(now)
        origin, text = self._origin(problem.origin), shortened(problem.message, TOLD)
        text = _NUMBERS.sub("", text) if origin else text
        every = self._buckets.setdefault((origin, ""), _Bucket(now))
        key = origin, _kind_of(text)
        kind = self._buckets.get(key, _Bucket(now))
        is_new = text not in kind.said and len(kind.said) < FEW and len(every.said) < MANY
        bucket = every if text not in kind.said and len(every.said) >= MANY else kind
        if not is_new:
            bucket.unsaid, bucket.latest = bucket.unsaid + 1, self.latest
            return ""
        self._buckets[key] = kind
        for one in (kind, every):
            one.said.add(text)
        if len(every.said) == MANY:
            return self.latest + "; its further problems are only counted for a minute"
        return self.latest + ("; more of the kind are only counted for a minute" if len(kind.said) == FEW else "")

    def _origin(self, origin: str) -> str:
        """The origin under which a problem is remembered; interfaces beyond the limit share one."""
        origin, known = shortened(origin), {one for one, _ in self._buckets}
        return origin if origin in known or len(known) < MOST_ORIGINS else "other interfaces"

    def counted(self, now: float) -> List[str]:
        """Return the lines that tell how many problems were not said, once their time is over; each line once."""
        self._forget(now)
        lines, self._counted = self._counted, []
        return lines

    def _forget(self, now: float) -> None:
        """Forget what was said long ago; what was not said is to be told as a number."""
        for key in [key for key, bucket in self._buckets.items() if now - bucket.since >= QUIET]:
            bucket = self._buckets.pop(key)
            if bucket.unsaid:
                self._counted.append(f"{bucket.unsaid} more {_whose(*key)} in a minute, the last: {bucket.latest}")


def _kind_of(text: str) -> str:
    """The text without numbers, strings and arguments; never empty."""
    text, before = _STRINGS.sub("", _NUMBERS.sub("", text)), ""
    while text != before:
        text, before = _INNERMOST.sub("", text), text
    return text or "?"


def _whose(origin: str, kind: str) -> str:
    if kind:
        return "of this kind"
    return f"from '{origin}'" if origin else "of the core's own"
