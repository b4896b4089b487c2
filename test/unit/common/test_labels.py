"""Labels: reading a table, lookup, the nearest one."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.labels import Label, LabelError, LabelTable, UnknownLabelError
from rosoclingo.common.reading import Reader

TABLE = LabelTable.from_mapping({"office1": {"x": 1, "y": 2.5, "yaw": 0.5}, "bedroom": [10.5, 11.2], 7: [0, 0, 1]})


def test_labels_are_read_from_mappings_and_lists():
    assert TABLE["office1"] == Label("office1", 1.0, 2.5, 0.5, "map")
    assert TABLE["bedroom"] == Label("bedroom", 10.5, 11.2)
    assert LabelTable.from_mapping({"a": {"x": 1, "y": 2}, "b": [1, 2]})["a"].yaw == 0.0
    assert TABLE[7].yaw == 1.0
    assert LabelTable.from_mapping({"room( 1, 2 )": [0, 0]})["room(1,2)"].x == 0.0, "as clingo prints it"
    assert "bedroom" in TABLE
    assert "cellar" not in TABLE
    assert len(TABLE) == 3


def test_labels_have_frame_of_table_or_their_own():
    table = LabelTable.read(Reader({"a": [1, 2], "b": {"x": 1, "y": 2, "frame": "//robot/odom"}}), "/map")
    assert [label.frame for label in table] == ["map", "robot/odom"], "without a leading slash"


def test_labels_can_have_titles_for_people():
    table = LabelTable.from_mapping({"a": {"x": 1, "y": 2, "title": "Anna's <room>"}, "b": [1, 2]})
    assert [label.title for label in table] == ["Anna's <room>", ""]
    with pytest.raises(LabelError, match=r"labels.a.title: must be a name for people, not 7"):
        LabelTable.from_mapping({"a": {"x": 1, "y": 2, "title": 7}})


@pytest.mark.parametrize(
    ("data", "fault"),
    [
        ([1, 2], "must be a mapping of names"),
        ({"a": 3}, r"labels.a: must be {x, y, yaw} or \[x, y, yaw\], not 3"),
        ({"a": [1, 2, 3, 4]}, r"labels.a: must be \[x, y\] or \[x, y, yaw\] in finite numbers, not \[1, 2, 3, 4\]"),
        ({"a": {"x": 1}}, "labels.a.y: is missing: give a finite number"),
        ({"a": {"x": 1, "y": 2, "yav": 3}}, r"labels.a: unknown key 'yav' \(did you mean yaw\?\)"),
        ({"a": [math.nan, 2]}, "labels.a: must be .* in finite numbers, not .nan"),
        ({"a": {"x": 1, "y": 2, "frame": ""}}, "labels.a.frame: must be the name of a tf frame"),
        ({"Office 1": [1, 2]}, "labels.Office 1: the name is not an ASP term: write it in lower case without"),
    ],
)
def test_labels_faults_name_their_place(data, fault):
    with pytest.raises(LabelError, match=fault):
        LabelTable.from_mapping(data)


def test_labels_error_lists_the_known_labels():
    with pytest.raises(UnknownLabelError, match=r"no label cellar; known labels: office1, bedroom, 7"):
        TABLE["cellar"]
    with pytest.raises(UnknownLabelError, match="no label cellar; known labels: none"):
        LabelTable()["cellar"]


def test_labels_nearest_one_is_within_tolerance():
    assert TABLE.nearest(10.0, 11.0, 1.0).name == "bedroom"
    assert TABLE.nearest(10.0, 11.0, 0.1) is None
    assert TABLE.nearest(4.0, 6.5, 5.0).name == "office1", "the tolerance itself is near enough"
    assert LabelTable().nearest(0.0, 0.0, 9.0) is None


@pytest.mark.slow
@given(st.floats(-10, 10))
def test_labels_quaternion_is_unit_and_turns_by_yaw(yaw):
    x, y, z, w = Label("a", 0.0, 0.0, yaw).quaternion
    assert (x, y) == (0.0, 0.0)
    assert math.isclose(z * z + w * w, 1.0)
    assert math.isclose(math.cos(2 * math.atan2(z, w)), math.cos(yaw), abs_tol=1e-9)
