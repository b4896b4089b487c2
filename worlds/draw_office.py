#!/usr/bin/env python3
"""Draws office.pgm: four offices in a row on one floor, the corridor, and the rooms across it."""

from pathlib import Path
from typing import Tuple

import numpy as np
from PIL import Image

RESOLUTION = 0.05  # m a cell
WIDTH, HEIGHT = 17.4, 10.4  # m
WALL = 0.15  # m
DOOR = 1.0  # m
WHITE, GREY, BLACK = 254, 205, 0
# The corridor runs along the x axis of the map's frame; the map's lower left corner is at ORIGIN.
ORIGIN = (-0.7, -5.2)

# (x, y, width, depth) in m in the map's frame; yaw 0.
ROOMS = [(0.0 + 4.0 * i, 1.15, 3.85, 3.7) for i in range(4)] + [
    (0.0, -1.0, 15.85, 2.0),  # corridor
    (0.0, -4.85, 3.85, 3.7),  # kitchen
    (4.0, -4.85, 7.85, 3.7),  # meeting room
    (12.0, -4.85, 3.85, 3.7),  # copy room
]
DOORS = [(1.4 + 4.0 * i, 1.0, DOOR, WALL) for i in range(4)] + [
    (1.4, -1.15, DOOR, WALL),
    (5.0, -1.15, DOOR, WALL),  # the meeting room has two doors: the way round a closed corridor
    (10.0, -1.15, DOOR, WALL),
    (13.4, -1.15, DOOR, WALL),
]
# The corridor's frame of a fire door between office 2 and office 3; the door itself is in office_world.yaml.
PILLARS = [(7.85, 0.75, WALL, 0.25), (7.85, -1.0, WALL, 0.25)]
FURNITURE = [
    *((2.2 + 4.0 * i, 3.6, 1.4, 0.75) for i in range(4)),  # desks
    *((2.65 + 4.0 * i, 3.2, 0.4, 0.3) for i in range(4)),  # chairs
    *((0.1 + 4.0 * i, 1.6, 0.35, 1.8) for i in range(4)),  # shelves
    (0.1, -4.75, 3.65, 0.6), (2.9, -3.2, 0.8, 0.8),  # kitchen
    (6.4, -3.8, 3.2, 1.1), (4.1, -3.9, 0.35, 1.2),  # meeting room
    *((6.7 + 0.8 * i, -2.6, 0.35, 0.3) for i in range(4)),
    (12.1, -4.7, 1.2, 0.7), (14.9, -4.6, 0.8, 2.2),  # copy room
    (15.35, -0.3, 0.45, 0.6),  # plants at the ends of the corridor
    (0.05, 0.55, 0.35, 0.35),
]  # fmt: skip


def main() -> None:
    """Write office.pgm beside this script."""
    cells = np.full((round(HEIGHT / RESOLUTION), round(WIDTH / RESOLUTION)), GREY, dtype=np.uint8)

    def fill(box: Tuple[float, float, float, float], level: int, margin: float = 0.0) -> None:
        x, y, width, depth = box
        columns = [round((v - ORIGIN[0]) / RESOLUTION) for v in (x - margin, x + width + margin)]
        rows = [round((v - ORIGIN[1]) / RESOLUTION) for v in (y - margin, y + depth + margin)]
        cells[rows[0] : rows[1], columns[0] : columns[1]] = level

    for room in ROOMS:
        fill(room, BLACK, WALL)
    for room in ROOMS:
        fill(room, WHITE)
    for door in DOORS:
        fill(door, WHITE)
    for thing in PILLARS + FURNITURE:
        fill(thing, BLACK)
    Image.fromarray(cells[::-1]).save(str(Path(__file__).with_name("office.pgm")))


if __name__ == "__main__":
    main()
