"""The thread in which the move_base node plans, so that a long plan does not hold up the robot's commands."""

import queue
import threading
import time
from concurrent import futures
from typing import Callable, Optional

import rospy

from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid_planner import GlobalPlan, GlobalPlanner
from rosoclingo.robot.navigation.planning import Planning

# s of wall time that the worker waits for a plan: most are there by then, and the robot drives by the newest
GRACE = 0.02
LONG = 2.0  # s: a plan that takes longer is logged


class Job:
    """One call of the planner for ``what``, in words; its future is cancelled when its plan is not wanted any more."""

    def __init__(self, work: Callable[[], GlobalPlan], what: str) -> None:
        self.work, self.what = work, what
        self.future: futures.Future[GlobalPlan] = futures.Future()
        self.begun, self.logged = 0.0, 0  # wall time; how often it was logged


class PlanningThread(Planning):
    """Plans on snapshots of the costmap, one job after the other, those of the robot and those of services."""

    def __init__(self, planner: GlobalPlanner) -> None:
        super().__init__(planner)
        self._asked: Optional[Job] = None
        self._running: Optional[Job] = None
        self._jobs: queue.Queue[Job] = queue.Queue()
        threading.Thread(target=self._run, name="planning", daemon=True).start()

    def ask(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> None:
        """Ask for a plan; see :class:`Planning`. Waits for it a moment."""
        self.drop()
        self._asked = self._put(costmap, start, goal, None, "the robot's way")
        futures.wait([self._asked.future], GRACE)

    def answer(self) -> Optional[GlobalPlan]:
        """Return the plan, None while it is not there; see :class:`Planning`."""
        job = self._asked
        if job is None or not job.future.done():
            return None
        self._asked = None
        return job.future.result()

    def drop(self) -> None:
        """Want no plan any more; see :class:`Planning`."""
        if self._asked is not None:
            self.planner.dropped[0] |= not self._asked.future.cancel() and self._running is self._asked
            self._asked = None

    def also(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: float) -> "futures.Future[GlobalPlan]":
        """Return the future of another plan, which does not drive the robot."""
        return self._put(costmap, start, goal, tolerance, "a requested plan").future

    def log_delays(self) -> None:
        """Log that a plan takes long."""
        job = self._running
        if job is not None and time.monotonic() - job.begun > LONG * 2**job.logged:
            job.logged += 1
            seconds = time.monotonic() - job.begun
            rospy.logwarn("planning takes long: %s is looked for since %.1f s", job.what, seconds)

    def _put(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float], what: str) -> Job:
        snapshot = costmap.snapshot()
        job = Job(lambda: self.planner.plan(snapshot, start, goal, tolerance), what)
        self._jobs.put(job)
        return job

    def _run(self) -> None:
        while True:
            job = self._jobs.get()
            job.begun = time.monotonic()
            self.planner.dropped[0], self._running = False, job
            if job.future.set_running_or_notify_cancel():
                try:
                    job.future.set_result(job.work())
                except BaseException as error:  # noqa: BLE001 a plugin may raise anything; the caller gets it
                    job.future.set_exception(error if isinstance(error, Exception) else RuntimeError(repr(error)))
            self._running = None
            if job.logged:
                rospy.loginfo("planned after %.1f s: %s", time.monotonic() - job.begun, job.what)
