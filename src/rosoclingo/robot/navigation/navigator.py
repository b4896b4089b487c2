"""Navigation to a goal: the state machine of move_base, without ROS."""

import math
from typing import Callable, Dict, List, Optional

import numpy as np

from rosoclingo.robot.navigation.brake import brake
from rosoclingo.robot.navigation.compiled.path import is_blocked
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid_planner import GlobalPlan, GlobalPlanner, PlanOutcome
from rosoclingo.robot.navigation.local_planner import FollowOutcome, LocalPlanner, Velocity
from rosoclingo.robot.navigation.navigation_types import (
    TRANSITIONS,
    NavigationError,
    NavigationOutcome,
    NavigatorLimits,
    NavigatorState,
    Result,
    Tick,
)
from rosoclingo.robot.navigation.planning import Planning
from rosoclingo.robot.navigation.progress import PathProgress
from rosoclingo.robot.navigation.recovery_behaviors import RecoveryBehavior

# Minimum time (s) between two plans. Limits replanning while a blocked robot keeps seeing new obstacles.
PLAN_PERIOD = 0.25
# Maximum relative length of a new path that replaces an unblocked one, to avoid oscillation between equally long paths.
LENGTH_RATIO = 0.9
TOLERANCE = 0.75  # cells: tolerance in the clearance of a path


