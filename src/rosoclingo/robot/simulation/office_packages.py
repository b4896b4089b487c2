"""Packages of the simulated office: their places, and the effects of picking up and putting down."""

from typing import Dict, List, NamedTuple, Optional, Tuple

from rosoclingo.common.reading import Reader

DEFAULT_CAPACITY = 3

#: The name of the robot if there is only one.
ROBOT = ""

# Outcome codes of pickup and deliver, equal to the constants of action/Pickup.action and action/Deliver.action.
SUCCEEDED = 0  # the package is at its new place
FAILED = 1  # the gripper failed
UNKNOWN_PACKAGE = 2  # the package does not exist
NOT_HERE = 3  # package and robot are at different places
NOT_AT_LABEL = 4  # the robot is at no known location
FULL = 5  # the robot cannot carry more packages
NOT_CARRIED = 6  # the robot does not carry the package
PREEMPTED = 7  # cancelled before completion


class PackageError(ValueError):
    """Invalid package or place. The message gives the reason."""


class HandlingResult(NamedTuple):
    """Result of a pickup or delivery: outcome code, reason, and the label of the robot ("" if at none)."""

    outcome: int
    message: str
    location: str = ""

    @property
    def succeeded(self) -> bool:
        """Whether the package is at its new place."""
        return self.outcome == SUCCEEDED


class PackagePlace(NamedTuple):
    """Place of a package: the label `location`, or the name of the robot that carries it ("" if there is only one)."""

    package: str
    location: str
    carried: bool


def words_for(package: object) -> str:
    """Return the name of a package for messages: "package 1", but "newspaper"."""
    return f"package {package}" if str(package).isdecimal() else str(package)


class PackageOffice:
    """Packages of an office, and robots that carry at most `capacity` of them each.

    Packages and labels are ASP terms as text. A failed operation changes nothing. With `appear`, an unknown package
    appears where the robot first tries to pick it up, since a client of a delivery has put it there. Otherwise the
    pickup fails.
    """

    def __init__(self, labels: Tuple[str, ...], capacity: int = DEFAULT_CAPACITY, appear: bool = False) -> None:
        self._labels, self._capacity, self._appear = labels, capacity, appear
        self._places: Dict[str, PackagePlace] = {}

    def read(self, lying: Reader, carried: Optional[Reader] = None) -> None:
        """Add packages from `{label: [package, ...]}`, as in config/office_packages.yaml.

        ``carried`` lists the packages that the robot carries, or those of each robot by its name. Faults are collected
        in the readers.
        """
        wanted = "a list of packages"
        for label, some in lying.entries("a mapping of labels to lists of packages", {}):
            for package in some.items(wanted):
                self._add(package, label, carried=False)
        if carried is not None:
            robots = carried.entries() if isinstance(carried.value, dict) else [(ROBOT, carried)]
            for robot, some in robots:
                for package in some.items(wanted):
                    self._add(package, robot, carried=True)

    def _add(self, reader: Reader, place: str, carried: bool) -> None:
        package = str(reader.value)
        if package in self._places:
            reader.fault(f"{words_for(package)} is listed twice")
        try:
            self.put(package, place, carried)
        except PackageError as error:
            reader.fault(str(error))

    @property
    def places(self) -> List[PackagePlace]:
        """All packages, sorted by identifier; numbers come first, in numerical order."""
        return sorted(self._places.values(), key=lambda place: _order(place.package))

    def carried_by(self, robot: str) -> List[str]:
        """Return the packages that a robot carries."""
        return [place.package for place in self.places if place.carried and place.location == robot]

    @property
    def lying(self) -> Dict[str, List[str]]:
        """Packages that no robot carries, in the format of ``read``."""
        found: Dict[str, List[str]] = {}
        for place in self.places:
            if not place.carried:
                found.setdefault(place.location, []).append(place.package)
        return found

    def put(self, package: str, location: str, carried: bool = False) -> None:
        """Move a package to a label, or to the robot of this name that carries it. Raises PackageError."""
        if not package:
            raise PackageError("a package needs an identifier")
        if not carried and location not in self._labels:
            known = ", ".join(self._labels) or "none"
            raise PackageError(f"{words_for(package)}: no label {location}; known labels: {known}")
        self._places[package] = PackagePlace(package, location, carried)

    def remove(self, package: str) -> None:
        """Remove a package from the office. Raises PackageError if there is no such package."""
        if package not in self._places:
            raise PackageError(f"there is no {words_for(package)}")
        del self._places[package]

    def pickup(self, package: str, robot_at: Optional[str], robot: str = ROBOT) -> HandlingResult:
        """Pick up a package with the robot at the label `robot_at` (None: at no label)."""
        if self._appear and robot_at is not None and package not in self._places:
            self.put(package, robot_at)
        words, place, count = words_for(package), self._place(package), len(self.carried_by(robot))
        carrier = "the robot" if place.location == robot else f"robot {place.location}"
        faults = (
            (place.carried, NOT_HERE, f"{carrier} carries {words} already"),
            (place.location != robot_at, NOT_HERE, f"{words} is at {place.location}, the robot at {robot_at}"),
            (count >= self._capacity, FULL, f"the robot carries {count} packages already, its maximum"),
        )
        result = self._handle(package, robot_at, faults, f"picked up {words} at {robot_at}")
        if result.succeeded:
            self.put(package, robot, carried=True)
        return result

    def deliver(self, package: str, robot_at: Optional[str], robot: str = ROBOT) -> HandlingResult:
        """Put down a package that the robot carries, with the robot at the label `robot_at` (None: at no label)."""
        words, place = words_for(package), self._place(package)
        where = f"robot {place.location} carries it" if place.carried else f"it lies at {place.location}"
        there = place.carried and place.location == robot
        faults = ((not there, NOT_CARRIED, f"the robot does not carry {words}, {where}"),)
        result = self._handle(package, robot_at, faults, f"put down {words} at {robot_at}")
        if result.succeeded:
            self.put(package, str(robot_at))
        return result

    def _place(self, package: str) -> PackagePlace:
        return self._places.get(package, PackagePlace(package, "", False))

    def _handle(
        self, package: str, robot_at: Optional[str], faults: Tuple[Tuple[bool, int, str], ...], done: str
    ) -> HandlingResult:
        """Return the result of moving a package: the first fault (condition, outcome, message) that applies."""
        first = (
            (robot_at is None, NOT_AT_LABEL, "the robot is at no known location"),
            (package not in self._places, UNKNOWN_PACKAGE, f"there is no {words_for(package)}"),
        )
        for there, outcome, message in first + faults:
            if there:
                return HandlingResult(outcome, message, robot_at or "")
        return HandlingResult(SUCCEEDED, done, robot_at or "")


def _order(package: str) -> Tuple[int, int, str]:
    return (0, int(package), "") if package.isdecimal() else (1, 0, package)
