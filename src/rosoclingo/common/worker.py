"""The one thread in which a node does its work; its ROS callbacks only put things into the queue."""

import queue
import threading
import traceback
from typing import Callable, Optional, TypeVar

import rospy

Job = Callable[[], None]
Answer = TypeVar("Answer")


class Worker:
    """Runs jobs one after the other, and ``settle`` after those that waited.

    Settling happens at least every ``period`` seconds of wall time.

    An exception that reaches the worker is a fault of the node:
    it is logged and the node shut down, as a node without its worker would only seem to live.
    """

    def __init__(self, settle: Job, period: float = 0.05) -> None:
        self._queue: queue.Queue[Optional[Job]] = queue.Queue()
        self._settle = settle
        self._period = period
        self._thread = threading.Thread(target=self._run, name="worker", daemon=True)

    def start(self) -> None:
        """Begin with the jobs that were put so far."""
        self._thread.start()

    def put(self, job: Job) -> None:
        """Have a job done; returns at once, from any thread."""
        self._queue.put(job)

    def ask(self, work: Callable[[], Answer], timeout: float = 30.0) -> Answer:
        """Have the worker find an answer and wait for it: what the callback of a service does.

        Raises rospy.ServiceException after ``timeout`` seconds (wall time).
        """
        answers: queue.Queue[Answer] = queue.Queue(1)
        self.put(lambda: answers.put(work()))
        try:
            return answers.get(timeout=timeout)
        except queue.Empty as error:
            raise rospy.ServiceException(f"{rospy.get_name()} does not answer") from error

    def stop(self, timeout: float) -> None:
        """End after the jobs that wait now, and wait for that, at most ``timeout`` seconds (wall time)."""
        self._queue.put(None)
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join(timeout)

    @property
    def waiting(self) -> bool:
        """Whether a job waits."""
        return not self._queue.empty()

    def _run(self) -> None:
        try:
            while self._once():
                pass
        except Exception:  # noqa: BLE001 the last resort: anything expected was caught where it belongs
            rospy.logfatal("the worker failed, the node ends:\n%s", traceback.format_exc())
            rospy.signal_shutdown("the worker failed")

    def _once(self) -> bool:
        """Do what waits now, or be idle for a period; False at the end."""
        try:
            jobs = [self._queue.get(timeout=self._period)]
        except queue.Empty:
            self._settle()
            return True
        jobs += [self._queue.get_nowait() for _ in range(self._queue.qsize())]
        for job in jobs:
            if job is None:
                return False
            job()
        self._settle()
        return True
