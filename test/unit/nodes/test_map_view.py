"""The view of a map: all that it knows is in the picture, with the text below it."""

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from nav_msgs.msg import OccupancyGrid

from rosoclingo.nodes.rviz.map_view import FRAME, LINES, bounds_of, known, text_factor, view_of, with_view
from rosoclingo.nodes.rviz.scene import LINE_HEIGHT, MOST_LINES, PLAN_TEXT_SIZE, larger, text_shape, title_shapes


def test_an_unknown_margin_is_left_out():
    cells = np.full((1600, 2000), -1, dtype=np.int8)
    cells[300:1100, 400:1600] = 0
    assert known(cells, 0.05, (-20.0, -30.0, 0.0)) == pytest.approx((0.0, -15.0, 60.0, 25.0))
    assert known(cells[:, ::-1].T, 0.05, (0.0, 0.0, 0.0)) == pytest.approx((15.0, 20.0, 55.0, 80.0))


def test_a_map_that_knows_nothing_is_shown_whole():
    assert known(np.full((10, 20), -1, dtype=np.int8), 0.5, (1.0, 2.0, 0.0)) == pytest.approx((1.0, 2.0, 11.0, 7.0))


def test_a_turned_map():
    message = OccupancyGrid(data=[0] * 8)
    message.info.resolution, message.info.height, message.info.width = 1.0, 2, 4
    message.info.origin.orientation.z = message.info.origin.orientation.w = 0.5**0.5
    assert bounds_of(message) == pytest.approx((-2.0, 0.0, 0.0, 4.0))


@given(
    st.tuples(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3), st.floats(0.5, 500.0), st.floats(0.5, 500.0)),
    st.tuples(st.integers(300, 4000), st.integers(300, 3000)),
)
def test_the_map_and_the_longest_plan_are_in_the_picture(box, size):
    x, y, wide, high = box
    bounds = (x, y, x + wide, y + high)
    view, factor = view_of(bounds, size), text_factor(bounds)
    lines = factor * (MOST_LINES + 1) * LINE_HEIGHT * PLAN_TEXT_SIZE
    assert factor * LINES >= lines
    for px, py in ((x, y - lines), (x + wide, y + high)):
        assert abs(px - view.x) * view.scale <= 0.5 * (size[0] - FRAME[0])
        assert abs(py - view.y) * view.scale <= 0.5 * (size[1] - FRAME[1])
    tight = max(wide * view.scale / (size[0] - FRAME[0]), (high + factor * LINES) * view.scale / (size[1] - FRAME[1]))
    assert tight > 0.9


def test_a_larger_text_keeps_its_upper_edge():
    text = text_shape("plan", "map", "two\nlines", (1.0, 2.0, 0.3), (0.0, 0.0, 0.0, 1.0), 0.5)
    grown = larger(text, 3.0)
    assert grown.scale == (1.5, 1.5, 1.5)
    assert grown.position[1] + 1.2 * 1.5 == pytest.approx(2.0 + 1.2 * 0.5)
    (title,) = title_shapes("big", (0.0, 0.0, 0.0), "map", 3.0)
    assert title.position[0] == -15.0


def test_the_shipped_configuration_is_kept_but_for_the_view(pytestconfig):
    config = yaml.safe_load((pytestconfig.rootpath / "config" / "mailbot.rviz").read_text())
    view = view_of((0.0, 0.0, 10.0, 10.0), (800, 600))
    changed = with_view(config, view, (800, 600))
    current = changed["Visualization Manager"]["Views"]["Current"]
    assert (current["X"], current["Y"], current["Scale"]) == view
    assert current["Class"] == "rviz/TopDownOrtho"
    assert changed["Window Geometry"]["Width"] == 800
    assert changed["Visualization Manager"]["Displays"] == config["Visualization Manager"]["Displays"]
    assert config["Visualization Manager"]["Views"]["Current"]["Scale"] != view.scale
