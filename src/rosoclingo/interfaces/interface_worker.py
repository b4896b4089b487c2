"""The one worker thread of a node, and its queue."""

import queue
import threading
from typing import Any, Callable, List, Optional

import rospy

TICK = 0.02  # seconds of wall time between two looks at the clock while something is under way
IDLE_TICK = 1.0  # the same while nothing is


class Worker:
    """Runs what ROS callbacks post, one job after the other, on one thread; calls tickers in between.

    A ticker returns True while something is under way that needs to see time pass.
    """

    def __init__(self, tick: float = TICK) -> None:
        self._tick = tick
        self._jobs: queue.Queue[Optional[Callable[[], Any]]] = queue.Queue()
        self._tickers: List[Callable[[], bool]] = []
        self._thread = threading.Thread(target=self._run, name="worker", daemon=True)

    def start(self) -> None:
        """Start the thread; it ends with `stop`."""
        self._thread.start()

    def post(self, job: Callable[[], Any]) -> None:
        """Queue a job.  Takes no lock that a job may hold: safe in every callback."""
        self._jobs.put(job)

    def add_ticker(self, ticker: Callable[[], bool]) -> None:
        """Have `ticker` called after each job and now and then; often while one of the tickers returns True."""
        self._tickers.append(ticker)

    def stop(self, patience: float = 2.0) -> None:
        """End the thread after the jobs that are queued; wait for it at most `patience` seconds."""
        self._jobs.put(None)
        if self._thread.is_alive() and threading.current_thread() is not self._thread:
            self._thread.join(patience)

    def _run(self) -> None:
        busy = False
        while True:
            try:
                job = self._jobs.get(timeout=self._tick if busy else IDLE_TICK)
            except queue.Empty:
                pass
            else:
                if job is None:
                    return
                self._guarded(job)
            active = [self._guarded(ticker) for ticker in self._tickers]
            busy = any(active)

    def _guarded(self, job: Callable[[], Any]) -> Any:
        try:
            return job()
        except Exception as error:  # noqa: BLE001 the node's boundary: one failed job must not end the others
            rospy.logerr("internal error: %s: %s", type(error).__name__, error, exc_info=True)
            return True
