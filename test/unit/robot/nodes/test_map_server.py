"""Maps as messages, and where change_map finds them."""

from pathlib import Path

import numpy as np
import pytest

from rosoclingo.robot.navigation import MapError, OccupancyGrid
from rosoclingo.robot.nodes.map_server import local_path
from rosoclingo.robot.nodes.messages import grid_from_message, grid_message

rospy = pytest.importorskip("rospy")


def message():
    cells = np.array([[0, 100, -1], [50, 0, 0]], dtype=np.int8)
    return grid_message(OccupancyGrid(cells, 0.1, -1.0, 2.0), "map", rospy.Time(1.0))


def test_there_and_back():
    grid = grid_from_message(message())
    assert grid.cells.tolist() == [[0, 100, -1], [50, 0, 0]]
    assert (grid.resolution, grid.origin_x, grid.origin_y) == (0.1, -1.0, 2.0)


def change(path, value):
    broken = message()
    *rest, last = path.split(".")
    place = broken
    for part in rest:
        place = getattr(place, part)
    setattr(place, last, value)
    return broken


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        ("data", [0] * 5, "5 cells for 3 x 2"),
        ("data", [], "0 cells"),
        ("info.width", 0, "6 cells for 0 x 2"),
        ("info.resolution", 0.0, "resolution"),
        ("info.resolution", float("nan"), "resolution"),
        ("info.origin.position.x", float("inf"), "origin must be finite"),
        ("info.origin.orientation.z", 0.5, "turned"),
    ],
)
def test_a_broken_message_is_refused(path, value, words):
    with pytest.raises(MapError, match=words):
        grid_from_message(change(path, value))


def test_urls():
    assert local_path("/a/b.yaml") == local_path("file:///a/b.yaml") == Path("/a/b.yaml")
    assert local_path("b.yaml") == Path("b.yaml")
    for url in ("https://example.org/b.yaml", "package://", "package://no_such_package/b.yaml"):
        with pytest.raises(MapError, match=url):
            local_path(url)
