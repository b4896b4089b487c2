"""Walking people of the crowd bench, who follow tours."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[3] / "bench"))
from crowd import PACE, TURN, Walker, launch_text  # noqa: E402

roslaunch = pytest.importorskip("roslaunch")
from roslaunch.config import ROSLaunchConfig  # noqa: E402
from roslaunch.xmlloader import XmlLoader  # noqa: E402


def test_crowd_walker_moves_along_its_tour():
    walker, x, y, yaw, places, walked = Walker(np.random.default_rng(1)), 0.0, 0.0, 0.0, [], 0.0
    for step in range(600):
        v, w = walker.command(0.1 * step, yaw)
        assert v in (0.0, PACE)
        assert abs(w) <= TURN
        yaw += 0.1 * w
        x, y, walked = x + 0.1 * v * math.cos(yaw), y + 0.1 * v * math.sin(yaw), walked + 0.1 * v
        places.append((x, y))
    assert walked > 10.0
    assert np.ptp(places, axis=0).min() > 1.0
    walker.command(0.0, yaw)  # simulated time started again
    assert walker._until < 10.0


@pytest.mark.parametrize(("nav", "localization"), [("rosoclingo", "rosoclingo"), ("move_base", "amcl")])
def test_crowd_reads_navigation_of_first_robot(nav, localization):
    text = launch_text(
        map_server="map_server", nav=nav, localization=localization, map="/a.yaml", navigation="", start="1.0 2.0 0.5"
    )
    if nav == "rosoclingo":
        text = text.replace('<arg name="navigation_config" value=""/>', "")
    config = ROSLaunchConfig()
    XmlLoader(resolve_anon=False).load_string(text, config, verbose=False)
    names = {(node.namespace, node.name) for node in config.nodes}
    localizer = {"rosoclingo": "fake_localization"}.get(localization, localization)
    assert names == {("/", "map_server"), ("/robot_0/", "move_base"), ("/robot_0/", localizer)}
