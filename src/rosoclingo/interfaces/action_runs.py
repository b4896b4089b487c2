"""State machine of one action at the interface: waiting for the server, sent, running, ending, done.  No ROS.

Time is an argument: an Instant holds ROS time (which can be simulated, stand still or jump) and steady wall time.
"""

import enum
from typing import Dict, Iterable, NamedTuple, Optional, Tuple


class Instant(NamedTuple):
    """A point in time in seconds: ROS time and monotonic wall time."""

    ros: float
    wall: float


class ActionLimits(NamedTuple):
    """Time limits of a run in seconds, and retries."""

    timeout: float = 120.0  # from sending a goal to its end, in ROS time; 0 for no limit
    server_timeout: float = 5.0  # for the server to appear, to acknowledge a goal, to end a cancelled goal; > 0
    retries: int = 0  # how often a failed goal is sent again
    pause: float = 3.0  # wait after another client has preempted the goal, in ROS time


DEFAULT_LIMITS = ActionLimits()

# Limit in seconds of wall time for the start of a server that has announced itself: it can compile or load for minutes.
START_TIME = 300.0


class Phase(enum.Enum):
    """The phases of a run."""

    WAITING = "waiting for the server"
    SENT = "sent, not acknowledged"
    RUNNING = "running"
    ENDING = "cancelled, not ended"
    YIELDING = "left to another client"
    DONE = "done"


class ActionEvent(enum.Enum):
    """The events of a run."""

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


def _all(events: Iterable[ActionEvent], transition: _Transition) -> Dict[ActionEvent, _Transition]:
    return dict.fromkeys(events, transition)


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
    Phase.WAITING: {ActionEvent.SERVER_FOUND: (Phase.SENT, Effect.SEND), **_all(_BY_INTERFACE, _FINISH)},
    Phase.SENT: {**_WITH_SERVER, ActionEvent.EXPIRED: _ABANDON},
    Phase.RUNNING: {**_WITH_SERVER, ActionEvent.EXPIRED: (Phase.ENDING, Effect.CANCEL)},
    Phase.ENDING: {
        **_all((ActionEvent.ACKNOWLEDGED, ActionEvent.CANCEL), (Phase.ENDING, Effect.NOTHING)),
        **_all((*_BY_SERVER, ActionEvent.EXPIRED, ActionEvent.SHUTDOWN), _FINISH),
    },
    Phase.YIELDING: {
        **_all((ActionEvent.ACKNOWLEDGED, ActionEvent.ENDED, ActionEvent.PREEMPTED), (Phase.YIELDING, Effect.NOTHING)),
        **_all((ActionEvent.SERVER_LOST, *_BY_INTERFACE), _FINISH),
    },
    Phase.DONE: _all(ActionEvent, (Phase.DONE, Effect.NOTHING)),
}

# The verdicts of runs that end without a terminal status from the server. `preempted` means that nothing has happened:
# a run has this verdict only for a goal that was never sent; for any other goal only its server can report it.
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


class Run:
    """One attempt of one action.

    Attributes:
        phase: the current phase.
        verdict: `timeout`, `preempted`, `server_lost` or `interface_lost` if the server did not end the run.
        cancel_ignored: the server has not ended the cancelled goal, and can continue it.

    """

    def __init__(self, limits: ActionLimits, now: Instant) -> None:
        self._limits = limits
        self._in_phase = self._since_sent = _Stopwatch(now)
        self.phase = Phase.WAITING
        self.verdict: Optional[str] = None
        self.cancel_ignored = self._waits = False

    @property
    def done(self) -> bool:
        """Whether the run has ended; it ignores further events."""
        return self.phase is Phase.DONE

    def handle(self, event: ActionEvent, now: Instant) -> Effect:
        """Process an event and return its effect.  Raises IllegalEventError."""
        before = self.phase
        if event not in TRANSITIONS[before]:
            raise IllegalEventError(f"{event.value} while {before.value}")
        self.cancel_ignored |= (before, event) == (Phase.ENDING, ActionEvent.EXPIRED)
        self.verdict = _VERDICTS.get((before, event), self.verdict)
        self.phase, effect = TRANSITIONS[before][event]
        if self.phase is not before:
            self._in_phase = _Stopwatch(now)
        if effect is Effect.SEND:
            self._since_sent = _Stopwatch(now)
        return effect

    def tick(self, now: Instant) -> Effect:
        """Handle EXPIRED if the deadline of this phase has passed."""
        return self.handle(ActionEvent.EXPIRED, now) if self._expired(now) else Effect.NOTHING

    def wait_on(self, now: Instant) -> bool:
        """Extend the wait for a starting server, up to START_TIME; return True for the first extension."""
        if self.phase is not Phase.WAITING or self._since_sent.elapsed(now).wall >= START_TIME:
            return False
        self._in_phase = _Stopwatch(now)
        before, self._waits = self._waits, True
        return not before

    def _expired(self, now: Instant) -> bool:
        elapsed, sent = self._in_phase.elapsed(now), self._since_sent.elapsed(now)
        limit = self._limits.server_timeout
        if self.phase is Phase.WAITING:
            return elapsed.wall >= limit
        if self.phase is Phase.RUNNING:
            return 0.0 < self._limits.timeout <= sent.ros
        if self.phase is Phase.YIELDING:
            return elapsed.ros >= self._limits.pause
        # A server in simulated time must not count as lost because simulated time stands still or runs fast.
        return self.phase is not Phase.DONE and min(elapsed) >= limit
