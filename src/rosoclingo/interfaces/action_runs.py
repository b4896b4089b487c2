"""The life of one action at the interface: waiting for the server, sent, running, ending, done.  No ROS.

Time is an argument: an Instant holds ROS time (which may be simulated, stand still or jump) and steady wall time.
"""

import enum
from typing import Dict, NamedTuple, Optional, Tuple


class Instant(NamedTuple):
    """A point in time in seconds: ROS time, and a wall clock that only goes forward."""

    ros: float
    wall: float


class Limits(NamedTuple):
    """How long a run may take, in seconds."""

    timeout: float = 120.0  # from sending a goal to its end, in ROS time; 0 for no limit
    server_timeout: float = 5.0  # for the server to appear, to acknowledge a goal, to end a cancelled one; > 0
    retries: int = 0  # how often a failed goal is sent again
    pause: float = 3.0  # how long the server is left to whoever has taken it, in ROS time


DEFAULT_LIMITS = Limits()

# Seconds of wall time that a server which has announced itself may take to start: it may compile or load for minutes.
START_TIME = 300.0


class Phase(enum.Enum):
    """Where a run is."""

    WAITING = "waiting for the server"
    SENT = "sent, not acknowledged"
    RUNNING = "running"
    ENDING = "cancelled, not ended"
    YIELDING = "left to somebody else"
    DONE = "done"


class Event(enum.Enum):
    """What may happen to a run."""

    SERVER_FOUND = "the server is connected"
    ACKNOWLEDGED = "the server knows the goal"
    ENDED = "the goal has a terminal status"
    TAKEN = "the server has cancelled the goal for somebody else"
    SERVER_LOST = "the server is gone or has forgotten the goal"
    EXPIRED = "the time for this phase is over"
    CANCEL = "the core does not want it any more"
    SHUTDOWN = "the interface ends"


class Effect(enum.Enum):
    """What the interface has to do next."""

    NOTHING = "nothing"
    SEND = "send the goal"
    CANCEL = "cancel the goal"
    FINISH = "answer the core"
    ABANDON = "cancel the goal, answer the core"


_LATE: Dict[Event, Tuple[Phase, Effect]] = dict.fromkeys(Event, (Phase.DONE, Effect.NOTHING))

TRANSITIONS: Dict[Phase, Dict[Event, Tuple[Phase, Effect]]] = {
    Phase.WAITING: {
        Event.SERVER_FOUND: (Phase.SENT, Effect.SEND),
        Event.EXPIRED: (Phase.DONE, Effect.FINISH),
        Event.CANCEL: (Phase.DONE, Effect.FINISH),
        Event.SHUTDOWN: (Phase.DONE, Effect.FINISH),
    },
    Phase.SENT: {
        Event.ACKNOWLEDGED: (Phase.RUNNING, Effect.NOTHING),
        Event.ENDED: (Phase.DONE, Effect.FINISH),
        Event.TAKEN: (Phase.YIELDING, Effect.NOTHING),
        Event.SERVER_LOST: (Phase.DONE, Effect.FINISH),
        Event.EXPIRED: (Phase.DONE, Effect.ABANDON),
        Event.CANCEL: (Phase.ENDING, Effect.CANCEL),
        Event.SHUTDOWN: (Phase.DONE, Effect.ABANDON),
    },
    Phase.RUNNING: {
        Event.ACKNOWLEDGED: (Phase.RUNNING, Effect.NOTHING),
        Event.ENDED: (Phase.DONE, Effect.FINISH),
        Event.TAKEN: (Phase.YIELDING, Effect.NOTHING),
        Event.SERVER_LOST: (Phase.DONE, Effect.FINISH),
        Event.EXPIRED: (Phase.ENDING, Effect.CANCEL),
        Event.CANCEL: (Phase.ENDING, Effect.CANCEL),
        Event.SHUTDOWN: (Phase.DONE, Effect.ABANDON),
    },
    Phase.ENDING: {
        Event.ACKNOWLEDGED: (Phase.ENDING, Effect.NOTHING),
        Event.ENDED: (Phase.DONE, Effect.FINISH),
        Event.TAKEN: (Phase.DONE, Effect.FINISH),
        Event.SERVER_LOST: (Phase.DONE, Effect.FINISH),
        Event.EXPIRED: (Phase.DONE, Effect.FINISH),
        Event.CANCEL: (Phase.ENDING, Effect.NOTHING),
        Event.SHUTDOWN: (Phase.DONE, Effect.FINISH),
    },
    Phase.YIELDING: {
        Event.ACKNOWLEDGED: (Phase.YIELDING, Effect.NOTHING),
        Event.ENDED: (Phase.YIELDING, Effect.NOTHING),
        Event.TAKEN: (Phase.YIELDING, Effect.NOTHING),
        Event.SERVER_LOST: (Phase.DONE, Effect.FINISH),
        Event.EXPIRED: (Phase.DONE, Effect.FINISH),
        Event.CANCEL: (Phase.DONE, Effect.FINISH),
        Event.SHUTDOWN: (Phase.DONE, Effect.FINISH),
    },
    Phase.DONE: _LATE,
}

