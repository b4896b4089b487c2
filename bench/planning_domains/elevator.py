"""Elevator: a cabin for two brings people from floor to floor."""

import random
from typing import Dict, List, Sequence

from pddl import Action, task_of

from planning_domains.task import FOLDER, Task, World, require, sources_of

#: Floors and people.
SIZES = {"small": (6, 4), "middle": (10, 7), "large": (15, 12)}

ROOMS = ("left", "right")


class Elevator(World):
    """The cabin, its doors, and the people in it."""

    def __init__(self, floors: int) -> None:
        super().__init__()
        self._floors, self.floor, self.doors = floors, 1, "shut"
        self.rides: Dict[int, str] = {}

    def cancel(self, number: int) -> None:
        """Cancel a goal; a person in the cabin still has to arrive."""
        if number not in self.rides:
            super().cancel(number)

    def do_lift(self, floor: str) -> None:
        """Go one floor up or down."""
        require(self.doors == "shut", "the doors are open")
        require(abs(int(floor) - self.floor) == 1 and 1 <= int(floor) <= self._floors, f"{floor} is not next")
        self.floor = int(floor)

    def do_doors(self, how: str) -> None:
        """Open or shut the doors."""
        require(how in ("open", "shut") and how != self.doors, f"the doors are {how}")
        self.doors = how

    def do_board(self, number: str) -> None:
        """Let a person in."""
        goal = self.open.get(int(number))
        require(goal is not None and int(number) not in self.rides, f"{number} does not wait")
        require(goal is not None and int(goal[1]) == self.floor and self.doors == "open", f"{number} can't board here")
        require(len(self.rides) < len(ROOMS), "the cabin is full")
        self.rides[int(number)] = goal[2] if goal else ""

    def do_leave(self, number: str) -> None:
        """Let a person out at the floor of the goal."""
        require(int(number) in self.rides and self.doors == "open", f"{number} can't leave")
        require(int(self.rides[int(number)]) == self.floor, f"{number} is not there yet")
        del self.rides[int(number)]
        del self.open[int(number)]

    @property
    def at_rest(self) -> bool:
        return not self.open and self.doors == "shut"


def make(floors: int, people: int, seed: int = 1) -> Task:
    """Return a task of people who want to go from one floor to another."""
    source = random.Random(1000 * seed + 10 * floors + people)
    rides = dict(enumerate((source.sample(range(1, floors + 1), 2) for _ in range(people)), 1))
    terms = [f"bring({start},{end},{number})" for number, (start, end) in rides.items()]
    init = ["at f1", "closed", *(f"free {room}" for room in ROOMS)]
    init += [f"next f{f} f{g}" for f in range(1, floors + 1) for g in (f - 1, f + 1) if 1 <= g <= floors]
    for number, (start, end) in rides.items():
        init += [f"waits p{number} f{start}", f"wants p{number} f{end}"]
    objects = {"floor": [f"f{one}" for one in range(1, floors + 1)], "person": [f"p{one}" for one in rides]}
    goal = ["closed", *(f"arrived p{number}" for number in rides)]
    problem = task_of(FOLDER / "elevator.pddl", {**objects, "room": ROOMS}, init, goal, _actions_of)
    return Task(sources_of("elevator", [f"floor(1..{floors})"]), terms, lambda: Elevator(floors), problem)


def _actions_of(plan: Sequence[Sequence[str]]) -> List[Action]:
    actions = []
    for name, *arguments in plan:
        if name.startswith("doors"):
            actions.append(("doors", name[len("doors-") :]))
        else:
            actions.append((name, arguments[1 if name == "lift" else 0][1:]))
    return actions
