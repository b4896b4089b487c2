"""State that a node which is killed leaves to its successor, in a private parameter."""

import threading
from typing import Any

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import FAULTS, api

__all__ = ["KeptState"]

#: Seconds of wall time between two checks of the parameter: a master that was restarted has lost it.
PERIOD = 2.0


class KeptState:
    """Keeps a value in a private parameter of this node, and removes it at the end.

    A master may take seconds to answer, so this has a thread of its own. If the master does not answer, or has lost the
    parameter, the thread tries again; the log reports that once.
    """

    def __init__(self, name: str, loss: str) -> None:
        """Take the parameter's name, and for the log what is lost while the master does not answer."""
        self._node, self._loss = rospy.get_name(), loss
        self._parameter = rospy.resolve_name(name)
        self._master = api(rosgraph.get_master_uri())
        self._changed = threading.Condition()
        self._value: Any = None
        self._saved: Any = None  # the value that the master has
        self._ended = self._failing = False
        self._thread = threading.Thread(target=self._run, name="kept state", daemon=True)
        self._thread.start()

    def keep(self, value: Any, patience: float = 0.0) -> None:
        """Keep a value of XML-RPC's types in place of the last one.

        Waits until that is done or has failed, at most ``patience`` seconds of wall time.
        """
        with self._changed:
            self._value = value
            self._changed.notify_all()
            self._changed.wait_for(lambda: self._saved is self._value or self._failing or self._ended, patience)

    def end(self) -> None:
        """Remove the parameter: a node that ends, and was not killed, has no successor."""
        with self._changed:
            self._ended = True
            self._changed.notify_all()
        self._thread.join(PERIOD)

    def _run(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(self._is_due, PERIOD)
                value, ended = self._value, self._ended
            try:
                if ended:
                    self._master.deleteParam(self._node, self._parameter)
                elif value is not None:
                    self._save(value)
            except FAULTS as error:
                self._fail(error)
            if ended:
                return

    def _is_due(self) -> bool:
        return self._ended or (self._saved is not self._value and not self._failing)

    def _save(self, value: Any) -> None:
        if value is not self._saved or self._master.getParam(self._node, self._parameter)[2] != value:
            self._master.setParam(self._node, self._parameter, value)
        with self._changed:
            self._saved, self._failing = value, False
            self._changed.notify_all()

    def _fail(self, error: Exception) -> None:
        with self._changed:
            new, self._failing = not (self._failing or self._ended), True
            self._changed.notify_all()
        if new:
            rospy.logerr("%s: %s: the master does not answer: %s; it is tried again", self._node, self._loss, error)
