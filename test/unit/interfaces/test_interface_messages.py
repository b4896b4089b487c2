"""ROS messages filled from values: every kind of field, every mismatch."""

import genpy
import pytest
from actionlib.msg import TestRequestGoal as RequestGoal
from clingo import Number, String
from geometry_msgs.msg import Point, PointStamped, Polygon, Pose2D, PoseArray, PoseStamped, PoseWithCovariance
from move_base_msgs.msg import MoveBaseGoal
from sensor_msgs.msg import JointState
from std_msgs.msg import Bool, Int8, Time
from std_msgs.msg import String as StringMessage

from rosoclingo.common.labels import Label
from rosoclingo.interfaces.message_filling import FieldError, field_faults, fill
from rosoclingo.interfaces.templates import Now
from rosoclingo.interfaces.values import read_term

NOW = genpy.Time(12, 34)
BEDROOM = Label("bedroom", 10.5, 11.2, 3.141592653589793, "map")


def test_messages_label_fills_a_stamped_pose():
    goal = fill(MoveBaseGoal(), {"target_pose": BEDROOM}, NOW)
    assert goal.target_pose.header.frame_id == "map"
    assert goal.target_pose.header.stamp == NOW
    assert (goal.target_pose.pose.position.x, goal.target_pose.pose.position.y) == (10.5, 11.2)
    assert goal.target_pose.pose.orientation.z == pytest.approx(1.0)
    assert goal.target_pose.pose.orientation.w == pytest.approx(0.0)
    assert fill(PointStamped(), {"point": BEDROOM}, NOW).point == Point(10.5, 11.2, 0.0)
    assert fill(PoseStamped(), {"pose": {"orientation": BEDROOM}}, NOW).pose.orientation.z == pytest.approx(1.0)
    assert fill(Pose2D(), {"x": 1, "theta": String("0.5")}, NOW) == Pose2D(1.0, 0.0, 0.5)


def test_messages_frames_lose_their_leading_slash():
    header = {"header": {"frame_id": "/map"}}
    goal = fill(MoveBaseGoal(), {"target_pose": {**header, "pose": BEDROOM}}, NOW)
    assert goal.target_pose.header.frame_id == "map"
    assert fill(PoseArray(), {"header": {"frame_id": String("/odom")}}, NOW).header.frame_id == "odom"
    assert fill(StringMessage(), {"data": "/map"}, NOW).data == "/map"


def test_messages_scalars_times_and_arrays_are_filled():
    goal = fill(
        RequestGoal(),
        {
            "the_result": Number(7),
            "ignore_cancel": read_term("true"),
            "result_text": String("a b"),
            "delay_accept": "0.5",
        },
        NOW,
    )
    assert (goal.the_result, goal.ignore_cancel, goal.result_text) == (7, True, "a b")
    assert goal.delay_accept == genpy.Duration(0, 500000000)
    assert fill(Time(), {"data": Now()}, NOW).data == NOW
    assert fill(Time(), {"data": 3}, NOW).data == genpy.Time(3)
    joints = fill(JointState(), {"name": [read_term("left"), "right"], "position": Number(2)}, NOW)
    assert joints.name == ["left", "right"]
    assert fill(JointState(), {"name": read_term("(left,right)")}, NOW).name == joints.name
    assert joints.position == [2.0]


@pytest.mark.parametrize(
    ("message", "values", "fault"),
    [
        (
            MoveBaseGoal(),
            {"target": 1},
            r"goal.target: move_base_msgs/MoveBaseGoal has no such field; it has target_pose",
        ),
        (PoseStamped(), {"pose": "here"}, r"goal.pose: geometry_msgs/Pose cannot be filled from here"),
        (StringMessage(), {"data": BEDROOM}, r"goal.data: needs string, but has a pose"),
        (
            Polygon(),
            {"points": BEDROOM},
            r"goal.points: geometry_msgs/Point32 cannot be .*: a pose fills geometry_msgs/Pose, ",
        ),
        (Int8(), {"data": 128}, r"goal.data: needs int8, but 128 is out of its range"),
        (Int8(), {"data": read_term("cup")}, r"goal.data: needs int8, but cup is not an integer"),
        (Bool(), {"data": "maybe"}, r"goal.data: needs bool, but maybe is neither true nor false"),
        (
            PoseWithCovariance(),
            {"covariance": [1, 2]},
            r"goal.covariance: needs .*36\], but has 2 values",
        ),
    ],
)
def test_messages_mismatches_name_their_field(message, values, fault):
    with pytest.raises(FieldError, match=fault):
        fill(message, values, NOW)


def test_messages_templates_are_checked_against_the_type():
    assert field_faults(MoveBaseGoal(), {"target_pose": {"pose": {"position": "$parameter.pose"}}}) == []
    assert field_faults(Int8(), {"data": {"x": 1}}) == ["goal.data: needs int8, but has a mapping"]
    template = {"target_pose": {"pos": 1, "header": {"frame_id": 3, "seq": -1, "stamp": "$now"}}, "targets": {}}
    assert field_faults(MoveBaseGoal(), template, "arm.goal") == [
        "arm.goal.target_pose.pos: geometry_msgs/PoseStamped has no such field; it has header, pose",
        "arm.goal.target_pose.header.seq: needs uint32, but -1 is out of its range",
        "arm.goal.targets: move_base_msgs/MoveBaseGoal has no such field; it has target_pose",
    ]
