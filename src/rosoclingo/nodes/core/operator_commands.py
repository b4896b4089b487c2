"""The services ``~pause`` and ``~stop`` of the core."""

from collections import deque
from typing import Callable, Deque

import rospy
from std_srvs.srv import SetBool, SetBoolResponse, Trigger, TriggerResponse

from rosoclingo.common.worker import Worker
from rosoclingo.reasoning.core import Core
from rosoclingo.reasoning.events import Mode

#: The reason of goals that are aborted by ``~stop``.
STOPPED = "is aborted: an operator has stopped the core"


class OperatorCommands:
    """Serves commands of an operator, which the worker executes; ``done`` is called after each one.

    A command interrupts a search, because the plan of this search must not begin actions. A service answers once the
    journal has the command.
    """

    def __init__(self, core: Core, worker: Worker, done: Callable[[], None]) -> None:
        self._core, self._worker, self._done = core, worker, done
        self._waiting: Deque[Callable[[], None]] = deque()
        self._services = [
            rospy.Service("~pause", SetBool, lambda request: self._on_pause(request.data)),
            rospy.Service("~stop", Trigger, lambda _request: self._on_stop()),
        ]

    @property
    def waiting(self) -> bool:
        """Whether a command waits for the worker."""
        return bool(self._waiting)

    def _on_pause(self, paused: bool) -> SetBoolResponse:
        self._execute(lambda: self._core.pause(paused))
        return SetBoolResponse(True, "paused: no action begins" if paused else "running")

    def _on_stop(self) -> TriggerResponse:
        self._execute(lambda: self._core.stop(STOPPED))
        after = "the core is still paused" if self._core.mode is Mode.PAUSED else "the next goal continues"
        return TriggerResponse(True, f"stopped: all goals are aborted, {after}")

    def _execute(self, command: Callable[[], None]) -> None:
        self._waiting.append(command)
        self._worker.ask(self._execute_next)

    def _execute_next(self) -> None:
        self._waiting.popleft()()
        self._done()
