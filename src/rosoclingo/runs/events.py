"""The states of goals in the events of a run, and their words."""

from typing import NamedTuple

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
