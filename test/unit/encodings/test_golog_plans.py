"""Plans where control programs and ``#heuristic`` statements disagree."""

from pathlib import Path

import pytest
from golog_programs import ENCODINGS

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.progression.parser import parse_updates
from rosoclingo.planning.solver import PlanSolver
from rosoclingo.planning.strategies import soon

LOW_BATTERY = Path(__file__).resolve().parents[2] / "data" / "mailbot_day_low_battery.txt"
SHORTEST = 17


@pytest.fixture(scope="module")
def program():
    return ReactiveProgram.from_files(
        [ENCODINGS / name for name in ("mailbot.lp", "office.lp", "golog/mailbot_day.golog")]
    )


def after_stream(program):
    """Return a solver that has answered the updates in minimal time, and its last result."""
    solver = PlanSolver(program, plan_time=0.0)
    for update in parse_updates(LOW_BATTERY.read_text()):
        result = solver.update(update)
    return solver, result


@pytest.mark.slow
def test_golog_misleading_heuristic_lengthens_plans_only_moderately(program):
    assert after_stream(program)[1].horizon <= 2 * SHORTEST


@pytest.mark.slow
def test_golog_plan_that_is_too_long_is_shortened(program, monkeypatch):
    monkeypatch.setattr(soon, "EFFORT", 0)
    monkeypatch.setattr(soon, "FEW_STEPS", 0)  # so that the heuristic is always followed
    solver, result = after_stream(program)
    assert result.horizon > SHORTEST, "there is nothing to shorten"
    better = solver.improve()
    assert better is not None
    assert better.horizon < result.horizon