# The verdicts of runs that end without a terminal status from the server. `preempted` means that nothing has happened:
# a run has this verdict only for a goal that was never sent; for any other goal only its server can report it.
_VERDICTS: Dict[Tuple[Phase, Event], str] = {
    (Phase.WAITING, Event.EXPIRED): "server_lost",
    (Phase.WAITING, Event.CANCEL): "preempted",
    (Phase.SENT, Event.EXPIRED): "server_lost",
    (Phase.RUNNING, Event.EXPIRED): "timeout",
    (Phase.ENDING, Event.EXPIRED): "server_lost",
}


class IllegalEventError(RuntimeError):
    """An event that cannot happen in this phase."""


class _Stopwatch:
    """Measures both times since its start."""

    def __init__(self, now: Instant) -> None:
        self._start = now

    def elapsed(self, now: Instant) -> Instant:
        """Seconds since the start; ROS time counts from the first /clock, and anew when simulated time was reset."""
        if self._start.ros <= 0.0 or now.ros < self._start.ros:
            self._start = Instant(now.ros, self._start.wall)
        return Instant(now.ros - self._start.ros, now.wall - self._start.wall)


class Run:
    """One attempt of one action: knows its phase, its deadline and, when it ended by itself, why."""

    def __init__(self, limits: Limits, now: Instant) -> None:
        self._limits = limits
        self._in_phase = _Stopwatch(now)
        self._since_sent = _Stopwatch(now)
        self._phase = Phase.WAITING
        self._verdict: Optional[str] = None
        self._unheeded = False
        self._waits = False

    @property
    def phase(self) -> Phase:
        """Where the run is."""
        return self._phase

    @property
    def done(self) -> bool:
        """True if the run has ended and takes no further event."""
        return self._phase is Phase.DONE

    @property
    def verdict(self) -> Optional[str]:
        """`timeout`, `preempted`, `server_lost` or `interface_lost` if the run did not end by the server's will."""
        return self._verdict

    @property
    def unheeded(self) -> bool:
        """True if the server has not ended the cancelled goal, and can go on with it."""
        return self._unheeded

    def handle(self, event: Event, now: Instant) -> Effect:
        """Take an event and return what has to be done about it.  Raises IllegalEventError."""
        if event not in TRANSITIONS[self._phase]:
            raise IllegalEventError(f"{event.value} while {self._phase.value}")
        before = self._phase
        self._note_verdict(before, event)
        self._phase, effect = TRANSITIONS[before][event]
        if self._phase is not before:
            self._in_phase = _Stopwatch(now)
        if effect is Effect.SEND:
            self._since_sent = _Stopwatch(now)
        return effect

    def tick(self, now: Instant) -> Effect:
        """Handle EXPIRED if the deadline of this phase has passed."""
        return self.handle(Event.EXPIRED, now) if self._expired(now) else Effect.NOTHING

    def wait_on(self, now: Instant) -> bool:
        """Wait for a server that is starting, for START_TIME in all; return whether that is new."""
        if self._phase is not Phase.WAITING or self._since_sent.elapsed(now).wall >= START_TIME:
            return False
        self._in_phase = _Stopwatch(now)
        before, self._waits = self._waits, True
        return not before

    def _note_verdict(self, phase: Phase, event: Event) -> None:
        self._unheeded |= (phase, event) == (Phase.ENDING, Event.EXPIRED)
        if event is Event.SHUTDOWN and phase is not Phase.DONE:
            self._verdict = "interface_lost"
        elif event is Event.SERVER_LOST and phase is not Phase.DONE:
            self._verdict = "server_lost"
        else:
            self._verdict = _VERDICTS.get((phase, event), self._verdict)

    def _expired(self, now: Instant) -> bool:
        elapsed, sent = self._in_phase.elapsed(now), self._since_sent.elapsed(now)
        limit = self._limits.server_timeout
        if self._phase is Phase.WAITING:
            return elapsed.wall >= limit
        if self._phase is Phase.RUNNING:
            return 0.0 < self._limits.timeout <= sent.ros
        if self._phase is Phase.YIELDING:
            return elapsed.ros >= self._limits.pause
        # A server that answers by simulated time must not be called lost because simulated time stands still or flies.
        return self._phase is not Phase.DONE and min(elapsed) >= limit
