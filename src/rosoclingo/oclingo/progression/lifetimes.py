"""Lifetimes of the statements of an update."""

from typing import Union

from rosoclingo.oclingo.progression.updates import Assert, Section, Volatile

FOREVER, UPDATE = "forever", "update"
Lifetime = Union[str, int, Assert]
"""FOREVER, UPDATE (until the next update), the last horizon of a window, or an ``#assert`` (until the retraction)."""


def lifetime_of(section: Section, step: int) -> Lifetime:
    """Return how long a statement of ``section`` holds in an update of step ``step``."""
    if isinstance(section, Volatile):
        return step + section.window - 1 if section.window else UPDATE  # a window of 0 counts as none
    return section if isinstance(section, Assert) else FOREVER
