"""The names of robots' topics and frames in the simulator, equal to those of stage_ros."""

import pytest

from rosoclingo.common.parameters import ParameterError
from rosoclingo.robot.nodes.stage.robot_topics import prefixes


def test_simulator_topics_of_one_robot_have_no_prefix():
    assert prefixes(["mailbot"], False) == ("",)


def test_simulator_topics_of_several_robots_are_numbered():
    assert prefixes(["anna", "bert"], False) == ("robot_0/", "robot_1/")


def test_simulator_topics_use_requested_names():
    assert prefixes(["anna"], True) == ("anna/",)
    assert prefixes(["anna", "bert"], True) == ("anna/", "bert/")


@pytest.mark.parametrize("name", ["my robot", "2nd", "/anna", "~anna", "a-b"])
def test_simulator_topics_refuse_an_invalid_name(name):
    assert prefixes([name, "bert"], False) == ("robot_0/", "robot_1/")
    with pytest.raises(ParameterError, match="use_model_names"):
        prefixes(["bert", name], True)