class Navigator:
    """Drives the robot to goals: turns pose and velocity into commands, once per control period.

    Plans come from ``planning``. While a plan is pending, the robot follows the old path, or stops if there is none.
    Optional observers: ``on_plan(points)``, ``on_recovery(behavior, number, total, pose)``, ``on_log(text)``.
    """

    def __init__(
        self,
        costmap: Costmap,
        planner: GlobalPlanner,
        follower: LocalPlanner,
        recoveries: List[RecoveryBehavior],
        limits: Optional[NavigatorLimits] = None,
        planning: Optional[Planning] = None,
    ) -> None:
        self.costmap, self.follower = costmap, follower
        self.planning = planning or Planning(planner)
        # Whether the pending plan must be better than the old path to replace it; None: no plan is pending.
        self._asked: Optional[bool] = None
        self.recoveries = recoveries
        self.limits = limits or NavigatorLimits()
        self.state = NavigatorState.IDLE
        self.goal = Pose2D(0.0, 0.0)
        self.plan = GlobalPlan(PlanOutcome.NO_PATH, np.empty((0, 2)))
        self.on_plan: Callable[[np.ndarray], None] = lambda points: None
        self.on_recovery: Callable[[RecoveryBehavior, int, int, Pose2D], None] = lambda *event: None
        self.on_log: Callable[[str], None] = lambda text: None
        self._now = 0.0
        self._changed = False
        self._blind_since: Optional[float] = None
        self._start(0.0)
        self._handlers: Dict[NavigatorState, Callable[[float, Pose2D, Velocity, float], Tick]] = {
            NavigatorState.PLANNING: self._planning,
            NavigatorState.CONTROLLING: self._controlling,
            NavigatorState.CLEARING: self._clearing,
        }

    @property
    def active(self) -> bool:
        """Whether there is a goal."""
        return self.state is not NavigatorState.IDLE

    def set_goal(self, now: float, goal: Pose2D) -> None:
        """Replace the goal by a pose (m, rad; in the map frame). ``now``: present time (s)."""
        self.goal = goal
        self._start(now)
        self._go(NavigatorState.PLANNING)

    def cancel(self) -> None:
        """Abandon the goal."""
        if self.active:
            self._go(NavigatorState.IDLE)

    def take_map(self, costmap: Costmap) -> None:
        """Replace the costmap."""
        self._drop()
        self.costmap, self._changed = costmap, True

    def obstacles_changed(self) -> None:
        """Note that the costmap has changed, so that the path is checked again."""
        self._changed = True

    def tick(self, now: float, pose: Pose2D, velocity: Velocity, period: float) -> Tick:
        """Advance by one control period (s). Raises NavigationError when idle."""
        if not self.active:
            raise NavigationError("tick without a goal")
        if now < self._now:
            self.on_log(f"Time went back by {self._now - now:.1f} s: timeouts restart")
            self._start(now)
        self._now, self._blind_since = now, None
        self.costmap.forget_under(pose.x, pose.y)
        tick = self._handlers[self.state](now, pose, velocity, period)
        if tick.result is not None:
            self._go(NavigatorState.IDLE)
        follower = self.follower
        slow = brake(tick.velocity, pose, self.costmap.unmarked, follower.radius, follower.footprint)
        return tick._replace(velocity=slow)

    def stop_blind(self, now: float, outcome: NavigationOutcome, reason: str) -> Tick:
        """Stop for a control period without a pose or a scan. After controller_patience, end the goal."""
        if now < self._now:
            self._start(now)
        if self._blind_since is None or now < self._blind_since:
            self._blind_since = now
        self._now = now
        if now - self._blind_since <= self.limits.controller_patience:
            return Tick()
        self._go(NavigatorState.IDLE)
        return Tick(result=Result(outcome, f"{outcome.value}: {reason}"))

    def _start(self, now: float) -> None:
        """Reset timers and counters for a new goal."""
        self._drop()
        self._now = self._last_plan = self._last_control = now
        self._progress = PathProgress(self.limits, now)
        self.costmap.unbar()
        self._planned_at = -math.inf
        self._tries = self._recovery = 0
        self._running: Optional[RecoveryBehavior] = None
        self._blind_since = None

    def _go(self, state: NavigatorState) -> None:
        if state.value not in TRANSITIONS[self.state.value]:
            raise NavigationError(f"no transition from {self.state.value} to {state.value}")
        if state in (NavigatorState.IDLE, NavigatorState.CLEARING):
            self._drop()
        self.state = state

    def _planning(self, now: float, pose: Pose2D, velocity: Velocity, period: float) -> Tick:
        """Plan a path. If there is none, retry for planner_patience, then recover."""
        found = self._make_plan(now, pose)
        if found is None:
            return Tick()
        if found:
            self._last_control = now
            self._go(NavigatorState.CONTROLLING)
            return self._controlling(now, pose, velocity, period)
        self._tries += 1
        outcome, reason = NavigationOutcome.NO_PLAN, self.plan.outcome.value
        if self.plan.outcome.on_map:
            return Tick(result=Result(outcome, f"{outcome.value}: {reason}."))
        patient = now - self._last_plan <= self.limits.planner_patience
        if patient and not 0 <= self.limits.max_planning_retries < self._tries:
            return Tick()
        return self._recover(now, pose, outcome, reason)

    def _controlling(self, now: float, pose: Pose2D, velocity: Velocity, period: float) -> Tick:
        """Follow the path. Replan at planner_frequency and when the path is blocked."""
        if not self._replan(now, pose):
            self._last_plan = max(self._last_plan, now)
            self._go(NavigatorState.PLANNING)
            return Tick()
        if self._progress.update(now, self.follower.length_left(pose)):
            self._recovery = 0
            self.costmap.unbar()
        for outcome, reason in (
            (NavigationOutcome.OSCILLATING, self._progress.oscillates(now, pose)),
            (NavigationOutcome.NO_PROGRESS, self._progress.stuck(now)),
        ):
            if reason:
                return self._recover(now, pose, outcome, reason)
        command = self.follower.compute(self.costmap, pose, velocity, period)
        if command.outcome is FollowOutcome.REACHED:
            return Tick(result=Result(NavigationOutcome.REACHED, NavigationOutcome.REACHED.value + "."))
        if command.outcome is FollowOutcome.DRIVING:
            self._last_control = now
            return Tick(command.velocity)
        if now - self._last_control > self.limits.controller_patience:
            return self._recover(now, pose, NavigationOutcome.NO_CONTROL, command.outcome.value)
        if command.at is not None:
            self.costmap.bar(*command.at)
        self._changed = True  # replan, in case the robot has left its path
        return Tick()

    def _clearing(self, now: float, pose: Pose2D, velocity: Velocity, period: float) -> Tick:
        """Continue the recovery behaviour; replan when it is done."""
        if self._running is not None:
            step = self._running.step(now, pose, self.costmap, self.follower)
            if not step.done:
                return Tick(step.velocity)
        self._running = None
        self._last_plan = self._last_control = now
        self._progress.restart(now)
        self.costmap.unbar()
        self._tries = 0
        self._go(NavigatorState.PLANNING)
        return Tick()

    def _recover(self, now: float, pose: Pose2D, outcome: NavigationOutcome, reason: str) -> Tick:
        """Start the next recovery behaviour, or abort if there is none left."""
        if not self.limits.recovery_behavior_enabled or self._recovery >= len(self.recoveries):
            words = "Even after executing recovery behaviors"
            return Tick(result=Result(outcome, f"{outcome.value}. {words}: {reason}."))
        self._running = self.recoveries[self._recovery]
        self._recovery += 1
        self.on_log(f"{reason}: recovery behavior {self._running.name}")
        self.on_recovery(self._running, self._recovery - 1, len(self.recoveries), pose)
        self._running.start(now, pose)
        self._go(NavigatorState.CLEARING)
        return Tick()

    def _ask(self, pose: Pose2D, keep: bool) -> Optional[GlobalPlan]:
        """Request a plan. Return it if it is available at once."""
        self._asked, self._changed = keep, False
        self.planning.ask(self.costmap, pose, self.goal)
        return self.planning.answer()

    def _drop(self) -> None:
        if self._asked is not None:
            self._asked = None
            self.planning.drop()

    def _make_plan(self, now: float, pose: Pose2D, keep: bool = False) -> Optional[bool]:
        """Request or continue a plan. Return whether there is a path to follow, None while the plan is pending."""
        if self._asked is not None:
            plan = self.planning.answer()
        else:
            plan = self._ask(pose, keep)
        if plan is not None and plan.outcome is not PlanOutcome.FOUND and self.costmap.unbar():
            plan = self._ask(pose, keep)
        return None if plan is None else self._take_plan(now, pose, plan)

    def _take_plan(self, now: float, pose: Pose2D, plan: GlobalPlan) -> bool:
        """Adopt a plan unless the old path is as good. Return whether there is a path to follow."""
        keep, self._asked = self._asked, None
        self._planned_at = now
        if plan.outcome is not PlanOutcome.FOUND:
            self.plan = plan
            return False
        self._last_plan, self._tries = now, 0
        if keep and not self._blocked(pose) and plan.length > LENGTH_RATIO * self.follower.length_left(pose):
            return True
        self.plan = plan
        self.follower.set_plan(self.plan.points, self.goal)
        self.on_plan(self.plan.points)
        self._progress.set_path(now, plan.length)
        return True

    def _replan(self, now: float, pose: Pose2D) -> bool:
        """Replan if necessary. Return whether there is a path to follow."""
        if self._asked is not None:
            return self._make_plan(now, pose) is not False
        if not self._changed:
            return True
        since = now - self._planned_at
        due = self.limits.planner_frequency > 0 and since >= 1.0 / self.limits.planner_frequency - 1e-3
        if due or (since >= PLAN_PERIOD and self._blocked(pose)):
            return self._make_plan(now, pose, keep=True) is not False
        return True

    def _blocked(self, pose: Pose2D) -> bool:
        """Return whether the path before the robot is blocked."""
        costmap = self.costmap
        radius = max(self.follower.radius, self.plan.radius) / costmap.resolution
        cells = costmap.all_to_cells(self.plan.points)
        x, y = costmap.to_cells(pose.x, pose.y)
        return bool(is_blocked(costmap.clearance, costmap.closed, cells, x, y, radius - TOLERANCE))
