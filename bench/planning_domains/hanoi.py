"""Towers of Hanoi: an arm moves disks between three pegs."""

import random
from functools import partial
from typing import Dict, List, Sequence

from pddl import Action, task_of

from planning_domains.task import FOLDER, Arrangement, Task, require, sources_of

#: Disks.
SIZES = {"small": (4,), "middle": (5,), "large": (6,)}

PEGS = ("a", "b", "c")


class Hanoi(Arrangement):
    """The peg of each disk; smaller disks have smaller numbers."""

    def do_arm(self, parameter: str) -> None:
        """Move the top disk of a peg to another peg."""
        disk, peg = parameter[len("move(") : -1].split(",")
        require(disk in self.places and peg in PEGS and self.places[disk] != peg, f"{parameter} moves nothing")
        for other, place in self.places.items():
            require(int(other) >= int(disk) or place not in (peg, self.places[disk]), f"disk {other} is in the way")
        self.places[disk] = peg


def make(disks: int, seed: int = 1) -> Task:
    """Return a task of two random towers, whose largest disk has to move."""
    source = random.Random(1000 * seed + disks)
    first, last = ({str(disk): source.choice(PEGS) for disk in range(1, disks + 1)} for _ in range(2))
    last[str(disks)] = source.choice([peg for peg in PEGS if peg != first[str(disks)]])
    facts = [f"disk(1..{disks})", *(f"lies({disk},{peg})" for disk, peg in first.items())]
    facts += [f"target({disk},{peg})" for disk, peg in last.items()]
    smaller = [f"smaller d{one} d{other}" for one in range(1, disks + 1) for other in range(one + 1, disks + 1)]
    smaller += [f"smaller d{disk} {peg}" for disk in first for peg in PEGS]
    problem = task_of(
        FOLDER / "hanoi.pddl",
        {"object": [*PEGS, *(f"d{disk}" for disk in first)]},
        [*smaller, *_tower(first), *(f"clear {one}" for one in _tops(first))],
        _tower(last),
        partial(_actions_of, first),
    )
    return Task(sources_of("hanoi", facts), ["solve(1)"], lambda: Hanoi(first, last), problem)


def _tops(places: Dict[str, str]) -> List[str]:
    """Return the free disk of each peg, or the peg if it has no disk."""
    return [next((f"d{disk}" for disk, place in places.items() if place == peg), peg) for peg in PEGS]


def _tower(places: Dict[str, str]) -> List[str]:
    """Return the atoms for the places of the disks in PDDL."""
    below, atoms = {peg: peg for peg in PEGS}, []
    for disk, peg in reversed(list(places.items())):
        atoms.append(f"on d{disk} {below[peg]}")
        below[peg] = f"d{disk}"
    return atoms


def _actions_of(first: Dict[str, str], plan: Sequence[Sequence[str]]) -> List[Action]:
    peg_of = {**{f"d{disk}": peg for disk, peg in first.items()}, **{peg: peg for peg in PEGS}}
    actions = []
    for _, disk, _, place in plan:
        peg_of[disk] = peg_of[place]
        actions.append(("arm", f"move({disk[1:]},{peg_of[disk]})"))
    return actions
