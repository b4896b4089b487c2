"""The inbox of a node's interfaces: distributes the core's commands and announced runs."""

import functools
from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy

from rosoclingo.common.connections import is_connected, limit_silence
from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.facts import Sender
from rosoclingo.msg import InterfaceIO
from rosoclingo.reasoning.keywords import CORE
from rosoclingo.runs.topic_atoms import run_in

OUT_TOPIC = "out_rosoclingo"


class CommandInbox:
    """The subscriber shared by all interfaces of a worker; use it on the worker's thread.

    It subscribes in the worker's first job, when all interfaces are added: the core greets a subscriber only once.
    """

    def __init__(self, worker: Worker) -> None:
        self._worker = worker
        self._readers: Dict[str, Callable[[InterfaceIO, Sender], None]] = {}
        self._followers: List[Callable[[str], None]] = []
        self._announced: Dict[str, Tuple[str, Any]] = {}  # runs and headers of their connections, by the sender's name
        self._subscriber: Optional[rospy.Subscriber] = None
        worker.put(self._subscribe)

    def add(self, name: str, read: Callable[[InterfaceIO, Sender], None], begin_run: Callable[[str], None]) -> None:
        """Add an interface: call ``read`` for messages with its ``name``, ``begin_run`` for each announced run."""
        self._readers[name] = read
        self._followers.append(begin_run)

    def hears(self, sender: Sender) -> bool:
        """Return whether the core of the sender's run is still connected, and still in that run."""
        run, connection = self._announced.get(sender.node, (None, None))
        return run is not None and run == sender.run and is_connected(self._subscriber, connection)

    def _subscribe(self) -> None:
        self._subscriber = rospy.Subscriber(OUT_TOPIC, InterfaceIO, self._on_message)

    def _on_message(self, message: InterfaceIO) -> None:
        """Queue a message for the worker; rospy calls this on a thread of its own."""
        if message.interface == CORE or message.interface in self._readers:
            self._worker.put(functools.partial(self._take, message))

    def _take(self, message: InterfaceIO) -> None:
        header = message._connection_header
        node = header["callerid"]
        if message.interface == CORE:
            for run in filter(None, map(run_in, message.facts)):
                self._announced[node] = run, header
                limit_silence(self._subscriber, header)
                for follow in self._followers:
                    follow(run)
        read = self._readers.get(message.interface)
        if read is not None:
            run, connection = self._announced.get(node, (None, None))
            read(message, Sender(node, run if connection is header else None))


@functools.lru_cache(maxsize=None)
def inbox_of(worker: Worker) -> CommandInbox:
    """Return the inbox of a worker."""
    return CommandInbox(worker)
