"""Answers that are had before they are asked for, while actions run.

Two are worth it. What is to be done should the action fail, or where something new waits should it succeed. And a plan
with goals that wait since there is no room for them: for many goals that takes longer than a robot may stand still, so
it is made for a later cycle, up to which the plan that there is goes on, and in which the goals join. Where anything
else comes before, it is of no use, and the goals wait as they would have.
"""

import math
from typing import Callable, NamedTuple, Optional, Tuple

from rosoclingo.oclingo import StreamUpdate
from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.goal_manager import GoalManager
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import Batch, InputFeeder
from rosoclingo.reasoning.returns import ExecutionMonitor
from rosoclingo.reasoning.stream_planner import Planner, steps_for

#: So many times the time that a plan for all goals is expected to take is given to it.
MARGIN = 2.0

#: Seconds that it takes beside: a solver has to read what was done.
START = 1.0

#: So many times as many goals as there are may join at once: how long a plan for still more takes is hard to tell.
MOST = 1.5

#: And at most so many times as long where plans were not there in time.
SLOWEST = 8.0

#: Goals that join a plan for others later, at least, if so many wait, or half as many as there are.
FEW = 4


class Outlook(NamedTuple):
    """Of the next update: its step, the cycle ``over`` before which all comes too late, and how far it looks."""

    step: int
    over: int
    lookahead: int


class Join(NamedTuple):
    """Goals that are to join in a later cycle.

    ``over`` and ``lookahead`` stay until then, ``updates`` are those that are predicted, the last without the goals;
    with them it is ``whole``.
    """

    planner: Planner
    goals: Tuple[Goal, ...]
    over: int
    lookahead: int
    updates: Tuple[StreamUpdate, ...]
    whole: StreamUpdate

    @property
    def first(self) -> int:
        """The cycle of the first update."""
        return self.updates[0].step or 0

    @property
    def cycle(self) -> int:
        """The cycle in which the goals join."""
        return self.updates[-1].step or 0


class Preparations:
    """Has answers prepared; ``limit`` is how many steps a plan for one goal may have.

    Attributes:
        join: the goals that are to join later: until then the plan should go on as it is, and nobody else joins.

    """

    def __init__(self, goals: GoalManager, feeder: InputFeeder, execution: ExecutionMonitor, limit: int) -> None:
        self._goals, self._feeder, self._execution, self._limit = goals, feeder, execution, limit
        self.join: Optional[Join] = None
        self._reach = math.inf  # so many cycles nothing unforeseen is likely to come
        self._slower = 1.0  # so many times as long as expected plans take
        self._seen = self._asked = 0  # the last step, and that for which a plan was asked for last
        self._ended = -math.inf  # the cycle in which goals joined last, or there was no plan for that

    def prepare(self, planner: Planner, plan: TaskPlan, step: int, outlook: Callable[[], Outlook]) -> None:
        """Have prepared what is worth it before the update of ``step``; ``plan`` is the one that was used last."""
        if self._join_may_come(planner, step) or self._begin_join(planner, plan, step):
            return
        likely = self._execution.likely_return(succeeds=self._feeder.pending)
        if likely is not None:
            _, over, lookahead = outlook()
            planner.prepare([self._feeder.preview(step, self._execution.under_way, [likely], over)], lookahead)

    def next_update(self, planner: Planner, step: int, over: int) -> Batch:
        """The next update, while goals are to join: with them when it is time, unless something else has come."""
        batch, join = self._feeder.next_update(step, over), self.join
        assert join is not None
        if not self._may_come(join, planner) or batch.update != join.updates[step - join.first]:
            self._lose(join, step)
        elif step == join.cycle and not planner.has_prepared(join.whole):
            self._slower, self._ended = min(2 * self._slower, SLOWEST), step
            self._end(join, "the plan with it was not there by the cycle in which it was to join")
        elif step == join.cycle:
            self._reach, self._slower = 2 * self._reach, max(1.0, self._slower / 2)
            self.join, self._ended = None, step
            self._goals.join(join.goals)
            batch = self._feeder.next_update(step, over)
            self._goals.release()
        return batch

    def _begin_join(self, planner: Planner, plan: TaskPlan, step: int) -> bool:
        """Have a plan made for a later cycle with goals that wait, if there are any; tell whether that is so."""
        queue, cycle = self._goals.queue, step - 1
        left = plan.steps_after(cycle)
        new = any((goal.request_cycle or 0) >= step for goal in self._goals.fed)  # the plan is to be improved first
        idle = self._feeder.has_beside(()) or not (queue.joinable and left and self._execution.awaited)
        if new or idle or self._asked == step:
            return False
        self._reach, self._seen = self._reach + (step != self._seen), step  # further from cycle to cycle
        most = min(self._reach, max(2, left // 2))
        served = len(queue.served)
        waiting = queue.joinable[: math.ceil(MOST * served)]
        number = next((one for one in range(len(waiting), 0, -1) if self._cycles_for(served + one) <= most), 0)
        lasts = self._cycles_for(served + number)
        # while such a plan is made the one that there is gets no shorter: between, there is half as much time for that
        if number < min(len(waiting), max(FEW, served // 2)) or cycle - self._ended < lasts / 2:
            return False
        goals, over, fresh = waiting[:number], planner.log.keep_from, number + served - len(self._goals.fed)
        lookahead = steps_for(served + number, self._limit, left, fresh)
        last = cycle + int(lasts)
        updates = [self._feeder.predicted(one, plan.at(one - 1), (), over) for one in range(step, last + 1)]
        self._asked = step
        whole = self._feeder.predicted(last, plan.at(last - 1), goals, over)
        if not planner.prepare([*updates[:-1], whole], lookahead):
            return False
        self.join = Join(planner, tuple(goals), over, lookahead, tuple(updates), whole)
        self._goals.hold(goals, f"it joins in cycle {last}, a plan is made for that")
        return True

    def _join_may_come(self, planner: Planner, step: int) -> bool:
        """Tell whether goals are to join; where something else has come by now they are not."""
        join = self.join
        if join is None:
            return False
        planner.has_prepared(join.whole)  # what the other process tells is read as it comes, it may be much
        if self._may_come(join, planner) and not self._feeder.has_beside(join.updates[step - join.first].heads):
            return True
        self._lose(join, step)
        return False

    def _may_come(self, join: Join, planner: Planner) -> bool:
        return planner is join.planner and all(map(self._goals.queue.waits, join.goals))

    def _lose(self, join: Join, step: int) -> None:
        """Something else has come before the update of ``step``, or comes with it."""
        self._reach = max(1, step - join.first)
        self._end(join, "something else has come before the cycle in which it was to join")

    def _end(self, join: Join, why: str) -> None:
        self.join = None
        self._goals.release(join.goals, why)

    def _cycles_for(self, goals: int) -> float:
        """After how many cycles there should be a plan for so many goals."""
        seconds, lasts = self._goals.queue.window.seconds_for(goals), self._execution.seconds_per_cycle
        if seconds is None or lasts <= 0.0:
            return math.inf
        return 1 + math.ceil(MARGIN * self._slower * (START + seconds) / lasts)
