"""Keys: a robot with two hands fetches things from rooms behind locked doors."""

import random
from typing import Dict, List, Sequence, Set, Tuple

from pddl import Action, Pddl, task_of

from planning_domains.task import FOLDER, Task, World, require, sources_of

#: Rooms and goals.
SIZES = {"small": (6, 3), "middle": (12, 5), "large": (20, 8)}

Edge = Tuple[str, str]


class Keys(World):
    """The robot, the things in its hands, the places of things, and the closed locks."""

    def __init__(self, ways: Sequence[Edge], locks: Dict[Edge, str], lies: Dict[str, str]) -> None:
        super().__init__()
        self._near = {**dict.fromkeys(ways, ""), **locks}
        self._near.update({(b, a): key for (a, b), key in list(self._near.items())})
        self.place, self.lies, self.closed = "start", dict(lies), set(locks.values())
        self.held: Set[str] = set()

    def do_go(self, room: str) -> None:
        """Drive to a neighbouring room."""
        require((self.place, room) in self._near, f"{room} is not near {self.place}")
        require(self._near[self.place, room] not in self.closed, f"the way to {room} is locked")
        self.place = room

    def do_take(self, thing: str) -> None:
        """Take a thing that lies here."""
        require(self.lies.get(thing) == self.place, f"{thing} is not in {self.place}")
        require(len(self.held) < 2, "both hands are full")
        del self.lies[thing]
        self.held.add(thing)

    def do_put(self, thing: str) -> None:
        """Put a thing down here."""
        require(thing in self.held, f"{thing} is not held")
        self.held.remove(thing)
        self.lies[thing] = self.place
        if self.place == "start":
            self.open = {number: goal for number, goal in self.open.items() if goal[1] != thing}

    def do_unlock(self, key: str) -> None:
        """Unlock a door here with a key that is held."""
        here = any(self.place in way and lock == key for way, lock in self._near.items())
        require(key in self.held and key in self.closed and here, f"{key} opens nothing here")
        self.closed.remove(key)


def make(rooms: int, goals: int, seed: int = 1) -> Task:
    """Return a task on a random tree of rooms, half of them locked; each key lies in a room with a lower number."""
    source = random.Random(1000 * seed + 10 * rooms + goals)
    names = ["start", *(f"r{room}" for room in range(1, rooms + 1))]
    ways: List[Edge] = []
    locks: Dict[Edge, str] = {}
    lies: Dict[str, str] = {}
    for room in range(1, rooms + 1):
        way = (names[source.randrange(max(0, room - 3), room)], names[room])
        if room % 2 == 0:
            locks[way] = f"k{room}"
            lies[f"k{room}"] = names[source.randrange(0, room)]
        else:
            ways.append(way)
    for number in range(1, goals + 1):
        lies[f"t{number}"] = names[source.randrange(1, rooms + 1)]
    facts = [f"way({a},{b})" for a, b in ways] + [f"lock({a},{b},{key})" for (a, b), key in locks.items()]
    facts += [f"lies({thing},{room})" for thing, room in lies.items()]
    terms = [f"fetch(t{number},{number})" for number in range(1, goals + 1)]
    problem = _pddl(names, ways, locks, lies, goals)
    return Task(sources_of("keys", facts), terms, lambda: Keys(ways, locks, lies), problem)


def _pddl(rooms: Sequence[str], ways: Sequence[Edge], locks: Dict[Edge, str], lies: Dict[str, str], goals: int) -> Pddl:
    init = ["at start", "free left", "free right", *(f"in {thing} {room}" for thing, room in lies.items())]
    init += [f"way {a} {b}" for way in ways for a, b in (way, way[::-1])]
    for (a, b), key in locks.items():
        init += [
            f"lock {a} {b} {key}",
            f"lock {b} {a} {key}",
            f"adjacent {key} {a}",
            f"adjacent {key} {b}",
            f"closed {key}",
        ]
    objects = {"room": rooms, "thing": lies, "hand": ["left", "right"]}
    return task_of(
        FOLDER / "keys.pddl", objects, init, [f"in t{number} start" for number in range(1, goals + 1)], _actions_of
    )


def _actions_of(plan: Sequence[Sequence[str]]) -> List[Action]:
    return [("go", one[2]) if one[0].startswith("go") else (one[0], one[1]) for one in plan]
