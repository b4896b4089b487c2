"""A core that can save its state and resume from it."""

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


class ResumableCore(Core):
    """The core, with its state as plain values between any two of its steps.

    The state and the arrivals determine the behaviour, except for searches that time out and for the choice among
    equally good answers.
    """

    def __init__(self, *arguments: Any, record: Optional[Record] = None, **more: Any) -> None:
        """Start fresh, or resume from the ``record`` of a core with the same program; see :class:`Core`."""
        super().__init__(*arguments, **more)
        self._log = LogRecorder()
        self._believed: Tuple[Optional[FrozenSet[Symbol]], Record] = (None, {})  # the beliefs and their sections
        self._started = False
        if record is not None:
            self._restore(record)

    def start(self) -> None:
        """Start the core unless it has resumed."""
        if not self._started:
            super().start()
            self._started = True

    def report_beliefs(self) -> None:
        """Report the restored beliefs of a resumed core, before any search."""
        self._announce.present()

    @property
    def preempted(self) -> Tuple[Action, ...]:
        """The running actions that the plan no longer needs."""
        return self._preemption.found

    @property
    def shown(self) -> Tuple[Action, ...]:
        """The last executed actions, and the rest of the plan."""
        return self._shown()

    @property
    def horizon(self) -> int:
        """The last grounded step."""
        return self._planner.log.horizon

    def goal(self, key: str) -> Optional[Goal]:
        """Return the live goal with a client's handle, None if there is none."""
        return self._goals.by_key(key)

    def shut_down(self, why: str) -> None:
        """End the running actions and abort every goal, because the core shuts down.

        A core that resumes sends the same cancels, and cancels the goals that its program has.
        """
        ended = self._preemption.end_all()
        if ended:
            self._emit(ActionsPreempted(self.cycle, ended))
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
            **self.interfaces.record(),
            "preemption": self._preemption.record(),
            **self._record_beliefs(),
            **self._log.record(self._planner.log),
        }

    def _record_beliefs(self) -> Record:
        """Return the beliefs as sections; new ones come last, which keeps the changes small."""
        state, (known, sections) = self._announce.state, self._believed
        if state is not known:
            names = dict.fromkeys((f"believed:{text_of(symbol)}" for symbol in state or ()), 1)
            self._believed = state, {**{name: 1 for name in sections if name in names}, **names}
        return self._believed[1]

    def _restore(self, record: Record) -> None:
        core, plan, latest = record["core"], record["plan"], record["latest"]
        self._started, self._step, self._waits = core["started"], core["step"], core["waits"]
        self._improvable, self._announce.published = core["improvable"], core["published"]
        self._planner = self._planner.with_log(log_of(record))
        self._planner.lookahead = core["lookahead"]
        self._plan = None if plan is None else plan_of(plan)
        used = self._plan if latest is None else plan_of(latest)
        assert used is not None
        self._latest = core["used_at"], used
        self._goals.restore(record)
        self._feeder.restore(record, self._goals.by_key)
        self._execution.restore(record)
        self.interfaces.restore(record)
        self._preemption.restore(record["preemption"])
        self._announce.state = frozenset(map(symbol_of, keys_of(record, "believed"))) or None
