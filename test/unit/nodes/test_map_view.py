"""The view of a map: the picture contains all known cells, with the text below the map."""

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from nav_msgs.msg import OccupancyGrid

from rosoclingo.nodes.rviz.canvas import LINE_HEIGHT, Canvas, text_width
from rosoclingo.nodes.rviz.map_view import FRAME, bounds_of, known_bounds, text_factor, view_of, with_robots, with_view
from rosoclingo.nodes.rviz.panel import LETTERS, LINES, draw_panel
from rosoclingo.runs.planar_frames import Pose


def test_map_view_crops_an_unknown_margin():
    cells = np.full((1600, 2000), -1, dtype=np.int8)
    cells[300:1100, 400:1600] = 0
    assert known_bounds(cells, 0.05, Pose(-20.0, -30.0, 0.0)) == pytest.approx((0.0, -15.0, 60.0, 25.0))
    assert known_bounds(np.full((10, 20), -1, dtype=np.int8), 0.5, Pose(1.0, 2.0, 0.0)) == pytest.approx((1, 2, 11, 7))
    assert known_bounds(cells[:, ::-1].T, 0.05, Pose(0.0, 0.0, 0.0)) == pytest.approx((15.0, 20.0, 55.0, 80.0))


@given(
    st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(0.5, 500.0), st.floats(0.5, 500.0)),
    st.tuples(st.integers(300, 4000), st.integers(300, 3000)),
)
def test_map_view_contains_map_and_longest_text(box, size):
    x, y, wide, high = box
    bounds = (x, y, x + wide, y + high)
    view, factor = view_of(bounds, size), text_factor(bounds)
    corners = [(x, y), (x + wide, y + high)]
    canvas = Canvas(factor)
    lines = "\n".join(["m" * (LETTERS // 2)] * (LINES + 1))
    draw_panel(canvas, ((bounds[0] + bounds[2]) / 2, y, 0.0), "map", "A title that is long, " * 20, lines, lines)
    for one in canvas.markers:
        place, high = one.pose.position, one.scale.z
        half = text_width(one.text, high) / 2, (one.text.count("\n") + 1) * LINE_HEIGHT * high / 2
        corners += [(place.x + sign * half[0], place.y + sign * half[1]) for sign in (-1, 1)]
    for px, py in corners:
        assert abs(px - view.x) * view.scale <= 0.5 * (size[0] - FRAME[0]) + 1e-6
        assert abs(py - view.y) * view.scale <= 0.5 * (size[1] - FRAME[1]) + 1e-6
    assert all(py <= y + 1e-6 for _, py in corners[2:]), "words lie on the map"


def test_map_view_handles_a_turned_map():
    message = OccupancyGrid(data=[0] * 8)
    message.info.resolution, message.info.height, message.info.width = 1.0, 2, 4
    message.info.origin.orientation.z = message.info.origin.orientation.w = 0.5**0.5
    assert bounds_of(message) == pytest.approx((-2.0, 0.0, 0.0, 4.0))


def test_map_view_changes_only_view_of_shipped_configuration(pytestconfig):
    config = yaml.safe_load((pytestconfig.rootpath / "config" / "mailbot.rviz").read_text())
    view = view_of((0.0, 0.0, 10.0, 10.0), (800, 600))
    changed = with_view(config, view, (800, 600))
    current = changed["Visualization Manager"]["Views"]["Current"]
    assert (current["X"], current["Y"], current["Scale"]) == view
    assert current["Class"] == "rviz/TopDownOrtho"
    assert changed["Window Geometry"]["Width"] == 800
    assert changed["Visualization Manager"]["Displays"] == config["Visualization Manager"]["Displays"]
    assert config["Visualization Manager"]["Views"]["Current"]["Scale"] != view.scale


def test_map_view_shows_scan_and_path_of_each_robot(pytestconfig):
    config = yaml.safe_load((pytestconfig.rootpath / "config" / "mailbot.rviz").read_text())
    assert with_robots(config, []) == config
    shown = with_robots(config, ["r1", "r2"])["Visualization Manager"]["Displays"]
    topics = [one["Topic"] for one in shown if one["Name"].startswith(("Laser", "Path of"))]
    assert topics == [
        f"{robot}/{topic}" for topic in ("base_scan", "move_base/GridPlanner/plan") for robot in ("r1", "r2")
    ]
    assert len({one["Name"] for one in shown}) == len(shown)
