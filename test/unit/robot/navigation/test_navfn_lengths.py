"""Paths on the shipped maps have navfn's lengths, as measured with its own library (bench/navfn_lengths.py)."""

import json
from pathlib import Path

import pytest

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, PlanOutcome, Pose2D
from rosoclingo.robot.navigation.grid import load_map
from rosoclingo.robot.navigation.inflated_ways import navfn_lengths

ROOT = Path(__file__).resolve().parents[4]
LENGTHS = json.loads((ROOT / "test" / "data" / "navfn_lengths.json").read_text())
NEAR = 0.03  # fraction of navfn's length
WIDER, CORNERS = 0.04, 0.5  # the same for the planner, and its additional clearance (m) around obstacles
PLAIN, INFLATED = (0.0, 10.0), (0.55, 10.0)  # radius (m), scaling (1/m)

pytestmark = pytest.mark.slow


def measured(name, inflation):
    """A map with inflation, and pairs of poses on it, with the length of navfn's path."""
    costmap = Costmap(load_map(ROOT / "worlds" / f"{name}.yaml"), CostmapLimits(0.18, *inflation))
    ways = [one[3:] for one in LENGTHS if one[:3] == [name, *inflation]]
    assert len(ways) == 60
    at = costmap.grid.centre
    return costmap, [(Pose2D(*at(b, a), 0.0), Pose2D(*at(d, c), 0.0), length) for a, b, c, d, length in ways]


@pytest.mark.parametrize("name", ["office", "house"])
@pytest.mark.parametrize("inflation", [PLAIN, INFLATED])
def test_navfn_lengths_agree_with_places_command(name, inflation):
    costmap, found = measured(name, inflation)
    for goal, start, length in found[::4]:
        assert navfn_lengths(costmap, goal, [start]) == [pytest.approx(length, rel=NEAR)]


@pytest.mark.parametrize("name", ["office", "house"])
def test_navfn_lengths_agree_with_the_planner(name):
    costmap, found = measured(name, PLAIN)
    for start, goal, length in found[::4]:
        plan = GridPlanner().plan(costmap, start, goal, 0.0)
        assert plan.outcome is PlanOutcome.FOUND
        assert (1.0 - WIDER) * length <= plan.length <= (1.0 + WIDER) * length + CORNERS
