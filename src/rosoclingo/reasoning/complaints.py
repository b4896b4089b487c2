"""Problems as lines of a log: each is said once, however often it happens, and counted."""

import re
from typing import Dict, Tuple

from rosoclingo.reasoning.events import Problem

#: Seconds in which the same is not said again.
QUIET = 60.0

#: So many different problems of one interface are said within that time.
MANY = 10

#: Characters of a text that are told from its beginning, and from its end, where the reason stands.
BEGINNING, END = 600, 300

_NUMBERS = re.compile("[0-9]+")


class Complaints:
    """Says what is worth a line. ``count`` is the number of all problems, ``latest`` the text of the last one.

    Problems of one interface are the same if their texts differ in numbers only; others if their texts are the same.
    """

    def __init__(self) -> None:
        self.count = 0
        self.latest = ""
        self._said: Dict[Tuple[str, str], float] = {}

    def take(self, problem: Problem, now: float) -> str:
        """The line for a problem at ``now`` (seconds of a clock that only goes forward), empty for none."""
        self.count += 1
        self.latest = _shortened(f"cycle {problem.cycle}: {problem.message}")
        self._forget(now)
        text = _NUMBERS.sub("", problem.message) if problem.origin else problem.message
        key = (problem.origin, text)
        different = sum(origin == problem.origin for origin, _ in self._said) if problem.origin else 0
        if key in self._said or different >= MANY:
            return ""
        self._said[key] = now
        return self.latest + ("; its further problems are only counted for a minute" if different + 1 == MANY else "")

    def _forget(self, now: float) -> None:
        """Forget what was said long ago."""
        self._said = {key: said for key, said in self._said.items() if now - said < QUIET}


def _shortened(text: str) -> str:
    """The text without its middle, if it is long: whoever sends a fact of a megabyte need not read it again."""
    return text if len(text) <= BEGINNING + END else f"{text[:BEGINNING]} ... {text[-END:]}"
