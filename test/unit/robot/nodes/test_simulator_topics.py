"""The names of robots' topics and frames in the simulator, equal to those of stage_ros."""

import pytest

from rosoclingo.common.parameters import ParameterError
from rosoclingo.robot.nodes.stage.robot_topics import prefixes


@pytest.mark.parametrize("name", ["my robot", "/anna"])
def test_simulator_topics_refuse_an_invalid_name(name):
    assert prefixes([name, "bert"], False) == ("robot_0/", "robot_1/")
    assert (prefixes([name], False), prefixes(["anna"], True)) == (("",), ("anna/",))
    with pytest.raises(ParameterError, match="use_model_names"):
        prefixes(["bert", name], True)
