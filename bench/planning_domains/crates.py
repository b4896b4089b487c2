"""Crates: two robots act simultaneously, and lift, carry and drop crates together."""

import random
from typing import Dict, Sequence, Set, Tuple

from planning_domains.task import RuleError, Step, Task, World, require, sources_of

#: Rooms, crates and inspections.
SIZES = {"small": (5, 1, 3), "middle": (8, 2, 5), "large": (12, 3, 8)}

ROBOTS = ("anna", "otto")


class Crates(World):
    """The robots, the crates, and the crate that they carry."""

    def __init__(self, near: Set[Tuple[str, str]], places: Dict[str, str]) -> None:
        super().__init__()
        self._near, self.at, self.places, self.carried = near, dict.fromkeys(ROBOTS, "dock"), dict(places), ""

    def do(self, step: Step) -> None:
        """Execute a step of at most one action of each robot; raises RuleError."""
        tasks = [(robot, *parameter[:-1].split("(")) for robot, parameter in step]
        require(1 <= len(tasks) == len({robot for robot, *_ in tasks}), "one action of a robot at a time")
        for robot, what, where in tasks:
            self._check(robot, what, where)
            if self.carried or what in ("lift", "drop"):
                others = {one[1:] for one in tasks if one[0] != robot}
                require(others == {(what, where)}, f"{what} takes two robots")
        for robot, what, where in tasks:
            if what == "go":
                self.at[robot] = where
            elif what == "inspect":
                self.open = {number: goal for number, goal in self.open.items() if goal[:2] != ("inspect", where)}
            elif what == "lift":
                self.carried = where
                self.places.pop(where, None)
            else:
                self.carried, self.places[where] = "", self.at[robot]
        if self.at_rest:
            self.open.clear()

    def _check(self, robot: str, what: str, where: str) -> None:
        require(robot in self.at, f"there is no robot {robot}")
        here = self.at[robot]
        if what == "go":
            require((here, where) in self._near, f"{where} is not near {here}")
        elif what == "inspect":
            wanted = any(goal[:2] == ("inspect", where) for goal in self.open.values())
            require(here == where and wanted and not self.carried, f"{robot} cannot inspect {where}")
        elif what == "lift":
            require(not self.carried and self.places.get(where) == here, f"{robot} cannot lift {where}")
        elif what == "drop":
            require(self.carried == where, f"{where} is not carried")
        else:
            raise RuleError(f"there is no action {what}")

    @property
    def at_rest(self) -> bool:
        return all(goal[0] == "bring" and self.places.get(goal[1]) == goal[2] for goal in self.open.values())


def make(rooms: int, crates: int, inspections: int, seed: int = 1) -> Task:
    """Return a task on a random tree of rooms."""
    source = random.Random(1000 * seed + 100 * rooms + 10 * crates + inspections)
    names = ["dock", *(f"r{number}" for number in range(1, rooms))]
    ways = [(names[source.randrange(max(0, number - 3), number)], names[number]) for number in range(1, rooms)]
    moves: Sequence[Sequence[str]] = [source.sample(names, 2) for _ in range(crates)]
    places = {f"c{number}": start for number, (start, _) in enumerate(moves, 1)}
    goals = [f"bring(c{number},{end},{number})" for number, (_, end) in enumerate(moves, 1)]
    goals += [f"inspect({room},{number})" for number, room in enumerate(source.sample(names, inspections), crates + 1)]
    facts = [f"way({a},{b})" for a, b in ways] + [f"lies({crate},{room})" for crate, room in places.items()]
    near = {pair for a, b in ways for pair in ((a, b), (b, a))}
    return Task(sources_of("crates", facts), goals, lambda: Crates(near, places))
