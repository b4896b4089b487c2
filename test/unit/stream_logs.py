"""Logs of streams as another process or a record on disk would read them; and the answers of their readers."""

from rosoclingo.oclingo.solving.stream_log import Checkpoint, StreamLog


def copied(log):
    """The log, read from its text."""
    return StreamLog.parse(log.text())


def cut(solver):
    """The log of a solver as one checkpoint, read from its text."""
    return copied(StreamLog().then(Checkpoint(solver.state)))


def texts(result):
    """The answers of a result as texts."""
    return {frozenset(map(str, answer)) for answer in result.answers}
