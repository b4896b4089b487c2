"""The program of a fleet, and a world in plain Python whose rules are independent of the encodings.

A `FleetWorld` executes actions, which can overlap, and refuses an action that breaks a rule, so it checks any plans.
"""

import random
from typing import Dict, Iterable, Set, Tuple

from deliveries import CAPACITY, ENCODINGS, Floor, Request
from planning_domains import RuleError

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

DRIVE, HANDLE = 8.0, 3.0
"""Mean durations in seconds of a drive to a neighbouring office, and of picking up or putting down a package."""


def fleet_program(floor: Floor, starts: Dict[str, int], room: int = 1, **constants: int) -> ReactiveProgram:
    """Return the program of robots that start at these offices; each office has room for ``room`` of them."""
    facts = [f"room(office{office},{room})." for office in range(1, floor.offices + 1)]
    facts += [f"start({robot},office{office})." for robot, office in starts.items()]
    sources = [Source.from_file(ENCODINGS / "fleet.lp"), floor.source(*facts)]
    return ReactiveProgram(sources, {name: str(value) for name, value in constants.items()})


class FleetWorld:
    """The floor with robots and packages. Each office has room for ``room`` robots; a drive holds both of its ends.

    Attributes:
        at: robot -> office.
        acts: robot -> verb and object of its action.
        waiting: number -> request, for packages to be picked up.
        load: robot -> number -> office for which the package is bound.
        driven: seconds of driving, of all robots.
        delivered: numbers of the packages that were put down.

    """

    def __init__(self, floor: Floor, starts: Dict[str, int], room: int = 1, seed: int = 0) -> None:
        self.floor, self._room, self._random = floor, room, random.Random(seed)
        self.at = dict(starts)
        self._toward: Dict[str, Set[int]] = {robot: set() for robot in starts}  # offices of drives that have failed
        self.acts: Dict[str, Tuple[str, int]] = {}
        self.waiting: Dict[int, Request] = {}
        self._origins: Dict[int, int] = {}
        self._returnable: Set[int] = set()
        self.load: Dict[str, Dict[int, int]] = {robot: {} for robot in starts}
        self.driven, self.delivered = 0.0, []  # type: float, List[int]

    @property
    def open(self) -> int:
        """The number of packages that wait or are on a robot."""
        return len(self.waiting) + sum(map(len, self.load.values()))

    def ask(self, requests: Iterable[Request]) -> None:
        """Add requests; their packages wait at the start."""
        for one in requests:
            self.waiting[one.number], self._origins[one.number] = one, one.start

    def cancel(self, number: int) -> None:
        """Cancel a request: a package on board goes back, one that is picked up just now as well."""
        if ("pickup", number) in self.acts.values():
            self.waiting[number] = self.waiting[number]._replace(end=self._origins[number])
        else:
            self.waiting.pop(number, None)
        for load in self.load.values():
            if number in load and ("deliver", number) not in self.acts.values():
                load[number] = self._origins[number]

    def allow_return(self, number: int) -> None:
        """Allow that a package is put down at its origin as well, for a cancel whose time is unknown."""
        self._returnable.add(number)

    def begin(self, robot: str, verb: str, what: int) -> float:
        """Begin an action; return its duration in seconds; raises RuleError."""
        fault = self._busy(robot) or {
            "move_base": self._no_drive,
            "pickup": self._no_pickup,
            "deliver": self._no_delivery,
        }[verb](robot, what)
        if fault:
            raise RuleError(f"{robot} cannot {verb} {what} at office {self.at[robot]}: {fault}")
        self.acts[robot] = (verb, what)
        mean = DRIVE if verb == "move_base" else HANDLE
        duration = max(0.2 * mean, self._random.gauss(mean, 0.2 * mean))
        self.driven += duration if verb == "move_base" else 0.0
        return duration

    def end(self, robot: str) -> None:
        """Complete the action of a robot."""
        verb, what = self.acts.pop(robot)
        if verb == "move_base":
            self.at[robot] = what
            self._toward[robot].clear()
        elif verb == "pickup":
            self.load[robot][what] = self.waiting.pop(what).end
        else:
            del self.load[robot][what]
            self.delivered.append(what)

    def fail(self, robot: str) -> None:
        """End the action of a robot without effect; after a drive it is somewhere between both ends."""
        verb, what = self.acts.pop(robot)
        if verb == "move_base" and what != self.at[robot]:
            self._toward[robot].add(what)

    def holders(self, office: int) -> Set[str]:
        """Return the robots at an office, or on their way to it."""
        return {robot for robot in self.at if office in self._held(robot)}

    def _held(self, robot: str) -> Set[int]:
        verb, what = self.acts.get(robot, ("", 0))
        return {self.at[robot], *self._toward[robot], *([what] if verb == "move_base" else [])}

    def _busy(self, robot: str) -> str:
        return "it still has to {} {}".format(*self.acts[robot]) if robot in self.acts else ""

    def _no_drive(self, robot: str, office: int) -> str:
        here, others = self.at[robot], self.holders(office) - {robot}
        if office not in self.floor.neighbours(here) and not (office == here and self._toward[robot]):
            return "no corridor leads there"
        if office not in self._held(robot) and len(others) >= self._room:
            return f"{', '.join(sorted(others))} hold it"
        meets = [one for one in others if self.at[one] == office and self.acts.get(one) == ("move_base", here)]
        return f"it meets {meets[0]}" if meets else ""

    def _no_pickup(self, robot: str, number: int) -> str:
        if self._toward[robot]:
            return "it is between two offices"
        if number not in self.waiting or self.waiting[number].start != self.at[robot]:
            return "it does not wait there"
        if ("pickup", number) in self.acts.values():
            return "another robot picks it up"
        return "the robot is full" if len(self.load[robot]) >= CAPACITY else ""

    def _no_delivery(self, robot: str, number: int) -> str:
        if self._toward[robot]:
            return "it is between two offices"
        if number not in self.load[robot]:
            return "it is not on board"
        bound = {self.load[robot][number], *([self._origins[number]] if number in self._returnable else [])}
        return "" if self.at[robot] in bound else f"it belongs to office {' or '.join(map(str, sorted(bound)))}"
