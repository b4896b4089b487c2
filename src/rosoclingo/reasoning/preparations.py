"""Prefetching: the standby worker solves likely updates while the robot acts.

The robot does not stop for a search while the current plan continues. New goals and cancellations join in the next
update if a plan with them is found soon. Otherwise the current plan continues without them, and the standby worker
plans for a later cycle, in which they join. The distance to that cycle doubles after each plan that came too late. A
cancellation whose plan came too late has more time at its next cycle, so that the robot stops soon on a slow machine.

Without new requests, the standby worker prefetches the answer to a failure.
"""

from typing import Iterable, NamedTuple, Optional, Tuple

from rosoclingo.oclingo import StreamUpdate
from rosoclingo.reasoning.action_extractor import TaskPlan
from rosoclingo.reasoning.goal_manager import GoalManager
from rosoclingo.reasoning.goals import Goal
from rosoclingo.reasoning.input_feeder import Batch, InputFeeder, Request, goals_of
from rosoclingo.reasoning.returns import ExecutionMonitor
from rosoclingo.reasoning.stream_planner import Planner, SearchWatch, steps_for

LATE_PATIENCE = 3
"""Factor of the time that a plan with a cancellation has, once such a plan came too late."""


class Join(NamedTuple):
    """Requests (goals and cancellations) that join in a later cycle.

    Attributes:
        planner: the planner whose updates are predicted.
        requests: the goals and the identifiers of cancelled goals.
        since: the cycle of the oldest request that matters, fixed until the requests join.
        lookahead: the lookahead of all updates until then.
        updates: the predicted updates, the last one without the requests.
        whole: the last update with the requests.

    """

    planner: Planner
    requests: Tuple[Request, ...]
    since: int
    lookahead: int
    updates: Tuple[StreamUpdate, ...]
    whole: StreamUpdate

    @property
    def first(self) -> int:
        """The cycle of the first update."""
        return self.updates[0].step or 0

    @property
    def cycle(self) -> int:
        """The cycle in which the requests join."""
        return self.updates[-1].step or 0


