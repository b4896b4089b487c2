"""World files: read completely, or refused with the file, the key and the fault."""

import numpy as np
import pytest
import yaml
from PIL import Image

from rosoclingo.robot.navigation import Pose2D
from rosoclingo.robot.simulation import (
    Box,
    DoorSpec,
    LaserSpec,
    ObstacleSpec,
    Simulation,
    WorldError,
    load_simulation,
    load_world,
)


@pytest.fixture
def world(tmp_path):
    """Write a world with changed keys and return its path."""
    Image.fromarray(np.full((40, 40), 254, dtype=np.uint8)).save(str(tmp_path / "map.pgm"))
    text = "{image: map.pgm, resolution: 0.1, origin: [0, 0, 0], negate: 0, occupied_thresh: 0.65, free_thresh: 0.19}"
    (tmp_path / "map.yaml").write_text(text)

    def write(**changes):
        data = {"map": "map.yaml", "robots": [{"pose": [1, 1, 0]}]}
        data.update(changes)
        path = tmp_path / "world.yaml"
        path.write_text(yaml.safe_dump({key: value for key, value in data.items() if value is not None}))
        return path

    return write


def test_world_file_is_read_completely(world):
    spec = load_world(
        world(
            interval=0.05,
            seed=3,
            robots=[
                {"pose": [1, 1, 0], "laser": {"range": 4, "beams": 5, "pose": [0.1, 0]}, "drift": [0.1, 0.2]},
                {"name": "b", "pose": [2, 2], "footprint": [[0.3, 0.4], [-0.3, 0], [0, -0.3]], "laser": False},
                {"name": "c", "pose": [3, 3], "radius": "1e-1", "lasers": [{"beams": 5}, {"angle": 90}]},
            ],
            doors=[{"name": "d", "from": [0, 0], "to": [1, 0], "open": False}],
            obstacles=[{"name": "o", "at": [1, 3], "radius": 0.2}, {"name": "p", "at": [3, 1], "box": [0.2, 0.3]}],
        )
    )
    assert (spec.interval, spec.seed) == (0.05, 3)
    assert spec.robots[0].name == "robot_0"
    assert spec.robots[0].lasers == (LaserSpec(range=4.0, beams=5, pose=Pose2D(0.1, 0.0)),)
    assert spec.robots[0].drift == (0.1, 0.2)
    assert spec.robots[1].lasers == ()
    assert spec.robots[1].radius == pytest.approx(0.5)
    assert spec.robots[2].lasers == (LaserSpec(beams=5), LaserSpec(angle=90.0))
    assert spec.robots[2].radius == 0.1
    assert spec.doors == (DoorSpec("d", (0.0, 0.0), (1.0, 0.0), False),)
    assert spec.obstacles == (ObstacleSpec("o", (1.0, 3.0), 0.2), ObstacleSpec("p", (3.0, 1.0), 0.0, Box(0.2, 0.3)))
    Simulation(spec).step()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"map": None}, "map: is missing"),
        ({"map": "nowhere.yaml"}, "nowhere.yaml"),
        ({"robots": []}, "needs at least one robot"),
        (
            {"robots": [{"pose": [1, 1], "radius": -1}]},
            r"robots\[0\].radius: must be a number from 0.01 to 1000, not -1",
        ),
        ({"robots": [{"pose": [1, 1], "footprint": [[0, 0], [1, 0]]}]}, "three corners"),
        ({"robots": [{"pose": [1, 1], "name": "a"}, {"pose": [2, 2], "name": "a"}]}, "robots: 'a' is used twice"),
        ({"obstacles": [{"name": "o", "at": [1, 1]}]}, r"obstacles\[0\]: an obstacle has either"),
        ({"seed": 10**400}, "seed: must be an integer of at least 0, not 1000"),
        ({"robots": [{"pose": [1, 1], "drift": [0.1, -0.1]}]}, r"robots\[0\].drift: must be two relative errors"),
        ({"robots": [{"pose": [1, 1], "footprint": [[0, 0], [1, 1], [2, 2]]}]}, r"robots\[0\].footprint:.* on a line"),
        ({"robots": [{"pose": [1, 1], "footprint": [[0, 0], [1, 1], [1e9, 2]]}]}, r"robots\[0\].footprint: a corner"),
        ({"robots": [{"pose": [1, 1], "laser": {"min_range": 9}}]}, r"robots\[0\].laser.min_range: must be less than"),
        ({"robots": [{"pose": [1, 1], "laser": {}, "lasers": []}]}, r"robots\[0\].lasers: .* not both"),
        ({"obstacles": [{"name": "o", "at": [1, 1], "box": [1, -1]}]}, r"obstacles\[0\]: the width and depth"),
        ({"seed": -1, "robots": [{"pos": [1, 1]}]}, r"(?s)unknown key 'pos' \(did you mean pose.*seed: must be"),
        ({"robots": [{"pose": [1, 9]}]}, r"robots\[0\].pose: \(1, 9\) is off the map, which covers x 0 .. 4, y 0 .. 4"),
        ({"doors": [{"name": "d", "from": [-1, 0], "to": [1, 0]}]}, r"doors\[0\].from: \(-1, 0\) is off the map"),
        ({"doors": [{"name": "d", "from": [1, 0], "to": [1, 0]}]}, r"doors\[0\]: has the length 0"),
        ({"obstacles": [{"name": "o", "at": [5, 1], "radius": 1}]}, r"obstacles\[0\].at: \(5, 1\) is off the map"),
    ],
)
def test_world_file_refusal_names_its_fault(world, changes, words):
    with pytest.raises(WorldError, match=words) as caught:
        load_world(world(**changes))
    assert "world.yaml" in str(caught.value)


def test_world_file_can_have_another_map(world, tmp_path):
    assert load_world(world(map="nowhere.yaml"), str(tmp_path / "map.yaml")).grid.shape == (40, 40)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"obstacles": [{"name": "o", "at": [1, 1.2], "radius": 0.1}]}, "'robot_0' would collide with an obstacle"),
        (
            {"doors": [{"name": "d", "from": [0, 1], "to": [2, 1], "open": False}]},
            "'robot_0' would collide with a door",
        ),
        ({"robots": [{"pose": [1, 1]}, {"pose": [1.2, 1]}]}, "'robot_0' would collide with an obstacle or a robot"),
    ],
)
def test_world_file_refuses_robot_inside_an_obstacle(world, changes, words):
    with pytest.raises(WorldError, match=f"world.yaml: robots: robot {words}.*change the pose"):
        load_simulation(str(world(**changes)))
