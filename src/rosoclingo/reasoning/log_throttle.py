"""Problems as lines of a log: each is said once, many of a kind are counted, and the count is said after a while."""

import re
from dataclasses import dataclass
from typing import Dict, List, Tuple

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
class _Kind:
    """Problems of one kind since a time: how many were said, how many were not, and the last of these."""

    since: float
    said: int = 0
    unsaid: int = 0
    latest: str = ""

    def leave(self, text: str, times: int) -> None:
        """Count problems that are not logged."""
        if times:
            self.unsaid, self.latest = self.unsaid + times, text


class LogThrottle:
    """Limits the lines of a log. ``count`` is the number of all problems, ``latest`` the text of the last one.

    Problems of one interface are the same if their texts differ in numbers only; the core's own if their texts are the
    same. They are of one kind if they differ in numbers, strings and what stands in brackets: the arguments of atoms.
    """

    def __init__(self) -> None:
        self.count = 0
        self.latest = ""
        self._said: Dict[Tuple[str, str], float] = {}
        self._kinds: Dict[Tuple[str, str], _Kind] = {}
        self._counted: List[str] = []

    def take(self, problem: Problem, now: float) -> str:
        """The line for a problem at ``now`` (seconds of a clock that only goes forward), empty for none."""
        self.count += problem.times
        self.latest = shortened(f"cycle {problem.cycle}: {problem.message}", TOLD)
        self._forget(now)
        origin, text = self._origin(problem.origin), shortened(problem.message, TOLD)
        text = _NUMBERS.sub("", text) if origin else text
        if (origin, text) in self._said:
            self._kind(origin, _kind_of(text), now).leave(self.latest, problem.times)
            return ""
        different = sum(one == origin for one, _ in self._said)
        if different >= MANY:
            self._kind(origin, "", now).leave(self.latest, problem.times)
            return ""
        kind = self._kind(origin, _kind_of(text), now)
        if kind.said >= FEW:
            kind.leave(self.latest, problem.times)
            return ""
        kind.said += 1
        kind.leave(self.latest, problem.times - 1)
        self._said[origin, text] = now
        if different + 1 == MANY:
            return self.latest + "; its further problems are only counted for a minute"
        return self.latest + ("; more of the kind are only counted for a minute" if kind.said == FEW else "")

    def _origin(self, origin: str) -> str:
        """The origin under which a problem is remembered; interfaces beyond the limit share one."""
        origin, known = shortened(origin), {one for one, _ in self._kinds}
        return origin if origin in known or len(known) < MOST_ORIGINS else "other interfaces"

    def counted(self, now: float) -> List[str]:
        """The lines that tell how many problems were not said, once their time is over; each line once."""
        self._forget(now)
        lines, self._counted = self._counted, []
        return lines

    def _kind(self, origin: str, kind: str, now: float) -> _Kind:
        return self._kinds.setdefault((origin, kind), _Kind(now))

    def _forget(self, now: float) -> None:
        """Forget what was said long ago; what was not said is to be told as a number."""
        self._said = {key: said for key, said in self._said.items() if now - said < QUIET}
        for key in [key for key, kind in self._kinds.items() if now - kind.since >= QUIET]:
            kind = self._kinds.pop(key)
            if kind.unsaid:
                self._counted.append(f"{kind.unsaid} more {_whose(*key)} in a minute, the last: {kind.latest}")


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
