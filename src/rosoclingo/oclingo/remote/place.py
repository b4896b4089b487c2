"""Where a solver lies in a child process."""

from typing import List, Optional

from rosoclingo.oclingo.remote.child import WorkerProcess
from rosoclingo.oclingo.remote.wire import Message
from rosoclingo.oclingo.solving.stream_log import StreamLog, entry_to_message


class Place:
    """A solver's place in a child; it lives as long as it is referred to.

    Attributes:
        number: what the child knows it by.
        child: the child that has such a solver, None where none has it.
        read: the log that the child's solver has read, or will have.
        ahead: whether the child's solver may know a better plan than was told.

    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.child: Optional[WorkerProcess] = None
        self.read: Optional[StreamLog] = None
        self.ahead = False

    def unread(self, log: StreamLog) -> List[Message]:
        """Return the entries of ``log`` that the solver has not read, if it has read any log."""
        return [entry_to_message(one) for one in (log.since(self.read) if self.read is not None else None) or ()]
