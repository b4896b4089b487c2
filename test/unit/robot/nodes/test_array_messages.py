"""Messages written from arrays against the same messages made point by point."""

import io
import math

import numpy as np
import pytest

rospy = pytest.importorskip("rospy")

from geometry_msgs.msg import Point32, PolygonStamped, PoseStamped  # noqa: E402
from nav_msgs.msg import Path  # noqa: E402
from nav_msgs.srv import GetPlanResponse  # noqa: E402

from rosoclingo.robot.nodes.array_messages import PlanResponse, PointsPolygon, path_message  # noqa: E402

STAMP = rospy.Time(12, 345)
POINTS = np.random.default_rng(7).uniform(-50.0, 50.0, (40, 2))


def written(message):
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def pose_by_pose(points, frame, final_yaw):
    message = Path()
    message.header.frame_id, message.header.stamp = frame, STAMP
    for i, (x, y) in enumerate(points.tolist()):
        ahead = points[i + 1] - points[i] if i + 1 < len(points) else None
        yaw = final_yaw if ahead is None else math.atan2(ahead[1], ahead[0])
        pose = PoseStamped()
        pose.header = message.header
        pose.pose.position.x, pose.pose.position.y = x, y
        pose.pose.orientation.z, pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
        message.poses.append(pose)
    return message


@pytest.mark.parametrize("count", [0, 1, 2, 40])
@pytest.mark.parametrize("frame", ["map", "robot_0/odom", "Küche", ""])
def test_a_path_is_written_as_its_poses_would_be(count, frame):
    quick, plain = path_message(POINTS[:count], frame, STAMP, 1.25), pose_by_pose(POINTS[:count], frame, 1.25)
    read = Path().deserialize(written(quick))
    assert read.header == plain.header
    assert len(read.poses) == count
    assert len(written(quick)) == len(written(plain))
    for one, other in zip(read.poses, plain.poses):
        assert one.header == other.header
        assert one.pose.position == other.pose.position
        assert (one.pose.orientation.x, one.pose.orientation.y) == (0.0, 0.0)
        assert one.pose.orientation.z == pytest.approx(other.pose.orientation.z, abs=1e-15)
        assert one.pose.orientation.w == pytest.approx(other.pose.orientation.w, abs=1e-15)


def test_an_answer_is_its_path():
    path = path_message(POINTS, "map", STAMP, 0.5)
    read = GetPlanResponse().deserialize(written(PlanResponse(path)))
    assert read.plan == Path().deserialize(written(path))
    assert len(read.plan.poses) == len(POINTS)


def test_an_empty_answer_is_that_of_an_empty_path():
    path = path_message(np.empty((0, 2)), "map", STAMP)
    assert written(PlanResponse(path)) == written(GetPlanResponse(pose_by_pose(np.empty((0, 2)), "map", 0.0)))


@pytest.mark.parametrize("count", [0, 1, 16])
def test_a_polygon_is_written_as_its_points_would_be(count):
    quick, plain = PointsPolygon(POINTS[:count], "robot_0/odom", STAMP), PolygonStamped()
    plain.header.frame_id, plain.header.stamp = "robot_0/odom", STAMP
    plain.polygon.points = [Point32(x, y, 0.0) for x, y in POINTS[:count].tolist()]
    assert written(quick) == written(plain)
