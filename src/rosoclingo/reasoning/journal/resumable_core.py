"""A core that can save its state and resume from it."""

from typing import Any, Optional, Tuple

from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import Mode
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.journal.recorded_history import RecordedHistory
from rosoclingo.reasoning.keywords import Action
from rosoclingo.reasoning.records import PersistentPart, Record, fields, record_of


class ResumableCore(Core, PersistentPart):
    """The core, with its state as plain values between any two of its steps.

    The state and the arrivals determine the behaviour, except for searches that time out and for the choice among
    equally good answers.
    """

    GROUP = "core"
    FIELDS = fields(
        _started=bool,
        _step=int,
        _waits=int,
        _improvable=bool,
        _lookahead=int,
        _plan=Optional[TaskPlan],
        _last_plan=TaskPlan,
        _last_cycle=int,
        _mode=Mode,
        _withheld=bool,
    )

    def __init__(self, *arguments: Any, record: Optional[Record] = None, **more: Any) -> None:
        """Start fresh, or resume from the ``record`` of a core with the same program; see :class:`Core`."""
        super().__init__(*arguments, **more)
        self._recorded = RecordedHistory()
        self._started = False
        if record is not None:
            self._resume(record)

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

    @property
    def parts(self) -> Tuple[PersistentPart, ...]:
        """The parts with a persisted state; valid between two steps."""
        self._recorded.follow(self._planner.log)
        goals, execution = self._goals, self._execution
        parts = goals, goals.queue, self._feeder, execution, execution.durations
        return (self._recorded, self, *parts, self.interfaces, self._preemption, self._announce)

    def state(self) -> Record:
        """Return the rows of all parts."""
        return record_of(self.parts)

    @property
    def _lookahead(self) -> int:
        return self._planner.lookahead

    @_lookahead.setter
    def _lookahead(self, steps: int) -> None:
        self._planner.lookahead = steps

    def _resume(self, record: Record) -> None:
        for part in self.parts:
            part.restore(record)
        self._feeder.find_goals(self._goals.by_key)
        self._planner = self._planner.with_log(self._recorded.history)
