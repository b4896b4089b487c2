"""Packages of the simulated office: their places, and the effects of picking up and putting down."""

from typing import Dict, List, NamedTuple, Optional, Tuple

from rosoclingo.common.reading import Reader

DEFAULT_CAPACITY = 3

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
    """Place of a package: the label `location`, or "" if the robot carries it."""

    package: str
    location: str
    carried: bool


def words_for(package: object) -> str:
    """Return the name of a package for messages: "package 1", but "newspaper"."""
    return f"package {package}" if str(package).isdecimal() else str(package)


class PackageOffice:
    """Packages of an office, and one robot that carries at most `capacity` of them.

    Packages and labels are ASP terms as text. A failed operation changes nothing. With `appear`, an unknown package
    appears where the robot first tries to pick it up, since a client of a delivery has put it there. Otherwise the
    pickup fails.
    """

    def __init__(self, labels: Tuple[str, ...], capacity: int = DEFAULT_CAPACITY, appear: bool = False) -> None:
        self._labels, self._capacity, self._appear = labels, capacity, appear
        self._locations: Dict[str, Optional[str]] = {}  # None: carried by the robot

    def read(self, lying: Reader, carried: Optional[Reader] = None) -> None:
        """Add packages from `{label: [package, ...]}`, as in config/office_packages.yaml.

        ``carried`` lists the packages that the robot carries. Faults are collected in the readers.
        """
        places = lying.entries("a mapping of labels to lists of packages", {})
        found: List[Tuple[Reader, Optional[str]]] = [
            (package, label) for label, there in places for package in there.items("a list of packages")
        ]
        found += [(package, None) for package in (carried.items("a list of packages") if carried else ())]
        for reader, label in found:
            package = str(reader.value)
            if package in self._locations:
                reader.fault(f"{words_for(package)} is listed twice")
            try:
                self.put(package, label)
            except PackageError as error:
                reader.fault(str(error))

    @property
    def places(self) -> List[PackagePlace]:
        """All packages, sorted by identifier; numbers come first, in numerical order."""
        known = sorted(self._locations.items(), key=lambda item: _order(item[0]))
        return [PackagePlace(package, location or "", location is None) for package, location in known]

    @property
    def carried(self) -> List[str]:
        """Packages that the robot carries."""
        return [place.package for place in self.places if place.carried]

    @property
    def lying(self) -> Dict[str, List[str]]:
        """Packages that the robot does not carry, in the format of ``read``."""
        found: Dict[str, List[str]] = {}
        for place in self.places:
            if not place.carried:
                found.setdefault(place.location, []).append(place.package)
        return found

    def put(self, package: str, location: Optional[str]) -> None:
        """Move a package to a label, or to the robot (None). Raises PackageError."""
        if not package:
            raise PackageError("a package needs an identifier")
        if location is not None and location not in self._labels:
            known = ", ".join(self._labels) or "none"
            raise PackageError(f"{words_for(package)}: no label {location}; known labels: {known}")
        self._locations[package] = location

    def remove(self, package: str) -> None:
        """Remove a package from the office. Raises PackageError if there is no such package."""
        if package not in self._locations:
            raise PackageError(f"there is no {words_for(package)}")
        del self._locations[package]

    def pickup(self, package: str, robot_at: Optional[str]) -> HandlingResult:
        """Pick up a package with the robot at the label `robot_at` (None: at no label)."""
        if self._appear and robot_at is not None and package not in self._locations:
            self.put(package, robot_at)
        words, location, count = words_for(package), self._locations.get(package), len(self.carried)
        faults = (
            (location is None, NOT_HERE, f"the robot carries {words} already"),
            (location != robot_at, NOT_HERE, f"{words} is at {location}, the robot at {robot_at}"),
            (count >= self._capacity, FULL, f"the robot carries {count} packages already, its maximum"),
        )
        return self._handle(package, robot_at, faults, None, f"picked up {words} at {robot_at}")

    def deliver(self, package: str, robot_at: Optional[str]) -> HandlingResult:
        """Put down a carried package with the robot at the label `robot_at` (None: at no label)."""
        words, location = words_for(package), self._locations.get(package)
        faults = ((location is not None, NOT_CARRIED, f"the robot does not carry {words}, it lies at {location}"),)
        return self._handle(package, robot_at, faults, robot_at, f"put down {words} at {robot_at}")

    def _handle(
        self, package: str, robot_at: Optional[str], faults: Tuple[Tuple[bool, int, str], ...], to: Optional[str],
        done: str,
    ) -> HandlingResult:  # fmt: skip
        """Move a package, unless one of the faults (condition, outcome, message) applies."""
        first = (
            (robot_at is None, NOT_AT_LABEL, "the robot is at no known location"),
            (package not in self._locations, UNKNOWN_PACKAGE, f"there is no {words_for(package)}"),
        )
        for there, outcome, message in first + faults:
            if there:
                return HandlingResult(outcome, message, robot_at or "")
        self._locations[package] = to
        return HandlingResult(SUCCEEDED, done, robot_at or "")


def _order(package: str) -> Tuple[int, int, str]:
    return (0, int(package), "") if package.isdecimal() else (1, 0, package)
