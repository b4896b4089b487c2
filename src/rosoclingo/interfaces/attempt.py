"""State machine of one action at the interface, from its command to its answer.  No ROS.

Time is an argument: an Instant holds ROS time (which can be simulated, stand still or jump) and steady wall time.
"""

import enum
from typing import Any, Callable, Dict, NamedTuple, Optional, Tuple

from clingo import Symbol

from rosoclingo.interfaces.answers import INTERRUPTED, LOST, SUCCEEDED, conclude
from rosoclingo.interfaces.facts import Sender
from rosoclingo.interfaces.templates import GoalEnd
from rosoclingo.reasoning.keywords import Action

Check = Callable[[], Optional[bool]]
"""A check of the world: whether an action was done, None for unknown."""

#: The terminal statuses of a goal that its server has cancelled.
CANCELLED = ("preempted", "recalled")


class Instant(NamedTuple):
    """A point in time in seconds: ROS time and monotonic wall time."""

    ros: float
    wall: float


class ActionLimits(NamedTuple):
    """Time limits of an attempt in seconds, and retries."""

    timeout: float = 120.0  # from sending a goal to its end, in ROS time; 0 for no limit
    server_timeout: float = 5.0  # for the server to appear, to acknowledge a goal, to end a cancelled goal; > 0
    retries: int = 0  # how often a failed goal is sent again
    pause: float = 3.0  # wait after another client has preempted the goal, in ROS time


DEFAULT_LIMITS = ActionLimits()

# Limit in seconds of wall time for the start of a server that has announced itself: it can compile or load for minutes.
START_TIME = 300.0

# Limit in seconds of wall time for the result of an ended goal to arrive.
RESULT_GRACE = 1.0


class Phase(enum.Enum):
    """The phases of an attempt."""

    ASKING = "asking about an earlier goal of unknown outcome"
    WAITING = "waiting for the server"
    SENT = "sent, not acknowledged"
    RUNNING = "running"
    ENDING = "cancelled, not ended"
    YIELDING = "left to another client"
    DONE = "done"


class ActionEvent(enum.Enum):
    """The events of an attempt."""

    FOUND = "the server has the earlier goal"
    DECIDED = "the earlier goal decides the action"
    UNDECIDED = "another goal is needed"
    SERVER_FOUND = "the server is connected"
    ACKNOWLEDGED = "the server knows the goal"
    ENDED = "the goal has a terminal status"
    PREEMPTED = "the server has cancelled the goal for another client"
    SERVER_LOST = "the server is gone or has forgotten the goal"
    EXPIRED = "the time limit of this phase has expired"
    CANCEL = "the core has cancelled the action"
    SHUTDOWN = "the interface shuts down"


class Effect(enum.Enum):
    """The interface's response to an event."""

    NOTHING = "nothing"
    SEND = "send the goal"
    CANCEL = "cancel the goal"
    FINISH = "answer the core"
    ABANDON = "cancel the goal, answer the core"


_Transition = Tuple[Phase, Effect]
_FINISH, _ABANDON = (Phase.DONE, Effect.FINISH), (Phase.DONE, Effect.ABANDON)

_WITH_SERVER: Dict[ActionEvent, _Transition] = {
    ActionEvent.ACKNOWLEDGED: (Phase.RUNNING, Effect.NOTHING),
    ActionEvent.ENDED: _FINISH,
    ActionEvent.PREEMPTED: (Phase.YIELDING, Effect.NOTHING),
    ActionEvent.SERVER_LOST: _FINISH,
    ActionEvent.CANCEL: (Phase.ENDING, Effect.CANCEL),
    ActionEvent.SHUTDOWN: _ABANDON,
}
_BY_INTERFACE = (ActionEvent.EXPIRED, ActionEvent.CANCEL, ActionEvent.SHUTDOWN)
_BY_SERVER = (ActionEvent.ENDED, ActionEvent.PREEMPTED, ActionEvent.SERVER_LOST)

#: Phase and effect after each event in each phase; an event that is not here is illegal.
TRANSITIONS: Dict[Phase, Dict[ActionEvent, _Transition]] = {
    Phase.ASKING: {
        ActionEvent.FOUND: (Phase.RUNNING, Effect.NOTHING),
        ActionEvent.DECIDED: _FINISH,
        ActionEvent.UNDECIDED: (Phase.WAITING, Effect.NOTHING),
        ActionEvent.SHUTDOWN: _ABANDON,
    },
    Phase.WAITING: {ActionEvent.SERVER_FOUND: (Phase.SENT, Effect.SEND), **dict.fromkeys(_BY_INTERFACE, _FINISH)},
    Phase.SENT: {**_WITH_SERVER, ActionEvent.EXPIRED: _ABANDON},
    Phase.RUNNING: {**_WITH_SERVER, ActionEvent.EXPIRED: (Phase.ENDING, Effect.CANCEL)},
    Phase.ENDING: {
        **dict.fromkeys((ActionEvent.ACKNOWLEDGED, ActionEvent.CANCEL), (Phase.ENDING, Effect.NOTHING)),
        **dict.fromkeys((*_BY_SERVER, ActionEvent.EXPIRED, ActionEvent.SHUTDOWN), _FINISH),
    },
    Phase.YIELDING: {
        **dict.fromkeys(
            (ActionEvent.ACKNOWLEDGED, ActionEvent.ENDED, ActionEvent.PREEMPTED), (Phase.YIELDING, Effect.NOTHING)
        ),
        **dict.fromkeys((ActionEvent.SERVER_LOST, *_BY_INTERFACE), _FINISH),
    },
    Phase.DONE: dict.fromkeys(ActionEvent, (Phase.DONE, Effect.NOTHING)),
}

