import base64
import io
import math

import numpy as np
import pytest

from rosoclingo.runs import map_image as module
from rosoclingo.runs.map_image import LONGEST
from rosoclingo.runs.planar_frames import Pose


def map_image(cells, resolution, origin):
    return module.map_image(cells.ravel().tolist(), cells.shape[1], resolution, Pose(*origin))


def picture(found):
    image = pytest.importorskip("PIL.Image")
    data = base64.b64decode(found["image"].partition(",")[2])
    return np.array(image.open(io.BytesIO(data)).convert("RGBA"))


def test_map_image_is_cropped_to_known_cells():
    cells = np.full((20, 30), -1, np.int8)
    cells[5:8, 10:14] = 0
    cells[5, 10:14] = [100, 65, 50, 25]
    found = map_image(cells, 0.5, (1.0, 2.0, 0.0))
    assert (found["corner"], found["width"], found["height"]) == ([6.0, 4.5], 2.0, 1.5)
    pixels = picture(found)
    assert pixels.shape == (3, 4, 4)
    assert pixels[2, :, 3].tolist() == [255, 255, 72, 0], "the first row is the lowest, 50 is unknown"
    assert (pixels[:2, :, 3] == 0).all(), "the floor is seen through"


def test_map_image_of_a_turned_map_turns_its_corner():
    cells = np.full((10, 10), -1, np.int8)
    cells[2:4, 5:6] = 0
    found = map_image(cells, 1.0, (0.0, 0.0, math.pi / 2))
    assert found["corner"] == pytest.approx([-2.0, 5.0])


@pytest.mark.slow
def test_map_image_of_large_map_keeps_thin_walls():
    cells = np.zeros((3, 3 * LONGEST + 1), np.int8)
    cells[:, 4000] = 100
    found = map_image(cells, 0.05, (0.0, 0.0, 0.0))
    pixels = picture(found)
    assert pixels.shape[1] <= LONGEST
    assert found["width"] == pytest.approx(0.05 * 4 * pixels.shape[1])
    assert pixels[0, 1000, 3] == 255
