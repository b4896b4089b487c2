"""Planning thread of the move_base node, so that long planning does not delay commands."""

import time
from concurrent import futures
from typing import Callable, Optional

import rospy

from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid_planner import GlobalPlan, GlobalPlanner
from rosoclingo.robot.navigation.planning import Planning

# s of wall time that the worker waits for a plan: enough for most plans, and the robot then drives by the newest
GRACE = 0.02
LOG_TIMEOUT = 2.0  # s after which a running plan is logged


class Job:
    """One call of the planner, described by ``what``. Its future is cancelled if the plan is no longer needed."""

    def __init__(self, work: Callable[[], GlobalPlan], what: str) -> None:
        self.work, self.what = work, what
        self.future: futures.Future[GlobalPlan] = futures.Future()
        self.begun, self.logged = 0.0, 0  # wall time of the start; number of log messages


class PlanningThread(Planning):
    """Plans on snapshots of the costmap, one job after the other, for the robot and for services."""

    def __init__(self, planner: GlobalPlanner) -> None:
        super().__init__(planner)
        self._asked: Optional[Job] = None
        self._running: Optional[Job] = None
        self._worker = Worker(period=60.0)  # nothing is done periodically
        self._worker.start()

    def ask(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> None:
        """Request a plan, and wait for it for at most GRACE s; see :class:`Planning`."""
        self.drop()
        self._asked = self._put(costmap, start, goal, None, "the robot's path")
        futures.wait([self._asked.future], GRACE)

    def answer(self) -> Optional[GlobalPlan]:
        """Return the plan, None while it is pending; see :class:`Planning`."""
        job = self._asked
        if job is None or not job.future.done():
            return None
        self._asked = None
        return job.future.result()

    def drop(self) -> None:
        """Cancel the request; see :class:`Planning`."""
        if self._asked is not None:
            self.planner.cancelled[0] |= not self._asked.future.cancel() and self._running is self._asked
            self._asked = None

    def submit(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: float) -> "futures.Future[GlobalPlan]":
        """Return the future of a plan for a service, which does not drive the robot."""
        return self._put(costmap, start, goal, tolerance, "a requested plan").future

    def log_delays(self) -> None:
        """Log a warning if the current plan takes long."""
        job = self._running
        if job is not None and time.monotonic() - job.begun > LOG_TIMEOUT * 2**job.logged:
            job.logged += 1
            seconds = time.monotonic() - job.begun
            rospy.logwarn("planning takes long: planning %s for %.1f s", job.what, seconds)

    def _put(self, costmap: Costmap, start: Pose2D, goal: Pose2D, tolerance: Optional[float], what: str) -> Job:
        snapshot = costmap.snapshot()
        job = Job(lambda: self.planner.plan(snapshot, start, goal, tolerance), what)
        self._worker.put(self._run, job)
        return job

    def _run(self, job: Job) -> None:
        job.begun = time.monotonic()
        self.planner.cancelled[0], self._running = False, job
        if job.future.set_running_or_notify_cancel():
            try:
                job.future.set_result(job.work())
            except BaseException as error:  # noqa: BLE001 a plugin can raise any exception, passed to the caller
                job.future.set_exception(error if isinstance(error, Exception) else RuntimeError(repr(error)))
        self._running = None
        if job.logged:
            rospy.loginfo("planned %s in %.1f s", job.what, time.monotonic() - job.begun)
