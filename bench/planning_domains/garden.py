"""Garden: the gardener of doc/tutorial.md waters plants, with the program of that page."""

import random
import re
from typing import List, Sequence, Tuple

from pddl import Action, task_of

from planning_domains.task import FOLDER, Task, World, instance, require
from rosoclingo.oclingo.program.sources import Source

#: Plants.
SIZES = {"small": (3,), "middle": (8,), "large": (16,)}

TUTORIAL = FOLDER.parents[1] / "doc" / "tutorial.md"

FULL = 2


class Garden(World):
    """The gardener and its can."""

    def __init__(self, places: Sequence[str]) -> None:
        super().__init__()
        self._places, self.place, self.can = places, "home", 0

    def do_move_base(self, place: str) -> None:
        """Drive to another place."""
        require(bool(self.open), "no plant is thirsty")
        require(place in self._places and place != self.place, f"the gardener cannot go to {place}")
        self.place = place

    def do_fill(self, can: str) -> None:
        """Fill the can at the tap."""
        require(bool(self.open), "no plant is thirsty")
        require(can == "can" and self.place == "tap", "the tap is elsewhere")
        self.can = FULL

    def do_water(self, plant: str) -> None:
        """Water the plant here."""
        numbers = [number for number, goal in self.open.items() if goal[1] == plant]
        require(bool(numbers) and self.place == plant, f"{plant} is not thirsty, or elsewhere")
        require(self.can > 0, "the can is empty")
        self.can -= 1
        for number in numbers:
            del self.open[number]

    def fail(self, action: Action) -> None:
        """Let an action fail: the program aborts the goal for the plant, or all goals if there is no water."""
        interface, parameter = action
        given_up = [number for number, goal in self.open.items() if interface == "fill" or goal[1] == parameter]
        for number in given_up:
            del self.open[number]

    def can_fail(self, action: Action) -> bool:
        """Return whether ``action`` is not a drive; the program does not repeat a drive that failed."""
        return action[0] != "move_base"


def tutorial_program() -> str:
    """Return the gardener's program, the first block of ASP on the page."""
    found = re.search(r"```prolog\n(.*?)^```$", TUTORIAL.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)
    if found is None:
        raise ValueError(f"{TUTORIAL} has no Prolog block")
    return found.group(1)


def make(plants: int, seed: int = 1) -> Task:
    """Return a task of thirsty plants, in random order."""
    names = ["fern", "palm", "cactus", *(f"plant{number}" for number in range(4, plants + 1))][:plants]
    places: Tuple[str, ...] = ("home", "tap", *names)
    thirsty: List[str] = random.Random(1000 * seed + plants).sample(names, plants)
    problem = task_of(
        FOLDER / "garden.pddl",
        {"place": places, "level": [f"l{level}" for level in range(FULL + 1)]},
        [
            "at home",
            "tap tap",
            "can l0",
            f"full l{FULL}",
            *(f"less l{level} l{level + 1}" for level in range(FULL)),
            *(f"thirsty {plant}" for plant in names),
        ],
        [f"watered {plant}" for plant in thirsty],
        _actions_of,
    )
    sources = [Source("garden.lp", tutorial_program()), instance(f"plant({plant})" for plant in names)]
    return Task(sources, [f"water({plant})" for plant in thirsty], lambda: Garden(places), problem)


def _actions_of(plan: Sequence[Sequence[str]]) -> List[Action]:
    return [("fill", "can") if name == "fill" else (name, places[name == "move_base"]) for name, *places in plan]
