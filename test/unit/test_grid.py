"""Maps: what map_server reads is read, anything else is refused with the file and the key."""

import numpy as np
import pytest
from PIL import Image

from rosoclingo.navigation import MapError, OccupancyGrid, load_map

INFO = """image: map.pgm
resolution: 0.1
origin: [-1.0, 2.0, 0.0]
negate: 0
occupied_thresh: 0.65
free_thresh: 0.196
"""


def write(folder, levels, text=INFO, name="map.pgm", mode=None):
    Image.fromarray(np.array(levels, dtype=np.uint8), mode).save(str(folder / name))
    (folder / "map.yaml").write_text(text)
    return folder / "map.yaml"


def test_trinary(tmp_path):
    grid = load_map(write(tmp_path, [[0, 255, 205], [254, 100, 89]]))
    assert grid.cells.tolist() == [[0, -1, 100], [100, 0, -1]]
    assert grid.cells.dtype == np.int8
    assert (grid.resolution, grid.origin_x, grid.origin_y) == (0.1, -1.0, 2.0)


def test_negate(tmp_path):
    grid = load_map(write(tmp_path, [[0, 255]], INFO.replace("negate: 0", "negate: 1")))
    assert grid.cells.tolist() == [[0, 100]]


def test_scale(tmp_path):
    grid = load_map(write(tmp_path, [[255, 0, 150]], INFO + "mode: scale\n"))
    darkness = (255 - 150) / 255
    assert grid.cells.tolist() == [[0, 100, int(1 + 98 * (darkness - 0.196) / (0.65 - 0.196))]]


def test_raw(tmp_path):
    assert load_map(write(tmp_path, [[0, 100, 101, 255]], INFO + "mode: raw\n")).cells.tolist() == [[0, 100, -1, -1]]


def test_transparent_cells_are_unknown_in_scale_mode(tmp_path):
    pixels = np.array([[[150, 150, 150, 255], [150, 150, 150, 0]]], dtype=np.uint8)
    text = INFO.replace("map.pgm", "map.png") + "mode: scale\n"
    cells = load_map(write(tmp_path, pixels, text, "map.png", "RGBA")).cells
    assert cells[0, 0] > 0
    assert cells[0, 1] == -1


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (INFO.replace("resolution: 0.1", "resolution: 0"), "resolution"),
        (INFO.replace("resolution: 0.1", "resolution: fine"), "resolution"),
        (INFO.replace("image: map.pgm", ""), "image"),
        (INFO.replace("map.pgm", "other.pgm"), "other.pgm"),
        (INFO.replace("0.65", "1.5"), "occupied_thresh"),
        (INFO.replace("free_thresh: 0.196", ""), "free_thresh"),
        (INFO.replace("[-1.0, 2.0, 0.0]", "[1.0]"), "origin"),
        (INFO.replace("[-1.0, 2.0, 0.0]", "[1.0, 2.0, 0.5]"), "turned"),
        (INFO.replace("[-1.0, 2.0, 0.0]", "[1.0, .nan, 0]"), "y"),
        (INFO + "mode: fancy\n", "mode"),
        ("- a\n- b\n", "keys and values"),
        ("a: [", "cannot be read"),
    ],
)
def test_a_bad_map_names_its_fault(tmp_path, text, words):
    with pytest.raises(MapError, match=words) as caught:
        load_map(write(tmp_path, [[0]], text))
    assert "map.yaml" in str(caught.value)


def test_a_missing_file_and_a_broken_image(tmp_path):
    with pytest.raises(MapError, match="cannot be read"):
        load_map(tmp_path / "nowhere.yaml")
    path = write(tmp_path, [[0]])
    (tmp_path / "map.pgm").write_text("no image")
    with pytest.raises(MapError, match="image"):
        load_map(path)


def test_cells_and_points():
    grid = OccupancyGrid(np.zeros((4, 6), dtype=np.int8), 0.5, -1.0, 1.0)
    assert grid.cell(-0.9, 1.1) == (0, 0)
    assert grid.cell(-1.1, 2.9) == (3, -1)
    assert grid.centre(0, 0) == (-0.75, 1.25)
    assert grid.contains(1.9, 2.9)
    assert not grid.contains(2.1, 2.9)
