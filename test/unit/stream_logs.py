"""Histories after serialization, streams to explain, and answers as texts."""

from rosoclingo.oclingo import parse_update
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.history import AcceptedUpdate, History


def copied(log):
    """Return the history, parsed from its text."""
    return History.parse(log.text())


def cut(solver):
    """Return the history of a solver as one checkpoint, parsed from its text."""
    return copied(History().checkpoint(solver.snapshot))


def stream_of(update, steps, *before):
    """Return a stream of updates given as text, for an explanation why there is no plan of at most ``steps`` steps."""
    log = History().with_entries(*(AcceptedUpdate(parse_update(f"{one} #endstep."), 1) for one in before))
    return Stream(log, parse_update(f"{update} #endstep."), steps)


def texts(result):
    """Return the answers of a result as sets of texts."""
    return {frozenset(map(str, answer)) for answer in result.answers}
