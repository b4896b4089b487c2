"""Deliveries for benches: floors, random requests, and their tasks for the mailbot's program. No solver, no ROS."""

import random
from collections import deque
from typing import Dict, FrozenSet, List, NamedTuple, Sequence, Tuple

from planning_domains import Action, Task, World
from planning_domains.task import FOLDER
from planning_domains.task import goal as goal_of

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

CAPACITY = 3
"""Number of packages that the robot can carry."""

ENCODINGS = FOLDER.parents[1] / "encodings"

Corridor = Tuple[int, int]


class Request(NamedTuple):
    """The request to bring package ``number`` from office ``start`` to office ``end``."""

    number: int
    start: int
    end: int

    @property
    def goal(self) -> str:
        """The goal term for the mailbot's program."""
        return f"goal(office{self.start},office{self.end},{self.number})"


class Floor(NamedTuple):
    """Offices 1 to ``offices`` and the corridors between them; the robot starts at office 1."""

    name: str
    offices: int
    corridors: FrozenSet[Corridor]

    def source(self, *facts: str) -> Source:
        """Return the facts of this floor, and further ones."""
        offices = [f"office(office{number})." for number in range(1, self.offices + 1)]
        corridors = [f"corridor(office{a},office{b})." for a, b in sorted(self.corridors)]
        return Source(self.name, "\n".join(["#program base.", *offices, *corridors, *facts, ""]))

    @property
    def sources(self) -> List[Source]:
        """The mailbot's program on this floor."""
        return [Source.from_file(ENCODINGS / "mailbot.lp"), self.source("start(office1).")]

    @property
    def program(self) -> ReactiveProgram:
        """The loaded program."""
        return ReactiveProgram(self.sources)

    def distances_from(self, start: int) -> Dict[int, int]:
        """Return the least number of moves to each office that can be reached."""
        found, queue = {start: 0}, deque([start])
        while queue:
            here = queue.popleft()
            for office in self.neighbours(here):
                if office not in found:
                    found[office] = found[here] + 1
                    queue.append(office)
        return found

    def neighbours(self, office: int) -> List[int]:
        """Return the offices that a corridor joins to ``office``."""
        return sorted({a + b - office for a, b in self.corridors if office in (a, b)})

    def way(self, start: int, end: int) -> List[int]:
        """Return the offices on a shortest path, without ``start``; raises KeyError if there is no path."""
        left, way = self.distances_from(end), []
        while start != end:
            start = min(self.neighbours(start), key=lambda office: left[office])
            way.append(start)
        return way


def row(offices: int) -> Floor:
    """Return a floor of offices in a row."""
    return Floor(str(offices), offices, frozenset((one, one + 1) for one in range(1, offices)))


def loops() -> Floor:
    """Return a floor of twenty offices: two loops of eight, joined by office 17, and three rooms at their sides."""
    rooms = [(5, 17), (17, 9), (3, 18), (12, 19), (19, 20), (8, 1), (16, 9)]
    ways = [(one, one + 1) for one in range(1, 16) if one != 8]
    return Floor("loops", 20, frozenset([*rooms, *ways]))


def floor_named(name: str) -> Floor:
    """Return the floor ``loops``, or a row of offices for a number; raises ValueError."""
    if name == "loops":
        return loops()
    if not name.isdecimal() or int(name) < 2:
        raise ValueError(f"a floor is a number of offices in a row (at least 2) or loops, not {name}")
    return row(int(name))


def random_requests(floor: Floor, count: int, seed: int) -> List[Request]:
    """Return random requests, each between two different offices; they are the same for the same arguments."""
    source = random.Random(1000 * seed + count)
    offices = range(1, floor.offices + 1)
    return [Request(number, *source.sample(offices, 2)) for number in range(1, count + 1)]


def task_of(floor: Floor, requests: Sequence[Request]) -> Task:
    """Return the task to meet requests on a floor."""
    goals = [
        goal_of(one.goal, [f"delivered p{one.number}"], [f"start p{one.number} office{one.start}"]) for one in requests
    ]
    init = ["at office1", "load l0", *(f"less l{load} l{load + 1}" for load in range(CAPACITY))]
    init += [f"corridor office{a} office{b}" for pair in floor.corridors for a, b in (pair, pair[::-1])]
    init += [f"end p{one.number} office{one.end}" for one in requests]
    objects = {
        "office": [f"office{office}" for office in range(1, floor.offices + 1)],
        "package": [f"p{one.number}" for one in requests],
        "level": [f"l{load}" for load in range(CAPACITY + 1)],
    }
    terms = {name: name[1:] for name in objects["package"]}
    actions = {"move_base": "move_base {1}", "pickup": "pickup {3}", "deliver": "deliver {3}"}
    return Task("deliveries", floor.sources, goals, objects, init, actions, terms)


def office_of(world: World) -> int:
    """Return the office of the robot."""
    return next(int(name[len("office") :]) for kind, name, *_ in world.state if kind == "at")


def actions_of_route(floor: Floor, office: int, visits: Sequence[Tuple[str, Request]]) -> List[Action]:
    """Return the actions of a route from ``office`` along visits: ("pickup", request) or ("deliver", request)."""
    actions = []
    for interface, request in visits:
        end = request.start if interface == "pickup" else request.end
        actions += [("move_base", f"office{one}") for one in floor.way(office, end)]
        actions.append((interface, str(request.number)))
        office = end
    return actions
