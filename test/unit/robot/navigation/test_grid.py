"""Maps: any map that map_server reads is read, all others are refused with the file and the key."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from PIL import Image

from rosoclingo.robot.navigation import MapError, OccupancyGrid, load_map

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


def test_grid_reads_trinary_mode(tmp_path):
    text = INFO.replace("resolution: 0.1", "resolution: 1e-1")  # a text for YAML, a number for map_server
    grid = load_map(write(tmp_path, [[0, 255, 205], [254, 100, 89]], text))
    assert grid.cells.tolist() == [[0, -1, 100], [100, 0, -1]]
    assert grid.cells.dtype == np.int8
    assert (grid.resolution, grid.origin_x, grid.origin_y) == (0.1, -1.0, 2.0)


COLOURS = [[[255, 255, 25], [0, 0, 0], [255, 255, 255], [89, 89, 90]]]
OPACITY = [[[0, 0, 0, 255], [205, 205, 205, 255], [255, 255, 255, 0]]]
GREYS = [[0, 205, 254]]


@pytest.mark.parametrize(
    ("pixels", "mode", "text", "cells"),
    [
        ([[0, 255]], "L", "negate: 1\n", [0, 100]),
        ([[0, 100, 101, 255]], "L", "mode: raw\n", [0, 100, -1, -1]),
        # a darkness of 0.3 is unknown, in any colour; the mean is not rounded
        (COLOURS, "RGB", "", [-1, 100, 0, -1]),
        # In trinary mode opacity is one more colour, as in map_server.
        (OPACITY, "RGBA", "", [100, 0, -1]),
        ([[[150, 150, 150, 255], [150, 150, 150, 0]]], "RGBA", "mode: scale\n", [47, -1]),
        (GREYS, "P", "", [100, -1, 0]),
    ],
)
def test_grid_reads_images_of_all_kinds(tmp_path, pixels, mode, text, cells):
    image = Image.fromarray(np.array(pixels, dtype=np.uint8))
    image = image.convert(mode, dither=0) if mode in "P1" else image
    image.save(str(tmp_path / "map.png"))
    key = text.split(":")[0]
    kept = [line for line in INFO.replace("map.pgm", "map.png").splitlines() if not key or not line.startswith(key)]
    (tmp_path / "map.yaml").write_text("\n".join([*kept, text]))
    assert load_map(tmp_path / "map.yaml").cells.tolist() == [cells]


def test_grid_reads_sixteen_bits(tmp_path):
    """Black, the usual grey of unknown cells, white; the image's lower bits do not count."""
    levels = np.array([[0, 205 * 257, 65535, 205 * 256]], dtype=np.uint16)
    (tmp_path / "map.pgm").write_bytes(b"P5 4 1 65535 " + levels.astype(">u2").tobytes())
    (tmp_path / "map.yaml").write_text(INFO)
    assert load_map(tmp_path / "map.yaml").cells.tolist() == [[100, -1, 0, -1]]


@given(st.binary(max_size=60), st.sampled_from(["pgm", "png"]), st.integers(0, 200), st.booleans())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
def test_grid_refuses_any_broken_image(tmp_path, junk, kind, place, cut):
    """With overwritten or truncated bytes the result is a map, or an error that names both files."""
    write(tmp_path, np.arange(64).reshape(8, 8), INFO.replace("map.pgm", f"map.{kind}"), f"map.{kind}")
    data = (tmp_path / f"map.{kind}").read_bytes()
    data = data[:place] + junk + (b"" if cut else data[place + len(junk) :])
    (tmp_path / f"map.{kind}").write_bytes(data)
    words = f"map.{kind} map.yaml"
    try:
        load_map(tmp_path / "map.yaml")
    except MapError as error:
        words = str(error)
    assert f"map.{kind}" in words
    assert "map.yaml" in words


def test_grid_refuses_an_image_too_large(tmp_path):
    path = write(tmp_path, [[0]])
    (tmp_path / "map.pgm").write_bytes(b"P5 100000 100000 255 ")
    with pytest.raises(MapError, match="pixels"):
        load_map(path)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (INFO.replace("resolution: 0.1", "resolution: 0"), "resolution"),
        (INFO.replace("map.pgm", "other.pgm"), "other.pgm"),
        (INFO.replace("0.65", "1.5"), "occupied_thresh"),
        (INFO.replace("[-1.0, 2.0, 0.0]", "[1.0, 2.0, 0.5]"), "rotated"),
        (INFO + "mode: fancy\n", "mode"),
        ("- a\n- b\n", "keys and values"),
        ("a: [", "cannot be read"),
        (INFO.replace("[-1.0, 2.0, 0.0]", "[1.0, 1.0e300, 0]"), "origin: x and y must be within 1e[+]07 m"),
        (INFO.replace("map.pgm", '"a\\0b"'), "image"),
    ],
)
def test_grid_refusal_names_fault_of_bad_map(tmp_path, text, words):
    with pytest.raises(MapError, match=words) as caught:
        load_map(write(tmp_path, [[0]], text))
    assert "map.yaml" in str(caught.value)


def test_grid_converts_between_cells_and_points():
    grid = OccupancyGrid(np.zeros((4, 6), dtype=np.int8), 0.5, -1.0, 1.0)
    assert grid.cell(-0.9, 1.1) == (0, 0)
    assert grid.cell(-1.1, 2.9) == (3, -1)
    assert grid.centre(0, 0) == (-0.75, 1.25)
    assert (grid.contains(1.9, 2.9), grid.contains(2.1, 2.9)) == (True, False)
    assert grid.off_map(-1.0, 3.0) == ""
    assert grid.off_map(-1.1, 3.0) == "(-1.1, 3) is off the map, which covers x -1 .. 2, y 1 .. 3"
