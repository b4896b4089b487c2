import math

import pytest

from rosoclingo.runs.planar_frames import PlanarFrames, Pose


def test_frame_is_found_through_intermediate_frames():
    frames = PlanarFrames()
    frames.place("map", "odom", Pose(1.0, 0.0, math.pi / 2))
    frames.place("/odom", "/base_footprint", Pose(2.0, 0.0, 0.0))
    frames.place("base_footprint", "base_link", Pose(0.5, 0.0, 0.25))
    assert frames.find("map", "base_link") == pytest.approx((1.0, 2.5, math.pi / 2 + 0.25))
    assert frames.find("odom", "base_footprint") == (2.0, 0.0, 0.0)


def test_frame_that_is_unconnected_or_cyclic_is_not_found():
    frames = PlanarFrames()
    assert frames.find("map", "base_link") is None
    frames.place("a", "b", Pose(0.0, 0.0, 0.0))
    frames.place("b", "a", Pose(0.0, 0.0, 0.0))
    assert frames.find("map", "a") is None
