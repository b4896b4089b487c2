"""The worker thread of a node, which runs all its work; ROS callbacks only put jobs into the queue."""

import queue
import threading
import time
import traceback
from concurrent import futures
from contextlib import suppress
from functools import partial
from typing import Callable, List, Optional, TypeVar

import rospy

Job = Callable[[], object]
Settle = Callable[[], Optional[float]]
Answer = TypeVar("Answer")

#: Seconds of wall time between two checks for the worker's end while an answer is awaited.
CHECK = 0.5

_failure = threading.Event()  # of any worker, since it ends the process


def failed() -> bool:
    """Return whether a worker of this process has failed."""
    return _failure.is_set()


def ending() -> bool:
    """Return whether the node shuts down: rospy closes the topics before ``rospy.is_shutdown`` returns True."""
    return bool(rospy.core.is_shutdown_requested())


class Worker:
    """Runs jobs in order, and calls the settlers after each batch and periodically.

    Settlers do the periodic work. They run at least every ``period`` seconds of wall time; a settler can return the
    seconds until its next turn instead.

    An exception that reaches the worker is an internal error, and its state can be inconsistent. The worker logs the
    traceback and shuts the node down (run_node: with exit code 1), as a node without its worker would only seem alive.
    Callers of plugins, subclasses of users and files catch their exceptions.
    """

    def __init__(self, settle: Optional[Settle] = None, period: float = 0.05) -> None:
        self._queue: queue.Queue[Optional[Job]] = queue.Queue()
        self._settlers: List[Settle] = [settle] if settle is not None else []
        self._period = period
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="worker", daemon=True)

    def add(self, settle: Settle) -> None:
        """Add a settler."""
        self._settlers.append(settle)

    def start(self) -> None:
        """Start with the jobs in the queue."""
        self._thread.start()

    def put(self, job: Callable[..., object], *arguments: object) -> None:
        """Queue a job with its arguments; return immediately, from any thread, without any lock that a job can hold."""
        self._queue.put(partial(job, *arguments) if arguments else job)

    def ask(self, work: Callable[[], Answer], timeout: float = 30.0) -> Answer:
        """Run ``work`` on the worker and return its result, for the callback of a service.

        Raises rospy.ServiceException after ``timeout`` seconds of wall time, or soon after the worker's end.
        """
        answer: futures.Future[Answer] = futures.Future()
        self.put(lambda: answer.set_result(work()))
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            ended = self._ended.is_set()  # first, since the answer can be the worker's last job
            with suppress(futures.TimeoutError):
                return answer.result(min(timeout, CHECK))
            if ended:
                raise rospy.ServiceException(f"{rospy.get_name()} does not answer: its worker has ended")
        raise rospy.ServiceException(f"{rospy.get_name()} does not answer")

    def stop(self, timeout: float = 2.0) -> None:
        """Stop after the queued jobs; wait for this at most ``timeout`` seconds of wall time."""
        self._queue.put(None)
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join(timeout)

    @property
    def waiting(self) -> bool:
        """Whether the queue has a job."""
        return not self._queue.empty()

    def _run(self) -> None:
        try:
            wait: Optional[float] = self._period
            try:
                while wait is not None:
                    wait = self._once(wait)
            finally:
                self._ended.set()
        except BaseException:  # noqa: BLE001 the last resort: expected exceptions are caught elsewhere
            if not ending():  # closed topics at shutdown are not an error
                rospy.logfatal("the worker failed, the node shuts down:\n%s", traceback.format_exc())
                _failure.set()
                rospy.signal_shutdown("the worker failed")

    def _once(self, wait: float) -> Optional[float]:
        """Run jobs that arrive within ``wait`` seconds, and settle; return the next wait, None at the end."""
        try:
            jobs = [self._queue.get(timeout=max(wait, 0.0))]
        except queue.Empty:
            jobs = []
        else:
            jobs += [self._queue.get_nowait() for _ in range(self._queue.qsize())]
        for job in jobs:
            if job is None:
                return None
            job()
        waits = [settle() for settle in list(self._settlers)]
        return min((one for one in waits if one is not None), default=self._period)
