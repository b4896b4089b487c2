"""What tests of solvers share."""

import pytest

from rosoclingo.oclingo.solving import compaction, grounding, solver


@pytest.fixture
def compacts_at_once(monkeypatch):
    """Retire whatever can be retired with every update, step by step."""
    monkeypatch.setattr(compaction, "COMPACT_AFTER", 1)
    monkeypatch.setattr(compaction, "COMPACT_ALONG", 1)
    monkeypatch.setattr(grounding, "BLOCK", 1)
    monkeypatch.setattr(solver, "BLOCK", 1)
