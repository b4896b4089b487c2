"""Ways on the shipped maps are as long as navfn's, whose own library has measured them (bench/navfn_lengths.py)."""

import json
from pathlib import Path

import pytest

from rosoclingo.robot.navigation import Costmap, CostmapLimits, GridPlanner, PlanOutcome, Pose2D
from rosoclingo.robot.navigation.grid import load_map

ROOT = Path(__file__).resolve().parents[4]
LENGTHS = json.loads((ROOT / "test" / "data" / "navfn_lengths.json").read_text())
NEAR = 0.03  # of navfn's length


@pytest.mark.slow
@pytest.mark.once
@pytest.mark.parametrize("name", ["office", "house"])
def test_ways_are_as_long_as_those_of_navfn(name):
    costmap = Costmap(load_map(ROOT / "worlds" / f"{name}.yaml"), CostmapLimits(robot_radius=0.18))
    ways = [one[1:] for one in LENGTHS if one[0] == name]
    assert len(ways) == 60
    for column, row, last_column, last_row, length in ways[::2]:
        ends = [Pose2D(*costmap.grid.centre(*cell), 0.0) for cell in ((row, column), (last_row, last_column))]
        plan = GridPlanner().plan(costmap, *ends, 0.0)
        assert plan.outcome is PlanOutcome.FOUND
        assert plan.length == pytest.approx(length, rel=NEAR)
