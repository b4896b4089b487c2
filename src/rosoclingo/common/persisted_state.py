"""Persisted state of a node in a private parameter, from which a successor resumes if the node is killed."""

import threading
import time
from contextlib import suppress
from typing import Any

import rosgraph
import rospy

from rosoclingo.common.worker import Worker
from rosoclingo.common.xmlrpc_api import FAULTS, api

#: Seconds of wall time between two checks of the parameter: a master that was restarted has lost it.
PERIOD = 2.0


class PersistedState:
    """Stores a value in a private parameter of this node, and deletes it when the node shuts down.

    The class has its own worker, as a master can take seconds to respond. If the master does not respond, or has lost
    the parameter, the worker retries; the log reports this once.
    """

    def __init__(self, name: str, loss: str) -> None:
        """Use the parameter ``name``; ``loss`` is the log text for the consequence if the master does not respond."""
        self._node, self._loss = rospy.get_name(), loss
        self._parameter = rospy.resolve_name(name)
        self._master = api(rosgraph.get_master_uri())
        self._value: Any = None
        self._saved: Any = None  # the value that the master has
        self._check_at, self._failing = 0.0, False
        self._worker = Worker(self._sync, PERIOD)
        self._worker.start()

    def store(self, value: Any, patience: float = 0.0) -> None:
        """Store a value of a type of XML-RPC in place of the previous value.

        Waits until this has succeeded or failed, at most ``patience`` seconds of wall time.
        """
        self._value, done = value, threading.Event()
        self._worker.put(self._sync)
        self._worker.put(done.set)
        done.wait(patience)

    def remove(self) -> None:
        """Delete the parameter: after a regular shutdown no successor resumes."""
        self._value = None
        self._worker.put(self._delete)
        self._worker.stop(PERIOD)

    def _sync(self) -> None:
        """Set the parameter, unless the master has the value, or the node shuts down."""
        value, now = self._value, time.monotonic()
        if value is None or (value is self._saved and now < self._check_at):
            return
        self._check_at = now + PERIOD
        try:
            if value is not self._saved or self._master.getParam(self._node, self._parameter)[2] != value:
                self._master.setParam(self._node, self._parameter, value)
            self._saved, self._failing = value, False
        except FAULTS as error:
            if not self._failing:
                rospy.logerr("%s: %s: the master does not answer: %s; retrying", self._node, self._loss, error)
            self._failing = True

    def _delete(self) -> None:
        with suppress(*FAULTS):
            self._master.deleteParam(self._node, self._parameter)
