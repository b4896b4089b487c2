"""The lines of a run, in an order that people can follow."""

from typing import Callable, Iterable, List, NamedTuple, Optional, Set

__all__ = ["BEGUN", "PATIENCE", "RunLog"]

#: Seconds of the run's clock for which a line waits for one that belongs before it: topics overtake each other.
PATIENCE = 1.0

#: A mark that the first plan gives: which cycle it is.
BEGUN = "begun"


class _Line(NamedTuple):
    time: float  # seconds since the run began
    kind: str
    text: str
    after: Set[str]
    gives: str
    cycle: int  # which begins with it, 0 for none


class RunLog:
    """Passes on each line when the lines that belong before it are out, at the latest after PATIENCE.

    Lines name each other by marks: a line gives one, and can wait for those of others. ``enter`` gets each line:
    seconds since the run began, cycle, kind and text.
    """

    def __init__(self, enter: Callable[[float, int, str, str], None]) -> None:
        self._enter = enter
        self._held: List[_Line] = []
        self._given: Set[str] = {""}
        self._now = 0.0
        self.cycle = 0  # of the last line, 0 before the first cycle

    def add(
        self, time: float, kind: str, text: str, after: Iterable[str] = (), gives: str = "", cycle: int = 0
    ) -> None:
        """Take a line at seconds since the run began; ``cycle`` begins with it, 0 for none."""
        self._held.append(_Line(time, kind, text, set(after), gives, cycle))
        self.clock(time)

    def clock(self, time: float) -> None:
        """Pass on the lines that have waited for long enough."""
        line = self._ready(time)
        while line is not None:
            self._held.remove(line)
            self._given.update({line.gives, BEGUN} if line.kind == "plan" else {line.gives})
            self._pass_on(line)
            line = self._ready(time)

    def _ready(self, time: float) -> Optional[_Line]:
        return next((one for one in self._held if one.after <= self._given or time - one.time > PATIENCE), None)

    def finish(self) -> None:
        """Pass on the lines that still wait."""
        held, self._held = self._held, []
        for line in held:
            self._pass_on(line)

    def _pass_on(self, line: _Line) -> None:
        self.cycle = line.cycle or self.cycle
        self._now = max(self._now, line.time)
        self._enter(self._now, max(1, self.cycle), line.kind, line.text)
