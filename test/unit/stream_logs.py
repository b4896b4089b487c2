"""Histories after serialization, and answers as texts."""

from rosoclingo.planning.history import History


def copied(log):
    """Return the history, parsed from its text."""
    return History.parse(log.text())


def cut(solver):
    """Return the history of a solver as one checkpoint, parsed from its text."""
    return copied(History().checkpoint(solver.snapshot))


def texts(result):
    """Return the answers of a result as sets of texts."""
    return {frozenset(map(str, answer)) for answer in result.answers}
