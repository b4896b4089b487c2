"""World files for Stage: the shipped one is up to date, and every number equals the simulator's own."""

import re
from pathlib import Path

import numpy as np
import pytest
from navigation_worlds import grid_of
from PIL import Image

from rosoclingo.robot.navigation import Pose2D
from rosoclingo.robot.simulation import (
    Box,
    DoorSpec,
    LaserSpec,
    ObstacleSpec,
    RobotSpec,
    WorldError,
    WorldSpec,
    load_world,
)
from rosoclingo.robot.simulation.stage_world import DARK_LIMIT, stage_world, write_stage_world

ROOT = Path(__file__).resolve().parents[4]
PAIRS = sorted(path for path in (ROOT / "worlds").glob("*_world.yaml"))
ROWS = ["......", ".##...", "....#.", "......"]


def entities(text):
    """The entities of a world file as (kind, lines between its brackets), only those on separate lines."""
    return re.findall(r"^(\w+)\n\(\n(.*?)\n\)$", text, re.MULTILINE | re.DOTALL)


def entity(text, name):
    return next(body for _, body in entities(text) if f'name "{name}"' in body)


def numbers(body, key):
    return [float(v) for v in re.search(rf"^\s*{key} \[([^]]*)\]", body, re.MULTILINE).group(1).split()]


@pytest.mark.parametrize("source", PAIRS, ids=lambda path: path.name)
def test_stage_world_files_are_up_to_date(source, tmp_path):
    target = ROOT / "worlds" / source.name.replace("_world.yaml", ".world")
    assert target.exists(), f"rosrun rosoclingo stage_world {source} -o {target}"
    bitmap = re.search(r'bitmap "(.*)"', target.read_text()).group(1)
    world = stage_world(load_world(source), source.name, bitmap, bitmap)
    assert target.read_text() == world.text
    assert (target.parent / bitmap).exists()


def test_stage_world_refuses_map_without_a_wall():
    with pytest.raises(WorldError, match=r"w\.yaml: map: no cell is occupied"):
        stage_world(WorldSpec(grid_of(["..", ".."]), (RobotSpec(),)), "w.yaml", "m.pgm", "own.pgm")


def test_stage_world_has_the_robots():
    rear = LaserSpec(2.0, 90.0, 7, pose=Pose2D(-0.1, 0.0, np.pi), min_range=0.1, noise=0.02)
    lasers = (LaserSpec(4.0, 180.0, 19, rate=5.0), rear)
    robots = (
        RobotSpec("a", Pose2D(1.0, 2.0, np.pi / 2), 0.25, lasers=lasers, max_turn=np.pi),
        RobotSpec("b", Pose2D(0.0, 0.0), footprint=((-0.3, -0.2), (0.1, -0.2), (0.1, 0.2), (-0.3, 0.2)), lasers=()),
    )
    text = stage_world(WorldSpec(grid_of(ROWS), robots), "w.yaml", "m.pgm", "own.pgm").text
    disc, box = entity(text, "a"), entity(text, "b")
    body = entity(text, "map")
    # Columns 1 to 4 and rows 1 and 2 are occupied: 0.1 .. 0.5 m and 0.1 .. 0.3 m.
    assert (numbers(body, "size")[:2], numbers(body, "pose")) == ([0.4, 0.2], [0.3, 0.2, 0.0, 0.0])
    assert numbers(disc, "pose") == [1.0, 2.0, 0.0, 90.0]
    assert numbers(disc, "size")[:2] == [0.5, 0.5]
    assert numbers(disc, "velocity_bounds")[-2:] == [-180.0, 180.0]
    corners = re.findall(r"point\[\d+\] \[ (\S+) (\S+) \]", disc)
    assert all(abs(np.hypot(float(x), float(y)) - 0.25) < 1e-6 for x, y in corners)
    height = numbers(disc, "size")[2]
    front, rear = disc.split("ranger\n")[1:]
    assert 0.0 < height + numbers(front, "pose")[2] < height, "it sees through its own body"
    assert "fov 180 samples 19" in front
    assert "range [ 0 4 ]" in front
    assert "update_interval 200" in disc
    assert ("noise" in front, "noise [ 0.0004 0 0 ]" in rear) == (False, True), "Stage expects a variance"
    assert "range [ 0.1 2 ] fov 90 samples 7" in rear
    assert numbers(rear, "pose") == [-0.1, 0.0, -0.15, 180.0]
    assert numbers(box, "size")[:2] == pytest.approx([0.4, 0.4])
    assert numbers(box, "origin")[:2] == pytest.approx([-0.1, 0.0])
    assert "ranger" not in box


def test_stage_world_has_closed_doors_and_obstacles():
    world = WorldSpec(
        grid_of(ROWS),
        (RobotSpec(),),
        (DoorSpec("north", (0.0, 0.0), (0.0, 2.0), False), DoorSpec("south", (0.0, 0.0), (1.0, 0.0), True)),
        (ObstacleSpec("crate", (3.0, 1.0), box=Box(0.4, 0.2, np.pi / 4)), ObstacleSpec('a "bin"', (1.0, 1.0), 0.5)),
    )
    text = stage_world(world, "w.yaml", "m.pgm", "own.pgm").text
    assert numbers(entity(text, "door north"), "pose") == [0.0, 1.0, 0.0, 90.0]
    assert numbers(entity(text, "door north"), "size")[0] == 2.0
    assert "south" not in text
    assert numbers(entity(text, "crate"), "pose") == [3.0, 1.0, 0.0, 45.0]
    assert numbers(entity(text, "a 'bin'"), "size")[:2] == [1.0, 1.0]


@pytest.mark.parametrize(("grey", "own"), [(0, False), (100, True)], ids=["as Stage reads it", "lighter"])
def test_stage_world_writes_image_that_stage_reads_equally(tmp_path, grey, own):
    """A map with grey walls is occupied by its threshold, but Stage could see through them."""
    pixels = np.full((20, 30), 254, dtype=np.uint8)
    pixels[5:8, 3:9] = grey
    pixels[15, 20] = 120  # dark to Stage, free by the map's threshold
    if not own:
        pixels[15, 20] = 254
    Image.fromarray(pixels).save(str(tmp_path / "m.png"))
    (tmp_path / "m.yaml").write_text(
        "{image: m.png, resolution: 0.1, origin: [0, 0, 0], negate: 0, occupied_thresh: 0.6, free_thresh: 0.55}"
    )
    (tmp_path / "w.yaml").write_text("{map: m.yaml, robots: [{pose: [1, 0.3]}]}")
    (tmp_path / "sub").mkdir()
    files = write_stage_world(str(tmp_path / "w.yaml"), str(tmp_path / "sub" / "w.world"))
    text = (tmp_path / "sub" / "w.world").read_text()
    bitmap = tmp_path / "sub" / re.search(r'bitmap "(.*)"', text).group(1)
    assert [Path(name).exists() for name in files] == [True] * (2 if own else 1)
    with Image.open(str(bitmap)) as image:
        read = np.asarray(image) <= DARK_LIMIT
    assert np.array_equal(read[::-1], load_world(tmp_path / "w.yaml").grid.occupied().astype(bool))
