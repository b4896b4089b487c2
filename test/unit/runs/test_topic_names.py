"""The full names of a core's topics."""

import pytest

from rosoclingo.runs.topic_names import full_name


@pytest.mark.parametrize(
    ("core", "plan", "status", "outlet"),
    [
        ("rosoclingo", "rosoclingo/task_plan", "rosoclingo/status", "out_rosoclingo"),
        ("/rosoclingo", "/rosoclingo/task_plan", "/rosoclingo/status", "/out_rosoclingo"),
        ("/a/b/brain", "/a/b/brain/task_plan", "/a/b/rosoclingo/status", "/a/b/out_rosoclingo"),
        ("brain", "brain/task_plan", "rosoclingo/status", "out_rosoclingo"),
    ],
)
def test_topic_names_of_a_core(core, plan, status, outlet):
    names = [full_name(topic, core) for topic in ("~task_plan", "rosoclingo/status", "out_rosoclingo")]
    assert names == [plan, status, outlet]
    assert full_name("/tf", core) == "/tf"
