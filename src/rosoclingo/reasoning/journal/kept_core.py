"""A core whose state can be written down, and that can go on from what was written."""

from typing import Any, FrozenSet, Optional, Tuple

from clingo import Symbol

from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsPreempted
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.keywords import Action
from rosoclingo.reasoning.records import (
    LogRecorder,
    Record,
    keys_of,
    log_of,
    plan_of,
    plan_to_value,
    symbol_of,
    text_of,
)


class KeptCore(Core):
    """The core, with its state as plain values between any two of its steps.

    What it does from a state on follows from the state and from what comes; but for a search that time ends, or one of
    several answers that are as good.
    """

    def __init__(self, *arguments: Any, record: Optional[Record] = None, **more: Any) -> None:
        """Begin, or resume from a ``record`` of a core with the same program; the rest is as :class:`Core` has it."""
        super().__init__(*arguments, **more)
        self._log = LogRecorder()
        self._believed: Tuple[Optional[FrozenSet[Symbol]], Record] = (None, {})  # what is, and its sections
        self._started = False
        if record is not None:
            self._restore(record)

    def start(self) -> None:
        """Begin; one that goes on has begun."""
        if not self._started:
            super().start()
            self._started = True

    def remind(self) -> None:
        """Tell what is believed, where that is known before anything is solved: by a core that goes on."""
        self._announce.present()

    @property
    def preempted(self) -> Tuple[Action, ...]:
        """The actions under way that are no longer wanted."""
        return self._preemption.found

    @property
    def shown(self) -> Tuple[Action, ...]:
        """The last actions done, and the plan that remains."""
        return self._shown()

    @property
    def horizon(self) -> int:
        """The last step that the solver has ground."""
        return self._planner.log.horizon

    def goal(self, key: str) -> Optional[Goal]:
        """The live goal of a client's handle."""
        return self._goals.by_key(key)

    def leave(self, why: str) -> None:
        """End the actions under way and abort every goal, as the core ends.

        A core that resumes sends the same cancels, and cancels the goals that its program knows.
        """
        ended = self._preemption.end_all()
        if ended:
            self._tell(ActionsPreempted(self.cycle, ended))
        self.abandon(why)

    def record(self) -> Record:
        """Return the state by sections."""
        used_at, used = self._latest
        return {
            "core": {
                "started": self._started,
                "step": self._step,
                "waits": self._waits,
                "improvable": self._improvable,
                "published": self._announce.published,
                "lookahead": self._planner.lookahead,
                "used_at": used_at,
            },
            "plan": None if self._plan is None else plan_to_value(self._plan),
            "latest": None if used is self._plan else plan_to_value(used),
            **self._goals.record(),
            **self._feeder.record(),
            **self._execution.record(),
            "preemption": self._preemption.record(),
            **self._record_beliefs(),
            **self._log.record(self._planner.log),
        }

    def _record_beliefs(self) -> Record:
        """Return what is believed, what is new behind the rest: so little of it is other than before."""
        state, (known, sections) = self._announce.state, self._believed
        if state is not known:
            names = dict.fromkeys((f"believed:{text_of(symbol)}" for symbol in state or ()), 1)
            self._believed = state, {**{name: 1 for name in sections if name in names}, **names}
        return self._believed[1]

    def _restore(self, record: Record) -> None:
        core, plan, latest = record["core"], record["plan"], record["latest"]
        self._started, self._step, self._waits = core["started"], core["step"], core["waits"]
        self._improvable, self._announce.published = core["improvable"], core["published"]
        self._planner = self._planner.at(log_of(record))
        self._planner.lookahead = core["lookahead"]
        self._plan = None if plan is None else plan_of(plan)
        used = self._plan if latest is None else plan_of(latest)
        assert used is not None
        self._latest = core["used_at"], used
        self._goals.restore(record)
        self._feeder.restore(record, self._goals.by_key)
        self._execution.restore(record)
        self._preemption.restore(record["preemption"])
        self._announce.state = frozenset(map(symbol_of, keys_of(record, "believed"))) or None
