"""The messages between a worker and its parent."""

from typing import Any, List, NamedTuple, Optional, Sequence, Tuple

from rosoclingo.planning.history import Entry, History


class WorkerCommand(NamedTuple):
    """A call of a method of :class:`~rosoclingo.planning.workers.worker_main.WorkerMain`.

    Attributes:
        name: the name of the method.
        arguments: the arguments of the call.
        entries: the entries of the history before the call, None if it needs no history.
        continues: whether the entries continue the worker's own history.

    """

    name: str
    arguments: Tuple[Any, ...] = ()
    entries: Optional[List[Entry]] = None
    continues: bool = False


class Interrupt(NamedTuple):
    """Ends the running search; a grounding is dropped at ``drop_at``, by the clock that all processes share."""

    drop_at: float


class SearchProgress(NamedTuple):
    """The last grounded ``horizon`` of the running search."""

    horizon: int


class WorkerReply(NamedTuple):
    """The reply to a command.

    Attributes:
        value: the result of the method, or the error that it raised.
        entries: the entries to append to the history.
        is_last: whether the command has ended; a search that improves its plan replies with each plan.
        log: the history after the command; set by the parent.

    """

    value: Any = None
    entries: Sequence[Entry] = ()
    is_last: bool = True
    log: Optional[History] = None