class Preparations:
    """Prefetches answers, and selects the requests of the next update.

    Attributes:
        join: the requests that join later, None if no search for them is running.

    """

    def __init__(
        self,
        goals: GoalManager,
        feeder: InputFeeder,
        execution: ExecutionMonitor,
        limit: int,
        watch: Optional[SearchWatch],
    ) -> None:
        """Prefetch for the core; ``limit`` is the maximum number of steps of a plan for one goal.

        ``watch`` ends the wait for a plan with new requests while the current plan continues. None: new requests are
        always in the next update.
        """
        self._goals, self._feeder, self._execution, self._limit = goals, feeder, execution, limit
        self._watch = watch
        self.join: Optional[Join] = None
        self._cycles = 1  # the distance to the cycle in which requests join
        self._prepared: Tuple[object, ...] = ()  # the situation for which the answer is prefetched

    def prepare(self, planner: Planner, plan: TaskPlan, step: int) -> None:
        """Prefetch the answer to the update of ``step`` or a later one; ``plan`` is the current plan.

        Returns at once if nothing has changed since the last call.
        """
        join = self.join
        if join is not None:
            planner.has_prepared(join.whole)  # reads the reports of the standby worker, which can be long
            if self._is_broken(join, planner) or self._feeder.has_unexpected(join.updates[step - join.first].heads):
                self.join = None
        if self.join is not None or not self._execution.awaited:
            return
        feeder, execution = self._feeder, self._execution
        situation = (planner.log, feeder.arrivals, feeder.pending, self._requests, execution.awaited)
        if situation == self._prepared:
            return
        first_open, lookahead = self._outlook(planner, plan, step)
        likely = execution.likely_end(succeeds=feeder.pending)
        if self._begin_join(planner, plan, step, lookahead):
            return
        if likely is not None:
            ending, answer = likely
            others = {action: planned for action, planned in execution.running.items() if action != ending}
            update = feeder.preview(step, execution.under_way, [answer], first_open)
            if not planner.prepare([update], lookahead, others):
                return
        self._prepared = situation

    def next_update(self, planner: Planner, plan: TaskPlan, step: int, followed: bool = True) -> Batch:
        """Return the next update, and set the lookahead of the planner.

        The update has the new requests if a plan with them was found, or if the current plan ends without them or is
        not ``followed``.
        """
        self.join = self.join if followed else None
        first_open, planner.lookahead = self._outlook(planner, plan, step)
        batch, join = self._feeder.next_update(step, first_open), self.join
        if self._watch is None or not followed or not (join or self._requests):
            return batch
        rest, predicted = self._feeder.next_update(step, first_open, ()), self._predicted(plan, step, first_open)
        goes_on = not rest.failures and planner.predicts(predicted)
        if join is not None and (self._is_broken(join, planner) or rest.update != join.updates[step - join.first]):
            self.join = None
        if self.join is None and goes_on and rest.update == predicted:
            self._begin_join(planner, plan, step, planner.lookahead)
        if self.join is None:
            if not plan.steps_after(step - 1):
                self._cycles = 1
            return rest if goes_on and self._is_late(planner, batch, rest) else batch
        if step == self.join.cycle:
            late = self._cycles > 1 and not all(isinstance(one, Goal) for one in self.join.requests)
            whole, waits = self.join.whole, range(LATE_PATIENCE if late else 1)
            if not goes_on or any(planner.has_prepared(whole, self._watch) for _ in waits):
                return self._complete(self.join)
            self._cycles, self.join = 2 * len(self.join.updates), None
            self._begin_join(planner, plan, step, planner.lookahead)
        return rest

    def _outlook(self, planner: Planner, plan: TaskPlan, step: int) -> Tuple[int, int]:
        """Return the cycle before which facts are too late for the update of ``step``, and its lookahead."""
        if self.join is not None:
            return planner.first_open(step, self.join.since), self.join.lookahead
        goals, fed = len(self._goals.queue.served), self._goals.fed
        steps = steps_for(goals, self._limit, plan.steps_after(step - 1), goals - len(fed))
        return planner.first_open(step, self._since(step)), steps

    def _since(self, step: int) -> int:
        """Return the cycle before the oldest request that the program has."""
        return min((goal.request_cycle or step for goal in self._goals.fed), default=step) - 1

    @property
    def _requests(self) -> Tuple[Request, ...]:
        """The requests that can join; goals without room come last."""
        return (*self._feeder.requests, *self._goals.queue.joinable)

    def _predicted(self, plan: TaskPlan, step: int, first_open: int, requests: Iterable[Request] = ()) -> StreamUpdate:
        """Return the update of ``step`` after the success of all actions, with ``requests``."""
        return self._feeder.predicted(step, plan.at(step - 1), requests, first_open)

    def _begin_join(self, planner: Planner, plan: TaskPlan, step: int, lookahead: int) -> bool:
        """Start a search for a plan with the new requests; return whether there are any and it has begun."""
        requests, left, since = self._requests, plan.steps_after(step - 1), self._since(step)
        disturbed = self._feeder.has_unexpected(self._predicted(plan, step, 0).heads)
        if self._watch is None or not requests or disturbed:
            return False
        goals = len({*self._goals.queue.served, *goals_of(requests)})
        steps = max(lookahead, steps_for(goals, self._limit, left, goals - len(self._goals.fed)))
        last = step - 1 + min(self._cycles, left + 1)
        updates = [self._predicted(plan, one, planner.first_open(one, since)) for one in range(step, last + 1)]
        whole = self._predicted(plan, last, planner.first_open(last, since), requests)
        if not planner.prepare([*updates[:-1], whole], steps):
            return False
        planner.lookahead, self.join = steps, Join(planner, requests, since, steps, tuple(updates), whole)
        if last > step:
            self._goals.report_wait(goals_of(requests), f"it joins the plan in cycle {last}")
        return True

    def _complete(self, join: Join) -> Batch:
        """Return the update in which requests join."""
        self.join, self._cycles = None, max(1, 3 * self._cycles // 4)
        self._goals.join(goal for goal in goals_of(join.requests) if goal.waits)
        first_open = join.planner.first_open(join.cycle, join.since)
        return self._feeder.next_update(join.cycle, first_open, join.requests)

    def _is_late(self, planner: Planner, batch: Batch, rest: Batch) -> bool:
        """Return whether ``batch`` has more requests than ``rest``, and no answer was found soon."""
        begun = batch.requests != rest.requests and planner.prepare([batch.update], planner.lookahead)
        return begun and not planner.has_prepared(batch.update, self._watch)

    def _is_broken(self, join: Join, planner: Planner) -> bool:
        """Return whether a search for requests is obsolete: some were dropped, or others cannot wait for it."""
        waiting = (*self._feeder.requests, *self._goals.queue.waiting)
        new = [one for one in self._feeder.requests if one not in join.requests]
        soon = len(join.updates) == 1 or not all(isinstance(one, Goal) for one in new)
        return planner is not join.planner or not set(join.requests).issubset(waiting) or (bool(new) and soon)
