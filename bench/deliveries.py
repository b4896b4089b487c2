"""Deliveries for benches: floors, random requests, and the rules of the task in plain Python.

The rules are written from the documents, independently of the encodings. A `World` executes actions one by one and
refuses an action that breaks a rule, so it checks the plans of any planner. No solver, no ROS.
"""

import copy
import random
from collections import deque
from pathlib import Path
from typing import Dict, FrozenSet, Iterable, List, NamedTuple, Sequence, Tuple

from pddl import Action, Operator, Pddl, task_of

CAPACITY = 3
"""Number of packages that the robot can carry."""

Corridor = Tuple[int, int]


class RuleError(Exception):
    """An action breaks a rule; the message contains the action and the rule."""


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

    @property
    def instance(self) -> str:
        """The facts of the floor for the mailbot's program."""
        facts = [f"office(office{number})." for number in range(1, self.offices + 1)]
        facts += [f"corridor(office{a},office{b})." for a, b in sorted(self.corridors)]
        return "\n".join(["#program base.", "start(office1).", *facts, ""])

    def neighbours(self, office: int) -> List[int]:
        """Return the offices that a corridor joins to ``office``."""
        return sorted({a + b - office for a, b in self.corridors if office in (a, b)})

    def distances(self) -> Dict[Corridor, int]:
        """Return the least number of moves for each pair of offices; unreachable pairs are left out."""
        return {
            (start, office): moves
            for start in range(1, self.offices + 1)
            for office, moves in self._distances_from(start).items()
        }

    def way(self, start: int, end: int) -> List[int]:
        """Return the offices on a shortest path, without ``start``; raises KeyError if there is no path."""
        left, way = self._distances_from(end), []
        while start != end:
            start = min(self.neighbours(start), key=lambda office: left[office])
            way.append(start)
        return way

    def _distances_from(self, start: int) -> Dict[int, int]:
        found, queue = {start: 0}, deque([start])
        while queue:
            here = queue.popleft()
            for office in self.neighbours(here):
                if office not in found:
                    found[office] = found[here] + 1
                    queue.append(office)
        return found


def row(offices: int) -> Floor:
    """Return a floor of offices in a row."""
    return Floor(str(offices), offices, frozenset((one, one + 1) for one in range(1, offices)))


def _loop(first: int, length: int) -> List[Corridor]:
    offices = [*range(first, first + length), first]
    return list(zip(offices, offices[1:]))


def loops() -> Floor:
    """Return a floor of twenty offices: two loops of eight, joined by office 17, and three rooms at their sides."""
    rooms = [(5, 17), (17, 9), (3, 18), (12, 19), (19, 20)]
    return Floor("loops", 20, frozenset([*_loop(1, 8), *_loop(9, 8), *rooms]))


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


def pddl_of(floor: Floor, requests: Sequence[Request]) -> Pddl:
    """Return the task of requests on a floor in PDDL, for other planners."""
    numbers, offices = [one.number for one in requests], range(1, floor.offices + 1)
    init = ["at office1", "load l0", *(f"less l{load} l{load + 1}" for load in range(CAPACITY))]
    init += [f"corridor office{a} office{b}" for pair in sorted(floor.corridors) for a, b in (pair, pair[::-1])]
    for number, start, end in requests:
        init += [f"start p{number} office{start}", f"end p{number} office{end}"]
    objects = {
        "office": [f"office{office}" for office in offices],
        "package": [f"p{number}" for number in numbers],
        "level": [f"l{load}" for load in range(CAPACITY + 1)],
    }
    domain = Path(__file__).resolve().parent / "deliveries.pddl"
    return task_of(domain, objects, init, [f"delivered p{number}" for number in numbers], _actions_of)


def _actions_of(plan: Sequence[Operator]) -> List[Action]:
    return [(name, last if name == "move_base" else last[1:]) for name, *_, last in plan]


class World:
    """The floor with the robot and the packages.

    Attributes:
        office: the office of the robot.
        waiting: number -> request, for packages to be picked up.
        carried: number -> request, for packages on the robot.
        actions: the number of executed actions.

    """

    def __init__(self, floor: Floor) -> None:
        self._neighbours = {office: floor.neighbours(office) for office in range(1, floor.offices + 1)}
        self.office, self.actions = 1, 0
        self.waiting: Dict[int, Request] = {}
        self.carried: Dict[int, Request] = {}

    @property
    def open(self) -> int:
        """The number of open requests."""
        return len(self.waiting) + len(self.carried)

    def copy(self) -> "World":
        """Return a copy of this world."""
        other = copy.copy(self)
        other.waiting, other.carried = dict(self.waiting), dict(self.carried)
        return other

    def ask(self, requests: Iterable[Request]) -> None:
        """Add requests; their packages wait at the start."""
        self.waiting.update((request.number, request) for request in requests)

    def move(self, office: int) -> None:
        """Move to a neighbouring office; raises RuleError."""
        if office not in self._neighbours[self.office]:
            raise RuleError(f"no corridor leads from office {self.office} to {office}")
        self.office = office
        self.actions += 1

    def pick_up(self, number: int) -> None:
        """Pick up a package that waits here; raises RuleError."""
        request = self.waiting.get(number)
        if request is None or request.start != self.office:
            raise RuleError(f"package {number} does not wait at office {self.office}")
        if len(self.carried) >= CAPACITY:
            raise RuleError(f"the robot cannot carry package {number}: it is full")
        self.carried[number] = self.waiting.pop(number)
        self.actions += 1

    def deliver(self, number: int) -> None:
        """Put a package down at the end of its request; raises RuleError."""
        request = self.carried.get(number)
        if request is None or request.end != self.office:
            raise RuleError(f"package {number} is not on the robot, or does not belong to office {self.office}")
        del self.carried[number]
        self.actions += 1

    def do(self, interface: str, parameter: str) -> None:
        """Execute an action of the mailbot's program; raises RuleError."""
        if interface == "move_base":
            self.move(int(parameter.replace("office", "")))
        elif interface == "pickup":
            self.pick_up(int(parameter))
        elif interface == "deliver":
            self.deliver(int(parameter))
        else:
            raise RuleError(f"there is no action {interface}")


def actions_of_route(floor: Floor, office: int, visits: Sequence[Tuple[str, Request]]) -> List[Tuple[str, str]]:
    """Return the actions, as arguments of `World.do`, of a route from ``office`` along ``visits``.

    A visit is ("pickup", request) or ("deliver", request).
    """
    actions = []
    for interface, request in visits:
        end = request.start if interface == "pickup" else request.end
        actions += [("move_base", f"office{one}") for one in floor.way(office, end)]
        actions.append((interface, str(request.number)))
        office = end
    return actions
