"""The thread in which the move_base node plans, so that a long plan does not hold up the robot's commands."""

import queue
import threading
import time
import traceback
from collections import deque
from concurrent import futures
from typing import Callable, Deque, Optional, Tuple

import rospy

from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation import Costmap, GlobalPlanner, Plan, Pose2D
from rosoclingo.robot.navigation.planning import Planning

GRACE = (
    0.02  # s of wall time that the worker waits for a plan: most are there by then, and the robot drives by the newest
)
LONG = 2.0  # s: a plan that takes longer is told of
BEGINNING, PORTION = 2.0, 0.03  # s: of what is prepared when a map has come, and then at a time


class Job:
    """One call of the planner, with what it comes to; ``dropped``: nobody waits for that any more.

    ``what`` is looked for, in words; empty where nobody need know.
    """

    def __init__(self, work: Callable[[Costmap], object], what: str) -> None:
        self.work, self.what = work, what
        self.future: futures.Future = futures.Future()
        self.dropped = False
        self.begun = 0.0  # wall time
        self.told = 0


class PlanningThread(Planning):
    """Plans on a twin of the costmap, one job after the other: the navigator's first, then those of services.

    All but the planner's own calls is for the worker's thread.
    """

    def __init__(self, worker: Worker, planner: GlobalPlanner) -> None:
        super().__init__(planner)
        planner.wanted = lambda: not (self._running is not None and self._running.dropped)
        self._worker = worker
        self._costmap: Optional[Costmap] = None
        self._twin: Optional[Costmap] = None
        self._asked: Optional[Job] = None
        self._waiting: Deque[Job] = deque()
        self._running: Optional[Job] = None
        self._more_to_prepare = False
        self._jobs: queue.Queue[Tuple[Job, Costmap]] = queue.Queue()
        self._thread = threading.Thread(target=self._run, name="planning", daemon=True)
        self._thread.start()

    def take_map(self, costmap: Costmap) -> None:
        """Plan on another map from now on, and prepare for it first."""
        if self._running is not None:
            self._running.dropped = True
        self._costmap, self._twin = costmap, costmap.twin()
        self._more_to_prepare = True
        self._waiting.appendleft(self._preparation(BEGINNING))
        self._begin()

    def ask(self, costmap: Costmap, start: Pose2D, goal: Pose2D) -> None:
        """Ask for a plan on the map that was taken; see :class:`Planning`. Waits for it a moment."""
        self.drop()
        self._asked = Job(lambda twin: self.planner.plan(twin, start, goal), "the robot's way")
        if self._running is not None:
            futures.wait([self._running.future], GRACE)  # a preparation ends soon, then
        self._begin()
        if self._asked.begun:
            futures.wait([self._asked.future], GRACE)

    def answer(self) -> Optional[Plan]:
        """Return the plan, None while it is not there; see :class:`Planning`."""
        job = self._asked
        if job is None or not job.future.done():
            return None
        self._asked = None
        found: Plan = job.future.result()
        return found

    def drop(self) -> None:
        """Want no plan any more; see :class:`Planning`."""
        if self._asked is not None:
            self._asked.dropped, self._asked = True, None

    def also(self, start: Pose2D, goal: Pose2D, tolerance: float) -> "futures.Future":
        """Return what comes to be another plan, which does not drive the robot."""
        job = Job(lambda twin: self.planner.plan(twin, start, goal, tolerance), "a plan that was asked for")
        self._waiting.append(job)
        self._begin()
        return job.future

    def spare(self) -> None:
        """Have the planner prepare a little, as there is time."""
        if self._more_to_prepare and self._idle and not self._waiting and self._asked is None:
            self._waiting.append(self._preparation(PORTION))
            self._begin()

    def tell(self) -> None:
        """Tell of what takes long."""
        job = self._running
        if job is None or job.future.done() or not job.what:
            return
        seconds = time.monotonic() - job.begun
        if seconds > LONG * 2**job.told:
            job.told += 1
            rospy.logwarn("planning takes long: %s is looked for since %.1f s", job.what, seconds)

    @property
    def _idle(self) -> bool:
        return self._running is None or self._running.future.done()

    def _begin(self) -> None:
        """Have the next job done, if there is one and the one before has ended."""
        if not self._idle or self._costmap is None or self._twin is None:
            return
        if self._running is not None and self._running.told:
            rospy.loginfo("planned after %.1f s: %s", time.monotonic() - self._running.begun, self._running.what)
        self._running = None
        job = self._asked if self._asked is not None and not self._asked.begun else None
        if job is None and self._waiting:
            job = self._waiting.popleft()
        if job is not None:
            self._twin.catch_up(self._costmap)
            self._running, job.begun = job, time.monotonic()
            self._jobs.put((job, self._twin))

    def _preparation(self, seconds: float) -> Job:
        """Return the job to prepare for so long, or until the navigator wants a plan."""

        def work(twin: Costmap) -> None:
            """Prepare, and learn whether there is more to do."""
            end, more = time.monotonic() + seconds, True
            try:
                while more and self._asked is None and time.monotonic() < end:
                    more = self.planner.prepare(twin)
            except Exception:  # noqa: BLE001 a plugin may raise anything, which costs nothing but its gain
                rospy.logerr("a plugin failed:\n%s", traceback.format_exc())
                more = False
            self._more_to_prepare = more

        return Job(work, "")

    # ---- the thread -----------------------------------------------------------------------------------------------

    def _run(self) -> None:
        while True:
            job, twin = self._jobs.get()
            try:
                job.future.set_result(job.work(twin))
            except BaseException as error:  # noqa: BLE001 a plugin may raise anything: told where the plan is waited for
                job.future.set_exception(error if isinstance(error, Exception) else RuntimeError(repr(error)))
            self._worker.put(self._begin)
