"""Histories after serialization, streams to explain, and answers as texts."""

import json

from rosoclingo.oclingo import parse_update
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.history import AcceptedUpdate, History, entry_from_message, entry_to_message


def text_of(log):
    """Return the entries of a history as lines of JSON."""
    return "".join(json.dumps(entry_to_message(one), separators=(",", ":")) + "\n" for one in log.entries)


def copied(log):
    """Return the history, parsed from its text."""
    return History().with_entries(*(entry_from_message(json.loads(line)) for line in text_of(log).splitlines()))


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
