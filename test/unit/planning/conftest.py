"""Fixtures for tests of the planner."""

import pytest
from stream_play import compacting

from rosoclingo.planning import grounding, solver
from rosoclingo.planning.grounding import Grounding


@pytest.fixture
def compacts_at_once(monkeypatch):
    """Compact as much as possible after each search, and ground step by step."""
    monkeypatch.setattr(grounding, "PIECE", 1)
    monkeypatch.setattr(grounding, "CLOSED_PIECE", 1)
    monkeypatch.setattr(solver, "BLOCK", 1)
    with compacting(1):
        yield


@pytest.fixture
def searches(monkeypatch):
    """Record the ranges of horizons of all questions to groundings."""
    found, ask = [], Grounding.ask

    def note(this, question, stopped):
        found.append((question.first, question.last))
        return ask(this, question, stopped)

    monkeypatch.setattr(Grounding, "ask", note)
    return found
