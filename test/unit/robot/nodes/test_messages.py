"""Messages of poses, grids and arrays, with any version of numpy; from 2.3 on its arrays lack a method."""

import io
import warnings

import numpy as np
import pytest

from rosoclingo.robot.navigation import MapError, OccupancyGrid
from rosoclingo.robot.nodes.messages import grid_from_message, grid_message, sendable

rospy = pytest.importorskip("rospy")
from nav_msgs.msg import OccupancyGrid as GridMessage  # noqa: E402
from sensor_msgs.msg import LaserScan  # noqa: E402


def message():
    cells = np.array([[0, 100, -1], [50, 0, 0]], dtype=np.int8)
    return grid_message(OccupancyGrid(cells, 0.1, -1.0, 2.0), "map", rospy.Time(1.0))


def test_message_survives_a_round_trip():
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
        ("data", [0] * 5, "5 cells, not 3 x 2"),
        ("info.width", 0, "6 cells, not 0 x 2"),
        ("info.resolution", 0.0, "resolution"),
        ("info.origin.position.x", float("inf"), "origin must be finite"),
        ("info.origin.orientation.z", 0.5, "rotated"),
    ],
)
def test_message_that_is_broken_is_refused(path, value, words):
    with pytest.raises(MapError, match=words):
        grid_from_message(change(path, value))


@pytest.mark.parametrize(
    ("kind", "field", "dtype"), [(LaserScan, "ranges", np.float32), (GridMessage, "data", np.int8)]
)
def test_message_is_serialized_without_the_removed_method(kind, field, dtype):
    values = np.array([1, 2, 3], dtype=dtype)
    message, written = kind(), io.BytesIO()
    if kind is LaserScan:
        message.intensities = sendable(np.zeros(2, dtype=dtype))
    setattr(message, field, sendable(values[::-1].copy()))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # before 2.3 numpy warns of the method
        message.serialize_numpy(written, np)
    assert list(getattr(kind().deserialize(written.getvalue()), field)) == [3, 2, 1]
