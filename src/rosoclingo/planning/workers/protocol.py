"""The messages between a worker and its parent.

A worker sends :class:`WorkerReply`, and during a search its last grounded step at intervals. The parent sends
:class:`WorkerCommand` to an idle worker, and None, which interrupts a busy one.
"""

import copyreg
from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.planning.history import Entry, History

CONNECTION, PROGRAM = 3, 4
"""File descriptors of a new worker process: the connection, and a file with the program and the options."""

copyreg.pickle(clingo.Symbol, lambda symbol: (clingo.parse_term, (str(symbol),)))


class WorkerCommand(NamedTuple):
    """A call of a method of :class:`~rosoclingo.planning.workers.worker_main.WorkerMain` or of its solver.

    Attributes:
        name: the name of the method.
        arguments: the arguments of the call.
        entries: the entries of the history before the call.
        continues: whether the entries continue the worker's own history.

    """

    name: str
    arguments: Tuple[Any, ...]
    entries: List[Entry]
    continues: bool


class WorkerReply(NamedTuple):
    """The reply to a command.

    Attributes:
        value: the result of the method, or the error that it raised.
        entries: the entries to append to the history.
        is_last: whether the command has ended; a search that improves its plan replies with each plan.
        has_grown: whether the worker uses much more memory than after its first search, and has searched often.
        log: the history after the command; set by the parent.

    """

    value: Any = None
    entries: Sequence[Entry] = ()
    is_last: bool = True
    has_grown: bool = False
    log: Optional[History] = None
