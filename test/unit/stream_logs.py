"""Logs of streams as another process or a record on disk would read them; and the answers of their readers."""

from rosoclingo.planning.history import History


def copied(log):
    """The log, read from its text."""
    return History.parse(log.text())


def cut(solver):
    """The log of a solver as one checkpoint, read from its text."""
    return copied(History().checkpoint(solver.snapshot))


def texts(result):
    """The answers of a result as texts."""
    return {frozenset(map(str, answer)) for answer in result.answers}
