"""Deliveries for benches: floors, random requests, and the rules in plain Python.

The rules are those of the documents, written without a look at the encodings: a `World` takes one action after another
and refuses what is against them, whoever plans. All here is pure: no solver, no ROS.
"""

import copy
import random
from typing import Dict, FrozenSet, Iterable, List, NamedTuple, Tuple

CAPACITY = 3
"""Packages that the robot can carry."""

Corridor = Tuple[int, int]


class RuleError(Exception):
    """An action is against the rules; the message says which one and why."""


class Request(NamedTuple):
    """Bring package ``number`` from office ``start`` to office ``end``."""

    number: int
    start: int
    end: int

    @property
    def goal(self) -> str:
        """As the mailbot's program has it."""
        return f"goal(office{self.start},office{self.end},{self.number})"


class Floor(NamedTuple):
    """Offices 1 to ``offices``, and the corridors between two of them; the robot begins at office 1."""

    name: str
    offices: int
    corridors: FrozenSet[Corridor]

    @property
    def instance(self) -> str:
        """The floor as the mailbot's program takes it."""
        facts = [f"office(office{number})." for number in range(1, self.offices + 1)]
        facts += [f"corridor(office{a},office{b})." for a, b in sorted(self.corridors)]
        return "\n".join(["#program base.", "start(office1).", *facts, ""])

    def neighbours(self, office: int) -> List[int]:
        """The offices that a corridor leads to."""
        return sorted({a + b - office for a, b in self.corridors if office in (a, b)})


def row(offices: int) -> Floor:
    """Offices in a row."""
    return Floor(str(offices), offices, frozenset((one, one + 1) for one in range(1, offices)))


def _loop(first: int, length: int) -> List[Corridor]:
    offices = [*range(first, first + length), first]
    return list(zip(offices, offices[1:]))


def loops() -> Floor:
    """Twenty offices: two loops of eight, joined by way of office 17, and rooms off them."""
    rooms = [(5, 17), (17, 9), (3, 18), (12, 19), (19, 20)]
    return Floor("loops", 20, frozenset([*_loop(1, 8), *_loop(9, 8), *rooms]))


def floor_named(name: str) -> Floor:
    """``loops``, or a row of so many offices; raises ValueError."""
    if name == "loops":
        return loops()
    if not name.isdecimal() or int(name) < 2:
        raise ValueError(f"a floor is a number of offices in a row, two at least, or loops; not {name}")
    return row(int(name))


def random_requests(floor: Floor, count: int, seed: int) -> List[Request]:
    """Requests between two different offices each, the same for the same arguments."""
    source = random.Random(1000 * seed + count)
    offices = range(1, floor.offices + 1)
    return [Request(number, *source.sample(offices, 2)) for number in range(1, count + 1)]


class World:
    """The floor with the robot and the packages.

    Attributes:
        office: where the robot is.
        waiting: the requests whose packages wait to be picked up.
        carried: those whose packages are on the robot.
        actions: how many actions were done.

    """

    def __init__(self, floor: Floor) -> None:
        self._neighbours = {office: floor.neighbours(office) for office in range(1, floor.offices + 1)}
        self.office, self.actions = 1, 0
        self.waiting: Dict[int, Request] = {}
        self.carried: Dict[int, Request] = {}

    @property
    def open(self) -> int:
        """How many requests are not met yet."""
        return len(self.waiting) + len(self.carried)

    def copy(self) -> "World":
        """Another world that is as this one is now."""
        other = copy.copy(self)
        other.waiting, other.carried = dict(self.waiting), dict(self.carried)
        return other

    def ask(self, requests: Iterable[Request]) -> None:
        """Let packages wait where they are to be picked up."""
        self.waiting.update((request.number, request) for request in requests)

    def move(self, office: int) -> None:
        """Move to a neighbouring office; raises RuleError."""
        if office not in self._neighbours[self.office]:
            raise RuleError(f"no corridor leads from office {self.office} to {office}")
        self.office = office
        self.actions += 1

    def pick_up(self, number: int) -> None:
        """Take a package that waits here on the robot; raises RuleError."""
        request = self.waiting.get(number)
        if request is None or request.start != self.office:
            raise RuleError(f"package {number} does not wait at office {self.office}")
        if len(self.carried) >= CAPACITY:
            raise RuleError(f"package {number} is one too many for the robot")
        self.carried[number] = self.waiting.pop(number)
        self.actions += 1

    def deliver(self, number: int) -> None:
        """Put a package down where it belongs; raises RuleError."""
        request = self.carried.get(number)
        if request is None or request.end != self.office:
            raise RuleError(f"package {number} is not on the robot, or does not belong to office {self.office}")
        del self.carried[number]
        self.actions += 1

    def do(self, interface: str, parameter: str) -> None:
        """Do an action as the mailbot's program names it; raises RuleError."""
        if interface == "move_base":
            self.move(int(parameter.replace("office", "")))
        elif interface == "pickup":
            self.pick_up(int(parameter))
        elif interface == "deliver":
            self.deliver(int(parameter))
        else:
            raise RuleError(f"there is no action {interface}")
