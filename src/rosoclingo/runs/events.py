"""The events of a run, in order.

Their sources are a core's topics, live or from a bag, and its journal. A run view converts them to tables and lines,
for pages and accounts; a run collector converts them to the cycles of a replay.
"""

from typing import Any, Dict, Iterable, NamedTuple, Optional, Sequence, Tuple

#: States of a goal that the core has not accepted yet: actionlib's, and that of a queued goal with a reason.
PENDING, WAITING = "pending", "waiting"

#: Words for actionlib's status numbers (actionlib_msgs/GoalStatus).
STATUS_WORDS = (
    "pending",
    "active",
    "canceled",
    "succeeded",
    "aborted",
    "rejected",
    "canceling",
    "canceling",
    "canceled",
    "lost",
)

#: The statuses of goals for people; a goal is open before its end.
SAID = {
    "pending": "new",
    "waiting": "queued",
    "active": "under way",
    "canceling": "being cancelled",
    "canceled": "cancelled",
    "succeeded": "done",
    "aborted": "given up",
    "rejected": "rejected",
    "lost": "lost",
    "open": "open",
}

#: The words for terminal statuses.
ENDED = frozenset({"canceled", "succeeded", "aborted", "rejected", "lost"})


class GoalReport(NamedTuple):
    """The state of a goal: its status as in actionlib_msgs/GoalStatus; ``came`` is the time of its arrival, else 0."""

    key: str
    request: str
    status: int
    reason: str
    came: float = 0.0


class RunEvents:
    """Base class of handlers of events, each with its time in seconds of the run's clock; ignores them all."""

    def program(self, time: float, text: str) -> None:
        """Handle the program of a core, in the format of :meth:`RunProgram.text`."""

    def begin(self, run: str) -> None:
        """Handle the id of the core's run; a new run starts with cycle 1 again."""

    def goals(self, time: float, reports: Sequence[GoalReport]) -> None:
        """Handle the states of all goals."""

    def cancel(self, time: float, key: str) -> None:
        """Handle a client's cancel of a goal; an empty key stands for all goals."""

    def update(self, time: float, text: str) -> None:
        """Handle an accepted stream update."""

    def plan(
        self, time: float, cycle: int, horizon: int, actions: Sequence[str], times: Optional[Tuple[float, float]] = None
    ) -> None:
        """Handle a plan, with the seconds of wall time for grounding and searching, if known."""

    def dispatched(self, time: float, facts: Sequence[str]) -> None:
        """Handle dispatched actions and cancellations, which can be repeated."""

    def returned(self, time: float, origin: str, facts: Sequence[str]) -> None:
        """Handle facts of an interface, including returns."""

    def packages(self, time: float, packages: Iterable[Tuple[str, str]]) -> None:
        """Handle the places of all packages: labels, the names of robots, or empty for the only robot."""

    def beliefs(self, time: float, cycle: int, atoms: Sequence[str]) -> None:
        """Handle the program's beliefs, the shown atoms that hold now."""

    def mode(self, time: float, mode: str) -> None:
        """Handle whether the core dispatches actions: running, paused or stopped."""

    def problem(self, time: float, cycle: int, text: str) -> None:
        """Handle a problem from the core's log."""

    def pose(self, time: float, x: float, y: float, yaw: float, robot: str = "") -> None:
        """Handle the robot's pose (m, rad), or that of one of several robots."""

    def path(self, time: float, points: Sequence[Tuple[float, float]]) -> None:
        """Handle the robot's planned path (m)."""

    def scan(self, time: float, topic: str, points: Sequence[Tuple[float, float]]) -> None:
        """Handle the scan of a laser, points in the map (m)."""

    def floor(self, image: Optional[Dict[str, Any]]) -> None:
        """Handle the image of the map, None for a map without cells."""

    def wall(self, time: float, seconds: float) -> None:
        """Handle the wall time at a time of the run's clock."""

    def clock(self, time: float) -> None:
        """Handle the passing of time without other events."""


def status_word(number: int, reason: str) -> str:
    """Return the word for a status number; a pending goal with a reason is waiting. Raises IndexError for others."""
    word = STATUS_WORDS[number]
    return WAITING if word == PENDING and reason else word


def reason_suffix(status: str, reason: str) -> str:
    """Return the reason of a failed or queued goal in parentheses; empty for other goals."""
    return f" ({reason})" if reason and status in ("waiting", "aborted", "rejected", "lost") else ""


def reason_of(request: str, message: str) -> str:
    """Return a status message without the goal at its beginning."""
    return (message[len(request) :] if message.startswith(request) else message).strip()
