"""Where a solver lies in a child process."""

from typing import Optional

from rosoclingo.oclingo.remote.child import WorkerProcess
from rosoclingo.oclingo.solving.stream_log import StreamLog


class Place:
    """A solver's place in a child; it lives as long as it is referred to.

    Attributes:
        number: what the child knows it by.
        child: the child that has such a solver, None where none has it.
        read: the log that the child's solver has read, or will have.

    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.child: Optional[WorkerProcess] = None
        self.read: Optional[StreamLog] = None
