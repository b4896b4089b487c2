"""Sliding puzzle: tiles slide to the free cell of a board."""

import random
from typing import Dict, Sequence, Set, Tuple

from pddl import task_of

from planning_domains.task import FOLDER, Arrangement, Task, require, sources_of

#: Columns, rows, and moves from the goal to the start.
SIZES = {"small": (3, 3, 20), "middle": (4, 3, 40), "large": (4, 4, 60)}


class Tiles(Arrangement):
    """The cell of each tile."""

    def __init__(self, places: Dict[str, str], targets: Dict[str, str], near: Set[Tuple[str, str]]) -> None:
        super().__init__(places, targets)
        self._near = near

    def do_slide(self, tile: str) -> None:
        """Slide a tile to the free cell."""
        free = {cell for cell, _ in self._near} - set(self.places.values())
        cell = next((cell for cell in free if (self.places.get(tile), cell) in self._near), None)
        require(cell is not None, f"{tile} is not at the free cell")
        self.places[tile] = str(cell)


def make(columns: int, rows: int, moves: int, seed: int = 1) -> Task:
    """Return a task whose start is ``moves`` random moves from its goal."""
    source = random.Random(1000 * seed + 10 * columns + rows)
    cells = [f"c{column}{row}" for row in range(rows) for column in range(columns)]
    near = {(a, b) for a in cells for b in cells if abs(int(a[1]) - int(b[1])) + abs(int(a[2]) - int(b[2])) == 1}
    last = {f"t{number}": cell for number, cell in enumerate(cells[1:], 1)}
    first = _shuffled(last, cells[0], near, moves, source)
    free = next(cell for cell in cells if cell not in first.values())
    facts = [*(f"near({a},{b})" for a, b in sorted(near)), *(f"lies({tile},{cell})" for tile, cell in first.items())]
    facts += [f"target({tile},{cell})" for tile, cell in last.items()]
    problem = task_of(
        FOLDER / "tiles.pddl",
        {"cell": cells, "tile": last},
        [
            f"free {free}",
            *(f"near {a} {b}" for a, b in sorted(near)),
            *(f"at {tile} {cell}" for tile, cell in first.items()),
        ],
        [f"at {tile} {cell}" for tile, cell in last.items()],
    )
    return Task(sources_of("tiles", facts), ["solve(1)"], lambda: Tiles(first, last, near), problem)


def _shuffled(
    last: Dict[str, str], free: str, near: Set[Tuple[str, str]], moves: int, source: random.Random
) -> Dict[str, str]:
    """Return the places of tiles after random moves; no move undoes the previous one."""
    places, before = dict(last), ""
    for _ in range(moves):
        tiles: Sequence[str] = sorted(tile for tile, cell in places.items() if (cell, free) in near and tile != before)
        before = source.choice(tiles)
        places[before], free = free, places[before]
    return places
