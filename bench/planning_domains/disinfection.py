"""Disinfection: a robot with a battery disinfects rooms, urgent rooms first; some rooms are behind doors."""

import random
from typing import List, Sequence, Tuple

from pddl import Action, Pddl, task_of

from planning_domains.task import FOLDER, Task, World, require, sources_of

#: Rooms and goals.
SIZES = {"small": (10, 5), "middle": (20, 6), "large": (20, 10)}

FULL = 20

Edge = Tuple[str, str]


class Disinfection(World):
    """The robot, its battery, the doors and the rooms."""

    def __init__(self, ways: Sequence[Edge], doors: Sequence[Edge]) -> None:
        super().__init__()
        self._near = dict.fromkeys(ways, "")
        self._near.update({(a, b): f"d({a},{b})" for a, b in doors})
        self._near.update({(b, a): door for (a, b), door in list(self._near.items())})
        self.place, self.battery, self.shut = "home", FULL, {f"d({a},{b})" for a, b in doors}

    def _use(self) -> None:
        require(self.battery > 0, "the battery is empty")
        self.battery -= 1

    def do_move_base(self, room: str) -> None:
        """Drive to a neighbouring room."""
        require((self.place, room) in self._near, f"{room} is not near {self.place}")
        require(self._near[self.place, room] not in self.shut, f"the door to {room} is shut")
        self._use()
        self.place = room

    def _door(self, door: str) -> None:
        require(self.place in door[2:-1].split(","), f"{door} is not at {self.place}")

    def do_open(self, door: str) -> None:
        """Open a door here."""
        self._door(door)
        require(door in self.shut, f"{door} is open")
        self.shut.remove(door)

    def do_shut(self, door: str) -> None:
        """Shut a door here."""
        self._door(door)
        require(door not in self.shut, f"{door} is shut")
        self.shut.add(door)

    def do_disinfect(self, room: str) -> None:
        """Disinfect this room, which meets all goals for it."""
        require(room == self.place, f"the robot is not in {room}")
        urgent = {number for number, goal in self.open.items() if goal[2] == "urgent"}
        here = {number for number, goal in self.open.items() if goal[1] == room}
        require(bool(here), f"no goal asks for {room}")
        require(not urgent or bool(here & urgent), f"urgent rooms come before {room}")
        self._use()
        for number in here:
            del self.open[number]

    def do_charge(self, place: str) -> None:
        """Charge at home."""
        require(place == self.place == "home", "the charger is at home")
        self.battery = FULL

    @property
    def at_rest(self) -> bool:
        return not self.open and self.place == "home"


def make(rooms: int, goals: int, seed: int = 1) -> Task:
    """Return a task on a corridor with rooms on both sides; every third room is behind a door, some are joined."""
    source = random.Random(1000 * seed + 10 * rooms + goals)
    halls = -(-rooms // 3)
    ways: List[Edge] = [("home", "h1"), *((f"h{one}", f"h{one + 1}") for one in range(1, halls))]
    doors: List[Edge] = []
    for room in range(1, rooms + 1):
        (doors if room % 3 == 2 else ways).append((f"h{-(-room // 3)}", f"r{room}"))
        if room % 3 == 0 and room < rooms:
            doors.append((f"r{room}", f"r{room + 1}"))
    chosen = [f"r{room}" for room in source.sample(range(1, rooms + 1), goals)]
    urgent = chosen[: goals // 3]
    terms = [
        f"disinfect({room},{'urgent' if room in urgent else 'normal'},{number})"
        for number, room in enumerate(chosen, 1)
    ]
    facts = [f"way({a},{b})" for a, b in ways] + [f"door({a},{b})" for a, b in doors]
    sources, problem = sources_of("disinfection", facts), _pddl(ways, doors, chosen, urgent)
    return Task(sources, terms, lambda: Disinfection(ways, doors), problem)


def _pddl(ways: Sequence[Edge], doors: Sequence[Edge], chosen: Sequence[str], urgent: Sequence[str]) -> Pddl:
    rooms = sorted({room for way in (*ways, *doors) for room in way})
    named = [(a, b, f"door_{a}_{b}") for a, b in doors]
    init = ["at home", "charge-at home", f"battery l{FULL}", f"full l{FULL}", f"left c{len(urgent)}", "none c0"]
    init += [f"way {a} {b}" for way in ways for a, b in (way, way[::-1])]
    init += [f"less l{level} l{level + 1}" for level in range(FULL)]
    init += [f"fewer c{count} c{count + 1}" for count in range(len(urgent))]
    init += [f"{'urgent' if room in urgent else 'normal'} {room}" for room in chosen]
    for a, b, door in named:
        init += [
            f"door {a} {b} {door}",
            f"door {b} {a} {door}",
            f"adjacent {door} {a}",
            f"adjacent {door} {b}",
            f"shut {door}",
        ]
    objects = {
        "room": rooms,
        "door": [door for _, _, door in named],
        "level": [f"l{level}" for level in range(FULL + 1)],
        "count": [f"c{count}" for count in range(len(urgent) + 1)],
    }
    return task_of(
        FOLDER / "disinfection.pddl", objects, init, ["at home", *(f"clean {room}" for room in chosen)], _actions_of
    )


def _actions_of(plan: Sequence[Sequence[str]]) -> List[Action]:
    what = {"move_base": 2, "open": 2, "shut": 2, "disinfect": 1, "charge": 1}  # the index of the parameter
    actions = []
    for operator in plan:
        name = operator[0].split("-")[0]
        parameter = operator[what[name]]
        if parameter.startswith("door_"):
            parameter = "d({},{})".format(*parameter.split("_")[1:])
        actions.append((name, parameter))
    return actions