# The verdicts of attempts that end without a terminal status from the server. `preempted` means that nothing has
# happened: only a goal that was never sent has this verdict; for any other goal only its server can report it.
_VERDICTS: Dict[Tuple[Phase, ActionEvent], str] = {
    (Phase.WAITING, ActionEvent.EXPIRED): "server_lost",
    (Phase.WAITING, ActionEvent.CANCEL): "preempted",
    (Phase.SENT, ActionEvent.EXPIRED): "server_lost",
    (Phase.RUNNING, ActionEvent.EXPIRED): "timeout",
    (Phase.ENDING, ActionEvent.EXPIRED): "server_lost",
    **{(phase, ActionEvent.SERVER_LOST): "server_lost" for phase in Phase if phase is not Phase.DONE},
    **{(phase, ActionEvent.SHUTDOWN): "interface_lost" for phase in Phase if phase is not Phase.DONE},
}


class IllegalEventError(RuntimeError):
    """An event that cannot happen in this phase."""


class _Stopwatch:
    """Measures ROS time and wall time since its start."""

    def __init__(self, now: Instant) -> None:
        self._start = now

    def elapsed(self, now: Instant) -> Instant:
        """Return the seconds since the start; ROS time counts from the first /clock or the last reset."""
        if self._start.ros <= 0.0 or now.ros < self._start.ros:
            self._start = Instant(now.ros, self._start.wall)
        return Instant(now.ros - self._start.ros, now.wall - self._start.wall)


