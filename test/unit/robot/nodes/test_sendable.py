"""Arrays in messages: written whatever the version of numpy, whose arrays lack what ROS's messages call from 2.3 on."""

import io
import warnings

import numpy as np
import pytest

from rosoclingo.robot.nodes.messages import sendable

rospy = pytest.importorskip("rospy")
from nav_msgs.msg import OccupancyGrid  # noqa: E402
from sensor_msgs.msg import LaserScan  # noqa: E402


@pytest.mark.parametrize(
    ("kind", "field", "dtype"), [(LaserScan, "ranges", np.float32), (OccupancyGrid, "data", np.int8)]
)
def test_written_and_read_without_a_method_that_is_gone(kind, field, dtype):
    values = np.array([1, 2, 3], dtype=dtype)
    message, written = kind(), io.BytesIO()
    if kind is LaserScan:
        message.intensities = sendable(np.zeros(2, dtype=dtype))
    setattr(message, field, sendable(values[::-1].copy()))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # before 2.3 numpy warns of the method
        message.serialize_numpy(written, np)
    assert list(getattr(kind().deserialize(written.getvalue()), field)) == [3, 2, 1]


def test_memory_is_shared_and_slices_are_sendable_too():
    values = np.zeros(4, dtype=np.float32)
    sent = sendable(values)
    values[2] = 5.0
    assert sent[2] == 5.0
    assert sent[::2].tostring() == np.array([0.0, 5.0], dtype=np.float32).tobytes()
