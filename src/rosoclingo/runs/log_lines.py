"""The log lines of a run, in causal order."""

import math
from typing import Callable, Iterable, List, NamedTuple, Optional, Set

#: Limit in seconds of the run's clock that a line waits for its predecessors: topics have no common order.
PATIENCE = 1.0

#: The mark of the first plan, from which the cycle is known.
BEGUN = "begun"


class _Line(NamedTuple):
    time: float  # seconds since the run began
    kind: str
    text: str
    after: Set[str]
    gives: str
    cycle: int  # the cycle that begins with this line, 0 for none
    details: str


class RunLog:
    """Orders lines: each waits for the lines that belong before it, at most for PATIENCE.

    Lines refer to each other by marks: a line has a mark, and can wait for marks of other lines. ``enter`` receives
    each line: seconds since the beginning of the run, cycle, kind, text and details.
    """

    def __init__(self, enter: Callable[[float, int, str, str, str], None]) -> None:
        self._enter = enter
        self._held: List[_Line] = []
        self._given: Set[str] = {""}
        self._now = 0.0
        self.cycle = 0  # of the last line, 0 before the first cycle

    def add(
        self,
        time: float,
        kind: str,
        text: str,
        after: Iterable[str] = (),
        gives: str = "",
        cycle: int = 0,
        details: str = "",
    ) -> None:
        """Add a line at seconds since the beginning of the run; ``cycle`` begins with it, 0 for none."""
        self._held.append(_Line(time, kind, text, set(after), gives, cycle, details if details != text else ""))
        self.clock(time)

    def clock(self, time: float) -> None:
        """Write the lines that are due."""
        line = self._ready(time)
        while line is not None:
            self._held.remove(line)
            self._given.update({line.gives, BEGUN} if line.kind == "plan" else {line.gives})
            self.cycle = line.cycle or self.cycle
            self._now = max(self._now, line.time)
            self._enter(self._now, max(1, self.cycle), line.kind, line.text, line.details)
            line = self._ready(time)

    def _ready(self, time: float) -> Optional[_Line]:
        return next((one for one in self._held if one.after <= self._given or time - one.time > PATIENCE), None)

    def finish(self) -> None:
        """Write all waiting lines."""
        self.clock(math.inf)
