"""What a node that is killed leaves for its successor: a private parameter, which outlives the process."""

import threading
from typing import Any

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import FAULTS, api

__all__ = ["KeptState"]

#: Seconds of wall time after which the parameter is looked at again: a master that was restarted has lost it.
PERIOD = 2.0


class KeptState:
    """Keeps a value in a private parameter of this node, and removes it at the end.

    A thread of its own does it, as a master may take seconds to answer. What a master does not take, or has lost, is
    tried again; the log says so once.
    """

    def __init__(self, name: str, loss: str) -> None:
        """Take the parameter's name, and for the log what is lost while the master does not answer."""
        self._node, self._loss = rospy.get_name(), loss
        self._parameter = rospy.resolve_name(name)
        self._master = api(rosgraph.get_master_uri())
        self._changed = threading.Condition()
        self._value: Any = None
        self._wanted = self._written = 0  # how many values have come, and how many the master has taken
        self._ended = self._failing = False
        self._thread = threading.Thread(target=self._run, name="kept state", daemon=True)
        self._thread.start()

    def keep(self, value: Any, patience: float = 0.0) -> None:
        """Keep a value of XML-RPC's types in place of the last one.

        Waits until that is done or has failed, at most ``patience`` seconds of wall time.
        """
        with self._changed:
            self._value, self._wanted = value, self._wanted + 1
            wanted = self._wanted
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._written >= wanted or self._failing or self._ended, patience)

    def end(self) -> None:
        """Remove the parameter: a node that ends, and was not killed, has no successor."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._thread.join(PERIOD)

    def _run(self) -> None:
        while self._wait():
            try:
                self._write()
            except FAULTS as error:
                self._fail(error)
        try:
            self._master.deleteParam(self._node, self._parameter)
        except FAULTS:  # the master has ended as well
            return

    def _wait(self) -> bool:
        """Wait for something to do; tell whether to go on."""
        with self._changed:
            self._changed.wait_for(lambda: self._ended or (self._written < self._wanted and not self._failing), PERIOD)
            return not self._ended

    def _write(self) -> None:
        with self._changed:
            value, count = self._value, self._wanted
        if count == 0:
            return
        if count != self._written or not self._is_there(value):
            self._master.setParam(self._node, self._parameter, value)
        with self._changed:
            self._written, self._failing = count, False
            self._changed.notify_all()

    def _is_there(self, value: Any) -> bool:
        return bool(self._master.getParam(self._node, self._parameter)[2] == value)

    def _fail(self, error: Exception) -> None:
        with self._changed:
            new, self._failing = not self._failing, True
            self._changed.notify_all()
        if new:
            rospy.logerr("%s: %s: the master does not answer: %s; it is tried again", self._node, self._loss, error)
