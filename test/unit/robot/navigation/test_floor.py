"""The floor of a map as facts: distances, neighbours, and labels at places where the robot cannot stand."""

import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.labels import Label, LabelTable
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.robot.navigation import Costmap, CostmapLimits, load_map
from rosoclingo.robot.navigation.floor import Floor, FloorError, floor_of, floor_program
from rosoclingo.robot.navigation.grid import OccupancyGrid

ROOT = Path(__file__).resolve().parents[4]
OFFICE = (ROOT / "worlds" / "office.yaml", ROOT / "config" / "office_labels.yaml")


def table(**places):
    return LabelTable(tuple(Label(name, *place) for name, place in places.items()))


@pytest.fixture(scope="module")
def hall():
    """12 m x 6 m, open, with a wall at x = 6 m with a door of 1 m at its middle, and a closet at the right end."""
    import numpy as np

    cells = np.zeros((120, 240), dtype=np.int8)
    cells[[0, -1]] = cells[:, [0, -1]] = 100
    cells[:, 120] = 100
    cells[50:70, 120] = 0
    cells[:, 220] = 100
    return Costmap(OccupancyGrid(cells, 0.05), CostmapLimits())


def test_floor_of_shipped_office_matches_its_program():
    labels = LabelTable.from_mapping(yaml.safe_load(OFFICE[1].read_text()))
    floor = floor_of(Costmap(load_map(OFFICE[0]), CostmapLimits()), labels)
    program = ReactiveProgram.from_files([ROOT / "encodings" / "office.lp"])
    corridors = [
        one for one in ("office1,office2", "office2,office3", "office3,office4") if one in program.texts[0].text
    ]
    assert [f"{a},{b}" for a, b in floor.connections] == corridors
    assert floor.distances["office1", "office4"] == pytest.approx(12.0, rel=0.03)


def test_floor_label_on_the_way_stands_between(hall):
    floor = floor_of(hall, table(left=(2.0, 3.0), door=(6.0, 3.0), right=(9.0, 3.0)))
    assert floor.connections == (("door", "left"), ("door", "right"))
    assert floor.distances["left", "right"] == pytest.approx(7.0, rel=0.02)
    aside = floor_of(hall, table(left=(2.0, 3.0), corner=(4.5, 0.5), right=(9.0, 3.0)))
    assert ("left", "right") in aside.connections
    assert ("left", "right") not in floor_of(
        hall, table(left=(2.0, 3.0), corner=(4.5, 0.5), right=(9.0, 3.0)), 1.0
    ).connections


def test_floor_refuses_a_negative_radius():
    with pytest.raises(FloorError, match=r"robot_radius is .*must be a number of at least 0"):
        floor_program(*map(str, OFFICE), CostmapLimits(robot_radius=-0.1))


def test_floor_unreachable_label_has_no_distance(hall):
    floor = floor_of(hall, table(closet=(11.5, 3.0), left=(2.0, 3.0), right=(9.0, 3.0)))
    assert list(floor.distances) == [("left", "right")]
    assert floor.places == ("closet", "left", "right")


def test_floor_reports_all_labels_inside_obstacles(hall):
    with pytest.raises(FloorError) as caught:
        floor_of(hall, table(wall=(6.0, 1.0), off=(50.0, 3.0), left=(2.0, 3.0), narrow=(0.1, 3.0)))
    faults = str(caught.value).splitlines()
    assert [fault.split(": ")[0] for fault in faults] == ["wall", "off", "narrow"]
    assert "off the map" in faults[1]
    assert all(fault.endswith("move the label") for fault in faults)


@given(st.dictionaries(st.sampled_from("abcdef"), st.floats(0.5, 5.5), min_size=2))
def test_floor_labels_in_a_row_are_connected_singly(hall, heights):
    labels = table(**{name: (2.0, y) for name, y in heights.items()})
    floor = floor_of(hall, labels)
    order = sorted(heights, key=lambda name: heights[name])
    reached = {order[0]}
    for _ in order:
        reached |= {b for pair in floor.connections for a, b in (pair, pair[::-1]) if a in reached}
    assert reached == set(order), "nobody is cut off"


def test_floor_becomes_facts():
    floor = Floor(("a", "b", "c"), {("a", "b"): 1.26, ("b", "c"): 0.01}, (("a", "b"),))
    assert floor.facts() == (
        "place(a). place(b). place(c).\n\n"
        "% check: ok unused (for programs that drive from place to place)\nconnection(a,b).\n\n"
        "% check: ok unused (for programs that prefer short drives)\n"
        "distance(a,b,13). distance(b,a,13).\ndistance(b,c,1). distance(c,b,1).\n"
    )


@pytest.mark.slow
def test_floor_command_prints_facts(tmp_path):
    script = [sys.executable, str(ROOT / "scripts" / "places")]
    environment = {"PYTHONPATH": str(ROOT / "src"), "PATH": "/usr/bin:/bin", "NUMBA_DISABLE_JIT": "1"}
    bad = tmp_path / "labels.yaml"
    bad.write_text("office1: here\n")
    done = subprocess.run([*script, str(OFFICE[0]), str(bad)], capture_output=True, text=True, env=environment)
    assert done.returncode == 1
    assert "labels.yaml: office1" in done.stderr
    done = subprocess.run([*script, *OFFICE, "--start", "office9"], capture_output=True, text=True, env=environment)
    assert (done.returncode, "unknown label office9" in done.stderr) == (1, True)
