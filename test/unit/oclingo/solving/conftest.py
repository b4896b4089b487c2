"""What tests of solvers share."""

import pytest

from rosoclingo.oclingo.solving import closed_steps, compaction, grounding, solver
from rosoclingo.oclingo.solving.grounding import Grounding


@pytest.fixture
def compacts_at_once(monkeypatch):
    """Retire whatever can be retired with every update, step by step."""
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 1)
    monkeypatch.setattr(compaction, "COMPACT_ALONG", 1)
    monkeypatch.setattr(grounding, "BLOCK", 1)
    monkeypatch.setattr(closed_steps, "CLOSED_BLOCK", 1)
    monkeypatch.setattr(solver, "BLOCK", 1)


@pytest.fixture
def searches(monkeypatch):
    """The ranges of horizons that clingo was asked for."""
    found, search = [], Grounding.search

    def note(this, models, stopped, first, last, *rest, **others):
        found.append((first, last))
        return search(this, models, stopped, first, last, *rest, **others)

    monkeypatch.setattr(Grounding, "search", note)
    return found