class Attempt:
    """One goal for one action, from its creation to its end.

    Attributes:
        phase: the current phase.
        verdict: `timeout`, `preempted`, `server_lost` or `interface_lost` if the server did not end the goal.
        cancel_ignored: the server has not ended the cancelled goal, and can continue it.
        goal_id: the goal's id, empty before the goal is tracked.
        handle: the tracked goal.
        ended: the end of the goal according to the server.
        decided: the end of the action, if an earlier goal decides it.
        cancelled: by the core or by a shutdown: no goal is sent any more.
        uncertain: an earlier goal was sent, and its outcome is unknown.

    """

    def __init__(
        self, action: Action, goal: Any, sender: Sender, limits: ActionLimits, now: Instant, repeatable: bool = False
    ) -> None:
        self.action, self.goal, self.sender, self.limits = action, goal, sender, limits
        self._repeatable = repeatable
        self._in_phase = self._since_sent = _Stopwatch(now)
        self.phase = Phase.WAITING
        self.verdict: Optional[str] = None
        self.cancel_ignored = self._waits = False
        self.goal_id, self.handle = "", None  # type: str, Optional[Any]
        self.ended: Optional[GoalEnd] = None
        self.decided: Optional[GoalEnd] = None
        self.cancelled = self.uncertain = False
        self._former: Optional[GoalEnd] = None  # the end of the previous goal, None if none was sent
        self.stale_status: Any = None  # the server's last status message before it is asked about the earlier goal
        self._check: Optional[Check] = None
        self._id_is_used = False  # the server has ended the earlier goal, and accepts no other goal with its id
        self._result_due: Optional[float] = None  # wall time up to which the result of the earlier goal can arrive

    @property
    def done(self) -> bool:
        """Whether the attempt has ended; it ignores further events."""
        return self.phase is Phase.DONE

    def process(self, event: ActionEvent, now: Instant) -> Effect:
        """Process an event and return its effect.  Raises IllegalEventError."""
        before = self.phase
        if event not in TRANSITIONS[before]:
            raise IllegalEventError(f"{event.value} while {before.value}")
        self.cancel_ignored |= (before, event) == (Phase.ENDING, ActionEvent.EXPIRED)
        self.verdict = _VERDICTS.get((before, event), self.verdict)
        self.phase, effect = TRANSITIONS[before][event]
        if self.phase is not before and self.phase is not Phase.WAITING:  # a server is awaited from the beginning on
            self._in_phase = _Stopwatch(now)
        if effect is Effect.SEND or event is ActionEvent.FOUND:
            self._since_sent = _Stopwatch(now)
        return effect

    def tick(self, now: Instant) -> Effect:
        """Handle EXPIRED if the deadline of this phase has passed."""
        return self.process(ActionEvent.EXPIRED, now) if self._expired(now) else Effect.NOTHING

    def wait_on(self, now: Instant) -> bool:
        """Extend the wait for a starting server, up to START_TIME; return True for the first extension."""
        if self.phase is not Phase.WAITING or self._since_sent.elapsed(now).wall >= START_TIME:
            return False
        self._in_phase = _Stopwatch(now)
        before, self._waits = self._waits, True
        return not before

    def _expired(self, now: Instant) -> bool:
        elapsed, sent = self._in_phase.elapsed(now), self._since_sent.elapsed(now)
        limit = self.limits.server_timeout
        if self.phase is Phase.WAITING:
            return elapsed.wall >= limit
        if self.phase is Phase.RUNNING:
            return 0.0 < self.limits.timeout <= sent.ros
        if self.phase is Phase.YIELDING:
            return elapsed.ros >= self.limits.pause
        # A server in simulated time must not count as lost because simulated time stands still or runs fast.
        return self.phase is not Phase.DONE and min(elapsed) >= limit

    # ---- an earlier goal of unknown outcome -------------------------------------------------------------------------

    def begin_asking(self, check: Optional[Check], now: Instant) -> None:
        """Ask the server for at most ``server_timeout`` about an earlier goal, then ``check`` the world, if possible.

        The earlier goal is that of a killed node, or of this attempt, if it has ended because the server is lost.
        """
        self.decided = self.conclusion if self.done else None
        self.phase, self._check, self._in_phase = Phase.ASKING, check, _Stopwatch(now)
        self._id_is_used, self._result_due = False, None

    def ask(self, event: Optional[ActionEvent], now: Instant) -> str:
        """Leave the phase once the outcome is known, and return it in words; empty while it is open.

        ``event`` is the server's report: FOUND, ENDED without a result, SERVER_LOST if it has no such goal, else None.
        """
        if event is ActionEvent.FOUND:
            self.decided = self.verdict = None
            self.process(event, now)
            return "the server has its goal: it is running"
        if event is not None:
            self._id_is_used = event is ActionEvent.ENDED
        if event is ActionEvent.ENDED and self._result_due is None:
            self._result_due = now.wall + RESULT_GRACE
        expired = self._in_phase.elapsed(now).wall >= self.limits.server_timeout
        waits = event is None or (event is ActionEvent.ENDED and now.wall < (self._result_due or 0.0))
        if waits and not expired:
            return ""
        done = self._check() if self._check is not None else None
        known = bool(done) or (done is not None and not waits)  # an unreachable server can still do the action
        if not (known or expired or self._check is None):
            return ""
        self.uncertain = not known
        if done:
            self.decided = GoalEnd(SUCCEEDED, "it was already done")
        elif self.decided is None and self.uncertain and (self.cancelled or not self._repeatable):
            self.decided = GoalEnd(INTERRUPTED, "a killed node had begun it, and its outcome is unknown")
        elif self._id_is_used:
            self.goal_id, self.handle = "", None
        self.process(ActionEvent.UNDECIDED if self.decided is None else ActionEvent.DECIDED, now)
        return "it was done" if done else "it was not done" if known else "its outcome is unknown"

    # ---- the end ----------------------------------------------------------------------------------------------------

    @property
    def needs_check(self) -> bool:
        """Whether a goal was sent whose outcome is unknown, and the world has not been checked yet."""
        lost = self.decided is None and self.conclusion.status == LOST
        return lost and (self.handle is not None or self.uncertain)

    @property
    def conclusion(self) -> GoalEnd:
        """The end of the attempt; after an earlier goal of unknown outcome it is never `preempted`."""
        if self.decided is not None:
            return self.decided
        ended = conclude(self.verdict, self.ended)
        if self.cancel_ignored:
            return ended._replace(text="its goal was cancelled, and the action server has not ended it")
        if self.uncertain and ended.status in CANCELLED:
            return ended._replace(status=LOST, text="an earlier goal of the action has an unknown outcome")
        never_sent = self.verdict == "preempted"
        return self._former if never_sent and self._former is not None else ended

    def should_retry(self, ended: GoalEnd, value: Symbol, retry_on: Tuple[str, ...]) -> bool:
        """Return whether to send another goal: the server ended this goal, for a reason in ``retry_on``."""
        final = self.cancelled or self.cancel_ignored or ended.status in (SUCCEEDED, INTERRUPTED, "interface_lost")
        return not final and self.limits.retries > 0 and str(value).partition("(")[0] in retry_on

    def next_attempt(self, ended: GoalEnd, now: Instant) -> "Attempt":
        """Return the next attempt at the same action, after ``ended``, the end of this attempt."""
        limits = self.limits._replace(retries=self.limits.retries - 1)
        following = Attempt(self.action, self.goal, self.sender, limits, now, self._repeatable)
        sent = self.ended is not None or self.decided is not None or self.handle is not None
        following.uncertain, following._former = self.uncertain, ended if sent else self._former
        return following
