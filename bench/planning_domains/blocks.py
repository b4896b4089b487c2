"""Blocks world: a robot arm piles up blocks."""

import random
from typing import Dict, List, Sequence

from pddl import Action, task_of

from planning_domains.task import FOLDER, Arrangement, Task, require, sources_of

#: Blocks.
SIZES = {"small": (6,), "middle": (12,), "large": (20,)}


class Blocks(Arrangement):
    """The arm, and the block or table below each block."""

    def __init__(self, places: Dict[str, str]) -> None:
        super().__init__(places)
        self.held = ""

    def do_pick(self, block: str) -> None:
        """Pick up a block."""
        require(not self.held, "the arm holds a block")
        require(block in self.places and block not in self.places.values(), f"{block} is not free")
        del self.places[block]
        self.held = block

    def do_put(self, place: str) -> None:
        """Put the block down."""
        require(bool(self.held), "the arm holds nothing")
        require(
            place == "table" or (place in self.places and place not in self.places.values()), f"{place} is not free"
        )
        self.places[self.held], self.held = place, ""


def towers(blocks: Sequence[str], source: random.Random) -> Dict[str, str]:
    """Return random towers as block -> block or table below it."""
    order = source.sample(blocks, len(blocks))
    return {
        block: order[number - 1] if number and source.random() < 0.6 else "table" for number, block in enumerate(order)
    }


def make(blocks: int, seed: int = 1) -> Task:
    """Return a task of two random sets of towers."""
    source, names = random.Random(1000 * seed + blocks), [f"b{number}" for number in range(1, blocks + 1)]
    first, last = towers(names, source), towers(names, source)
    goals = [f"on({block},{place},{number})" for number, (block, place) in enumerate(sorted(last.items()), 1)]
    covered = set(first.values())
    init = ["free", *_atoms(first), *(f"clear {block}" for block in names if block not in covered)]
    problem = task_of(FOLDER / "blocks.pddl", {"block": names}, init, _atoms(last), _actions_of)
    sources = sources_of("blocks", (f"lies({block},{place})" for block, place in first.items()))
    return Task(sources, goals, lambda: Blocks(first), problem)


def _atoms(places: Dict[str, str]) -> List[str]:
    return [f"on-table {one}" if below == "table" else f"on {one} {below}" for one, below in places.items()]


def _actions_of(plan: Sequence[Sequence[str]]) -> List[Action]:
    what = {"pick": ("pick", 1), "pick-from-table": ("pick", 1), "put": ("put", 2)}
    return [
        ("put", "table") if name == "put-on-table" else (what[name][0], ["", *arguments][what[name][1]])
        for name, *arguments in plan
    ]
