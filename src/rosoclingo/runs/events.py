"""The model of a run: its events in order.

Their sources are a core's topics, live or from a bag, and its journal. A run view makes tables and lines of them, for
pages and accounts; a run collector makes the cycles of a replay.
"""

from typing import Any, Dict, Iterable, NamedTuple, Optional, Sequence, Tuple

__all__ = ["ENDED", "STATUS_WORDS", "GoalReport", "RunEvents", "because", "reason_of"]

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

#: The words that end a goal.
ENDED = frozenset({"canceled", "succeeded", "aborted", "rejected", "lost"})


class GoalReport(NamedTuple):
    """How a goal stands: its status as in actionlib_msgs/GoalStatus; ``came`` is when the core had it, else 0."""

    key: str
    request: str
    status: int
    reason: str
    came: float = 0.0


class RunEvents:
    """Takes the events of a run, each with its time in seconds of the run's clock; here each is ignored."""

    def program(self, time: float, text: str) -> None:
        """Take the program of a core, as :meth:`RunProgram.text` has it."""

    def begin(self, run: str) -> None:
        """Take the identity of the core's run; another one than before begins with cycle 1 again."""

    def goal(self, time: float, key: str, text: str) -> None:
        """Take a goal that a client sent."""

    def goals(self, time: float, reports: Sequence[GoalReport]) -> None:
        """Take how all goals stand."""

    def cancel(self, time: float, key: str) -> None:
        """Take a client's cancel of a goal; an empty key stands for all of them."""

    def status(self, time: float, key: str, number: int, message: str) -> None:
        """Take a goal's status, as in actionlib_msgs/GoalStatus, as often as it is published."""

    def feedback(self, time: float, key: str, status: str) -> None:
        """Take the feedback on a goal."""

    def update(self, time: float, text: str) -> None:
        """Take a stream update that is in force."""

    def plan(
        self, time: float, cycle: int, horizon: int, actions: Sequence[str], times: Optional[Tuple[float, float]] = None
    ) -> None:
        """Take a plan, with the seconds of wall time that grounding and searching took, where they are known."""

    def dispatched(self, time: float, facts: Sequence[str]) -> None:
        """Take actions that went out, and what ends them early, perhaps again."""

    def returned(self, time: float, origin: str, facts: Sequence[str]) -> None:
        """Take facts from an interface, returns among them."""

    def packages(self, time: float, packages: Iterable[Tuple[str, str]]) -> None:
        """Take the places of all packages; an empty place is the robot."""

    def beliefs(self, time: float, cycle: int, atoms: Sequence[str]) -> None:
        """Take the atoms that hold now, by the program."""

    def problem(self, time: float, cycle: int, text: str) -> None:
        """Take a problem from the core's log."""

    def pose(self, time: float, x: float, y: float, yaw: float) -> None:
        """Take the robot's pose (m, rad)."""

    def path(self, time: float, points: Sequence[Tuple[float, float]]) -> None:
        """Take the path that the robot is to drive (m)."""

    def floor(self, image: Optional[Dict[str, Any]]) -> None:
        """Take the picture of the map, None for a map without cells."""

    def clock(self, time: float) -> None:
        """Take the time, though nothing else has come."""


def because(status: str, reason: str) -> str:
    """The reason of an end that went against the goal; success and cancellation need none."""
    return f" ({reason})" if reason and status in ("aborted", "rejected", "lost") else ""


def reason_of(request: str, message: str) -> str:
    """A status' message without the goal that it begins with."""
    return (message[len(request) :] if message.startswith(request) else message).strip()
