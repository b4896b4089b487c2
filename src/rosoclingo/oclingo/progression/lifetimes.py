"""Lifetimes of the statements of an update."""

from dataclasses import dataclass
from typing import Union

import clingo

from rosoclingo.oclingo.progression.updates import Assert, Cumulative, Section, Volatile


@dataclass(frozen=True)
class Term:
    """The lifetime of asserted statements: until ``term`` is retracted."""

    term: clingo.Symbol


FOREVER, UPDATE = "forever", "update"
Lifetime = Union[str, int, Term]
"""FOREVER, UPDATE (until the next update), the last horizon at which a statement holds, or a Term."""


def lifetime_of(section: Section, step: int) -> Lifetime:
    """Return how long a statement of ``section`` holds in an update of step ``step``."""
    if isinstance(section, Cumulative):
        return FOREVER
    if isinstance(section, Assert):
        return Term(section.term)
    assert isinstance(section, Volatile)
    return step + section.window - 1 if section.window else UPDATE  # a window of 0 counts as none
