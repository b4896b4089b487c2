"""The one thread in which a node does its work; its ROS callbacks only put things into the queue."""

import queue
import threading
import time
import traceback
from concurrent import futures
from contextlib import suppress
from typing import Callable, List, Optional, TypeVar

import rospy

Job = Callable[[], object]
Settle = Callable[[], Optional[float]]
Answer = TypeVar("Answer")

#: Seconds of wall time between two checks for the worker's end while an answer is awaited.
CHECK = 0.5

_failure = threading.Event()  # of any worker: it is the node, thus the process, that ends


def failed() -> bool:
    """Whether a worker of this process has failed, and thus the node."""
    return _failure.is_set()


def ending() -> bool:
    """Whether the node ends: rospy closes the topics before ``rospy.is_shutdown`` says so."""
    return bool(rospy.core.is_shutdown_requested())


class Worker:
    """Runs jobs one after the other, and settles after those that waited: what goes on with time, and what follows.

    Settling happens at least every ``period`` seconds of wall time, or sooner or later where a settler returns in how
    many seconds it wants its next turn.

    An exception that reaches the worker is a fault of the program, and its state may be half changed: it is logged with
    its traceback and the node ends (run_node: with exit code 1), as a node without its worker would only seem to live.
    What a plugin, a user's subclass or a file may raise is caught where these are called.
    """

    def __init__(self, settle: Optional[Settle] = None, period: float = 0.05) -> None:
        self._queue: queue.Queue[Optional[Job]] = queue.Queue()
        self._settlers: List[Settle] = [settle] if settle is not None else []
        self._period = period
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="worker", daemon=True)

    def add(self, settle: Settle) -> None:
        """Have one more settler called."""
        self._settlers.append(settle)

    def start(self) -> None:
        """Begin with the jobs that were put so far."""
        self._thread.start()

    def put(self, job: Job) -> None:
        """Have a job done; returns at once, from any thread, and takes no lock that a job may hold."""
        self._queue.put(job)

    def ask(self, work: Callable[[], Answer], timeout: float = 30.0) -> Answer:
        """Have the worker find an answer and wait for it: what the callback of a service does.

        Raises rospy.ServiceException after ``timeout`` seconds (wall time), or soon after the worker's end.
        """
        answer: futures.Future[Answer] = futures.Future()
        self.put(lambda: answer.set_result(work()))
        end = time.monotonic() + timeout
        while time.monotonic() < end:
            ended = self._ended.is_set()  # first: an answer can be the worker's last deed
            with suppress(futures.TimeoutError):
                return answer.result(min(timeout, CHECK))
            if ended:
                raise rospy.ServiceException(f"{rospy.get_name()} does not answer: its worker has ended")
        raise rospy.ServiceException(f"{rospy.get_name()} does not answer")

    def stop(self, timeout: float = 2.0) -> None:
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
            wait: Optional[float] = self._period
            try:
                while wait is not None:
                    wait = self._once(wait)
            finally:
                self._ended.set()
        except BaseException:  # noqa: BLE001 the last resort: anything expected was caught where it belongs
            if not ending():  # else topics are closed, which is no fault
                rospy.logfatal("the worker failed, the node ends:\n%s", traceback.format_exc())
                _failure.set()
                rospy.signal_shutdown("the worker failed")

    def _once(self, wait: float) -> Optional[float]:
        """Do what comes within ``wait`` seconds, and settle; return how long to wait next, None at the end."""
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
