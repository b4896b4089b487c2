"""A core whose state can be written down, and that can go on from what was written."""

from typing import Any, FrozenSet, Optional, Tuple

from clingo import Symbol

from rosoclingo.oclingo import SolveResult
from rosoclingo.reasoning.action_extractor import TaskPlan, extract_plan
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import ActionsPreempted
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.keywords import Action, success_of
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

    def __init__(self, *arguments: Any, record: Optional[Record] = None, doubtful: bool = False, **more: Any) -> None:
        """Begin, or go on from a ``record`` of a core with the same program; the rest is as :class:`Core` has it.

        Where it is ``doubtful`` whether more was done than the record says, that was as its plan goes on.
        """
        super().__init__(*arguments, **more)
        self._log = LogRecorder()
        self._believed: Tuple[Optional[FrozenSet[Symbol]], Record] = (None, {})  # what is, and its sections
        self._started, self._perhaps_begun = False, TaskPlan()
        if record is not None:
            self._restore(record)
        if doubtful:
            self._perhaps_begun = self.plan

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

    def _use(self, result: SolveResult, now: float, new_goals: bool = False) -> None:
        """Go on with an answer, but do again what may have been begun already."""
        super()._use(self._as_begun(result), now, new_goals)

    def _as_begun(self, result: SolveResult) -> SolveResult:
        """Return an answer with the actions of this cycle that may have been begun, if they go out at all."""
        begun, step = self._perhaps_begun, self._step
        if not begun.remaining(step) or not self._succeeded(begun.at(step - 1)):
            self._perhaps_begun = TaskPlan()
            return result
        actions = begun.at(step)
        if not actions or extract_plan(result.answers[0]).at(step) == actions:
            return result
        found = self._planner.still(begun.remaining(step)) or self._planner.beginning_with(actions)
        if found is None:
            self._perhaps_begun = TaskPlan()
            named = ", ".join(str(one.atom) for one in actions)
            self._announce.problem(f"{named} may have been begun before the machine went down, and cannot be now")
            return result
        return found

    def _succeeded(self, actions: Tuple[Action, ...]) -> bool:
        """Whether the update in force says so of all of these."""
        return self._planner.in_force.heads.issuperset(map(success_of, actions))

    def record(self) -> Record:
        """Return the state by sections."""
        cycle, latest = self._latest
        numbers = [self._step, self._waits, self._improvable, self._announce.told, self._planner.lookahead, cycle]
        return {
            "core": [self._started, *numbers],
            "plan": None if self._plan is None else plan_to_value(self._plan),
            "latest": None if latest is self._plan else plan_to_value(latest),
            **({"doubt": plan_to_value(self._perhaps_begun)} if self._perhaps_begun.actions else {}),
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
        numbers = record["core"]
        self._started, self._step, self._waits, self._improvable, self._announce.told, lookahead, cycle = numbers
        self._planner = self._planner.at(log_of(record))
        self._planner.lookahead = lookahead
        plan, latest = record["plan"], record["latest"]
        self._plan = None if plan is None else plan_of(plan)
        self._perhaps_begun = plan_of(record["doubt"]) if "doubt" in record else TaskPlan()
        used = self._plan if latest is None else plan_of(latest)
        assert used is not None
        self._latest = cycle, used
        self._goals.restore(record)
        self._feeder.restore(record, self._goals.by_key)
        self._execution.restore(record)
        self._preemption.restore(record["preemption"])
        self._announce.state = frozenset(map(symbol_of, keys_of(record, "believed"))) or None
