"""Checks of a message for the intended effect of an action."""

import pytest
from clingo import Function, Number, String
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from geometry_msgs.msg import PoseStamped
from std_msgs.msg import Bool, Float64MultiArray, UInt8MultiArray

from rosoclingo.common.labels import LabelTable
from rosoclingo.interfaces.templates import ActionScope
from rosoclingo.interfaces.world import holds

OFFICE = DiagnosticArray(status=[DiagnosticStatus(name="1", message="office3"), DiagnosticStatus(name="cup")])
CARRIED = {"status": {"name": "$parameter", "message": ""}}
LYING = {"status": {"name": "$parameter", "message": "/./"}}


def scope(parameter):
    return ActionScope(parameter, 1, LabelTable())


@pytest.mark.parametrize(
    ("package", "carried", "lying"),
    [
        (Number(1), False, True),
        (Function("cup"), True, False),
        (String("cup"), True, False),
        (Number(2), False, False),  # no element matches it: each condition needs one
    ],
)
def test_check_requires_one_matching_array_element(package, carried, lying):
    assert holds(OFFICE, CARRIED, scope(package)) is carried
    assert holds(OFFICE, LYING, scope(package)) is lying


def test_check_that_cannot_be_filled_is_undecided():
    assert holds(OFFICE, {"status": {"name": "$2"}}, scope(Number(1))) is None
    assert holds(OFFICE, {"status": {"name": "$parameter.frame"}}, scope(Number(1))) is None


def test_check_compares_numbers_texts_and_patterns():
    pose = PoseStamped()
    pose.header.frame_id, pose.pose.position.x = "map", 2.0
    assert holds(pose, {"header": {"frame_id": "/^m/"}, "pose": {"position": {"x": 2}}}, scope(Number(1)))
    assert not holds(pose, {"pose": {"position": {"x": 2.5}}}, scope(Number(1)))
    assert holds(Float64MultiArray(data=[0.5, 1.0]), {"data": "$parameter"}, scope(String("0.5")))
    assert holds(Float64MultiArray(data=[0.5, 1.0]), {"data": "$parameter"}, scope(Number(1)))
    assert not holds(Float64MultiArray(data=[0.5, 1.0]), {"data": "$parameter"}, scope(Function("fast")))
    assert holds(UInt8MultiArray(data=bytes([3, 7])), {"data": "$parameter"}, scope(Number(7)))
    assert holds(Bool(data=True), {"data": True}, scope(Number(1)))
    assert not holds(Bool(data=False), {"data": True}, scope(Number(1)))
