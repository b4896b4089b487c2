"""Labels: reading a table, looking up, the nearest one."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.labels import Label, LabelError, LabelTable, UnknownLabelError

TABLE = LabelTable.from_mapping({"office1": {"x": 1, "y": 2.5, "yaw": 0.5}, "bedroom": [10.5, 11.2], 7: [0, 0, 1]})


def test_mappings_and_lists_are_read():
    assert TABLE["office1"] == Label("office1", 1.0, 2.5, 0.5, "map")
    assert TABLE["bedroom"] == Label("bedroom", 10.5, 11.2)
    assert LabelTable.from_mapping({"a": {"x": 1, "y": 2}, "b": [1, 2]})["a"].yaw == 0.0
    assert TABLE[7].yaw == 1.0
    assert "bedroom" in TABLE
    assert "cellar" not in TABLE
    assert len(TABLE) == 3


def test_frames_of_the_table_and_of_one_label():
    table = LabelTable.from_mapping({"a": [1, 2], "b": {"x": 1, "y": 2, "frame": "odom"}, "c": [1, 2]}, "world")
    assert [label.frame for label in table] == ["world", "odom", "world"]


def test_compound_names_are_written_as_clingo_prints_them():
    assert LabelTable.from_mapping({"room( 1, 2 )": [0, 0]})["room(1,2)"].x == 0.0


def test_unknown_label_tells_the_known_ones():
    with pytest.raises(UnknownLabelError, match=r"no label cellar; known labels: office1, bedroom, 7"):
        TABLE["cellar"]
    with pytest.raises(UnknownLabelError, match="no label cellar; known labels: none"):
        LabelTable()["cellar"]


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        ([1, 2], "must be a mapping of names"),
        ({"a": 3}, "label a: expected"),
        ({"a": [1, 2, 3, 4]}, "label a: expected"),
        ({"a": {"x": 1}}, "label a: y is missing"),
        ({"a": {"x": 1, "y": 2, "z": 3}}, "label a: unknown field z"),
        ({"a": {"x": 1, "y": 2, "u": 3, "z": 4, "b": 5}}, "label a: unknown field b, u, z"),
        ({"a": {"x": "1", "y": 2}}, "label a: x must be a finite number, not '1'"),
        ({"a": {"x": True, "y": 2}}, "label a: x must be a finite number"),
        ({"a": [math.nan, 2]}, "label a: x must be a finite number"),
        ({"a": {"x": 1, "y": 2, "frame": ""}}, "label a: frame must be"),
        ({"a": {"x": 1, "y": 2, "frame": 3}}, "label a: frame must be .*, not 3"),
        ({"Office 1": [1, 2]}, "label 'Office 1' is no ASP term"),
    ],
)
def test_faults_are_named(data, fault):
    with pytest.raises(LabelError, match=fault):
        LabelTable.from_mapping(data)


def test_all_faults_at_once():
    with pytest.raises(LabelError, match=r"label a: .*; label b: "):
        LabelTable.from_mapping({"a": 3, "b": 4})


def test_nearest_within_tolerance():
    assert TABLE.nearest(10.0, 11.0, 1.0).name == "bedroom"
    assert TABLE.nearest(10.0, 11.0, 0.1) is None
    assert TABLE.nearest(4.0, 6.5, 5.0).name == "office1", "the tolerance itself is near enough"
    assert LabelTable().nearest(0.0, 0.0, 9.0) is None


@given(st.floats(-10, 10))
def test_quaternions_are_unit_and_turn_by_yaw(yaw):
    x, y, z, w = Label("a", 0.0, 0.0, yaw).quaternion
    assert (x, y) == (0.0, 0.0)
    assert math.isclose(z * z + w * w, 1.0)
    assert math.isclose(math.cos(2 * math.atan2(z, w)), math.cos(yaw), abs_tol=1e-9)
