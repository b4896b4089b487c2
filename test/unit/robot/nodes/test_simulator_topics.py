"""The names that the simulator gives robots' topics and frames, as stage_ros does."""

import pytest

from rosoclingo.common.parameters import ParameterError
from rosoclingo.robot.nodes.stage.robot_topics import prefixes


def test_one_robot_needs_no_prefix():
    assert prefixes(["mailbot"], False) == ("",)


def test_several_are_counted():
    assert prefixes(["anna", "bert"], False) == ("robot_0/", "robot_1/")


def test_names_where_they_are_asked_for():
    assert prefixes(["anna"], True) == ("anna/",)
    assert prefixes(["anna", "bert"], True) == ("anna/", "bert/")


@pytest.mark.parametrize("name", ["my robot", "2nd", "/anna", "~anna", "a-b"])
def test_a_name_that_cannot_be_a_topics(name):
    assert prefixes([name, "bert"], False) == ("robot_0/", "robot_1/")
    with pytest.raises(ParameterError, match="use_model_names"):
        prefixes(["bert", name], True)
