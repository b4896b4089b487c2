"""Floors for bench/tours.py: maps with doors at any resolution, optionally rough."""

from typing import List, NamedTuple

import numpy as np
from navigation_worlds import room

from rosoclingo.robot.navigation import Costmap, OccupancyGrid
from rosoclingo.robot.simulation import DoorSpec


class Floor(NamedTuple):
    """A map and its doors, all of them open."""

    grid: OccupancyGrid
    doors: List[DoorSpec]


def small_floor(random, resolution: float = 0.05) -> Floor:
    """Rooms of 10 x 10 m with doors of 0.6 to 1.0 m and clutter."""
    walls, doors = [], []
    for at in (3.3, 6.6):
        start = 0.0
        for door in sorted(random.uniform(0.5, 9.0, 3)):
            walls += [(at, start, at + 0.1, door)]
            start = door + random.uniform(0.6, 1.0)
            doors.append(DoorSpec(f"door{len(doors)}", (at + 0.05, door), (at + 0.05, start)))
        walls += [(at, start, at + 0.1, 10.0)]
    for x, y in random.uniform(0.5, 9.0, (7, 2)):
        walls += [(x, y, x + random.uniform(0.1, 0.9), y + random.uniform(0.1, 0.9))]
    return Floor(room(10.0, 10.0, resolution, walls), doors)


def office(height: int, width: int, seed: int, room: int = 60) -> OccupancyGrid:
    """Return a map of rooms (6 m) with doors (1.1 m) and furniture, at 0.1 m a cell."""
    random = np.random.default_rng(seed)
    cells = np.zeros((height, width), dtype=np.int8)
    cells[:2] = cells[-2:] = 100
    cells[:, :2] = cells[:, -2:] = 100
    for a, size, other in ((0, height, width), (1, width, height)):
        turned = cells if a == 0 else cells.T
        for wall in range(room, size - room // 2, room):
            turned[wall : wall + 2] = 100
            for part in range(0, other, room):
                if random.random() < 0.9:
                    door = part + random.integers(8, room - 20)
                    turned[wall : wall + 2, door : door + 11] = 0
    for row, column in zip(random.integers(5, height - 15, 250), random.integers(5, width - 15, 250)):
        cells[row : row + random.integers(3, 9), column : column + random.integers(3, 9)] = 100
    return OccupancyGrid(cells, 0.1)


def office_floor(seed: int, resolution: float = 0.1) -> Floor:
    """Return an office of 54 x 58.7 m, with the doors found in its walls."""
    grid, doors = office(587, 540, seed), []
    for turned, cells in ((False, grid.cells), (True, grid.cells.T)):
        for wall in range(60, cells.shape[0] - 30, 60):
            for first, last in gaps(cells[wall] == 0):
                ends = [(0.1 * first, 0.1 * wall + 0.1), (0.1 * last, 0.1 * wall + 0.1)]
                doors.append(DoorSpec(f"door{len(doors)}", *(end[::-1] if turned else end for end in ends)))
    times = round(0.1 / resolution)
    return Floor(OccupancyGrid(np.kron(grid.cells, np.ones((times, times), dtype=np.int8)), 0.1 / times), doors)


def gaps(free: np.ndarray, widest: int = 15):
    """Yield the start and end (exclusive) of each run of free cells that is at most as wide as a door."""
    edges = np.flatnonzero(np.diff(np.concatenate(([False], free, [False])).astype(int)))
    for first, last in zip(edges[::2], edges[1::2]):
        if last - first <= widest:
            yield int(first), int(last)


def rough(floor: Floor, random) -> Floor:
    """Return the floor like a map made by a robot: with ragged walls, speckles and unknown patches."""
    cells = floor.grid.cells.copy()
    near = Costmap(floor.grid).clearance == 0.5  # cells; of the direct neighbours of walls
    area = floor.grid.resolution**2
    cells[near & (random.random(cells.shape) < 0.06)] = 100
    cells[(random.random(cells.shape) < 0.08 * area) & (cells == 0)] = 100
    rows, columns = np.indices(cells.shape)
    for _ in range(round(0.03 * area * cells.size)):
        row, column = random.integers(cells.shape[0]), random.integers(cells.shape[1])
        grey = np.hypot(rows - row, columns - column) * floor.grid.resolution < random.uniform(0.1, 0.5)
        cells[grey & (cells == 0)] = -1
    return Floor(OccupancyGrid(cells, floor.grid.resolution), floor.doors)
