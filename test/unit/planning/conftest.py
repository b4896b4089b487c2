"""Fixtures for tests of the planner."""

import pytest

from rosoclingo.planning import grounding, solver
from rosoclingo.planning.grounding import Grounding


@pytest.fixture
def compacts_at_once(monkeypatch):
    """Compact as much as possible after each search, and ground step by step."""
    monkeypatch.setattr(solver, "LEAST_STEPS", 1)
    monkeypatch.setattr(solver, "MANY_STEPS", 1)
    monkeypatch.setattr(grounding, "PIECE", 1)
    monkeypatch.setattr(grounding, "CLOSED_PIECE", 1)
    monkeypatch.setattr(solver, "BLOCK", 1)


@pytest.fixture
def searches(monkeypatch):
    """Record the ranges of horizons of all questions to groundings."""
    found, ask = [], Grounding.ask

    def note(this, question, stopped):
        found.append((question.first, question.last))
        return ask(this, question, stopped)

    monkeypatch.setattr(Grounding, "ask", note)
    return found
