#!/usr/bin/env python3
"""Draws office.pgm, the four offices of the case study, house.pgm, a house with two loops, and fleet.pgm, corridors.

Boxes are (x, y, width, depth) in m in the map frame.
"""

from pathlib import Path
from typing import List, NamedTuple, Tuple

import numpy as np
from PIL import Image

RESOLUTION = 0.05  # m a cell
WALL = 0.15  # m
DOOR = 1.0  # m
WHITE, GREY, BLACK = 254, 205, 0

Box = Tuple[float, float, float, float]


class Floor(NamedTuple):
    """A map: the position of its lower left corner, its size, free boxes, and boxes with furniture."""

    origin: Tuple[float, float]
    size: Tuple[float, float]
    rooms: List[Box]
    doors: List[Box]
    things: List[Box]


OFFICE = Floor(
    origin=(-0.7, -5.2),  # the corridor runs along the x axis
    size=(17.4, 10.4),
    rooms=[(0.0 + 4.0 * i, 1.15, 3.85, 3.7) for i in range(4)]
    + [
        (0.0, -1.0, 15.85, 2.0),  # corridor
        (0.0, -4.85, 3.85, 3.7),  # kitchen
        (4.0, -4.85, 7.85, 3.7),  # meeting room
        (12.0, -4.85, 3.85, 3.7),  # copy room
    ],
    doors=[(1.4 + 4.0 * i, 1.0, DOOR, WALL) for i in range(4)]
    + [
        (1.4, -1.15, DOOR, WALL),
        (5.0, -1.15, DOOR, WALL),  # two doors of the meeting room, a detour around the closed corridor
        (10.0, -1.15, DOOR, WALL),
        (13.4, -1.15, DOOR, WALL),
    ],
    things=[
        # Frame of the fire door in the corridor between office 2 and office 3. office_world.yaml defines the door.
        (7.85, 0.75, WALL, 0.25), (7.85, -1.0, WALL, 0.25),
        *((2.2 + 4.0 * i, 3.6, 1.4, 0.75) for i in range(4)),  # desks
        *((2.65 + 4.0 * i, 3.2, 0.4, 0.3) for i in range(4)),  # chairs
        *((0.1 + 4.0 * i, 1.6, 0.35, 1.8) for i in range(4)),  # shelves
        (0.1, -4.75, 3.65, 0.6), (2.9, -3.2, 0.8, 0.8),  # kitchen
        (6.4, -3.8, 3.2, 1.1), (4.1, -3.9, 0.35, 1.2),  # meeting room
        *((6.7 + 0.8 * i, -2.6, 0.35, 0.3) for i in range(4)),
        (12.1, -4.7, 1.2, 0.7), (14.9, -4.6, 0.8, 2.2),  # copy room
        (15.35, -0.3, 0.45, 0.6),  # plants at the ends of the corridor
        (0.05, 0.55, 0.35, 0.35),
    ],
)  # fmt: skip

HOUSE = Floor(
    origin=(-0.5, -0.5),
    size=(14.0, 14.0),
    rooms=[
        (0.0, 0.0, 5.0, 5.0),  # kitchen
        (5.15, 0.0, 7.85, 5.0),  # living room
        (0.0, 5.15, 13.0, 1.85),  # hallway
        (0.0, 7.15, 4.0, 5.85),  # bathroom
        (4.15, 7.15, 3.85, 5.85),  # study
        (8.15, 7.15, 4.85, 5.85),  # bedroom
    ],
    doors=[
        (2.0, 5.0, DOOR, WALL),  # kitchen and hallway
        (8.5, 5.0, DOOR, WALL),  # living room and hallway
        (5.0, 2.0, WALL, DOOR),  # kitchen and living room
        (1.5, 7.0, DOOR, WALL),  # bathroom and hallway
        (5.5, 7.0, DOOR, WALL),  # study and hallway
        (10.0, 7.0, DOOR, WALL),  # bedroom and hallway
        (8.0, 9.0, WALL, DOOR),  # study and bedroom
    ],
    things=[
        (0.0, 0.0, 5.0, 0.6), (0.4, 3.2, 1.0, 1.2),  # kitchen: worktop, table
        (6.6, 0.3, 2.4, 0.9), (11.2, 3.4, 1.2, 1.2), (5.4, 4.2, 1.6, 0.5),  # living room: sofa, table, shelf
        (0.0, 10.8, 0.9, 2.0), (3.0, 11.8, 0.9, 1.0),  # bathroom: tub, basin
        (4.4, 11.9, 2.2, 0.8), (7.5, 11.0, 0.4, 1.8),  # study: desk, shelf
        (11.4, 7.4, 1.5, 2.1), (8.3, 12.3, 1.6, 0.6),  # bedroom: bed, wardrobe
        (12.6, 5.6, 0.35, 0.35),  # a plant in the hallway
    ],
)  # fmt: skip

FLEET = Floor(
    origin=(-0.7, -1.7),
    size=(23.4, 13.4),
    rooms=[
        (0.0, -1.0, 22.0, 2.0),  # south corridor
        (0.0, 9.0, 22.0, 2.0),  # north corridor
        *((x, -1.0, 2.0, 12.0) for x in (0.0, 10.0, 20.0)),  # west, middle and east corridor
    ],
    doors=[],
    things=[(x, y, 0.35, 0.35) for x in (3.3, 13.3) for y in (0.6, 9.05)],  # plants
)


def draw(floor: Floor, path: Path) -> None:
    """Write the image of a map."""
    width, depth = floor.size
    cells = np.full((round(depth / RESOLUTION), round(width / RESOLUTION)), GREY, dtype=np.uint8)

    def fill(box: Box, level: int, margin: float = 0.0) -> None:
        x, y, w, d = box
        columns = [round((v - floor.origin[0]) / RESOLUTION) for v in (x - margin, x + w + margin)]
        rows = [round((v - floor.origin[1]) / RESOLUTION) for v in (y - margin, y + d + margin)]
        cells[rows[0] : rows[1], columns[0] : columns[1]] = level

    for room in floor.rooms:
        fill(room, BLACK, WALL)
    for free in floor.rooms + floor.doors:
        fill(free, WHITE)
    for thing in floor.things:
        fill(thing, BLACK)
    Image.fromarray(cells[::-1]).save(str(path))


if __name__ == "__main__":
    here = Path(__file__).parent
    draw(OFFICE, here / "office.pgm")
    draw(HOUSE, here / "house.pgm")
    draw(FLEET, here / "fleet.pgm")
