"""Packages in the simulated office: where each one is, and what picking up and putting down do to it."""

from typing import Dict, List, NamedTuple, Optional, Tuple

from rosoclingo.common.reading import Reader

DEFAULT_CAPACITY = 3

# Outcome codes of pickup and deliver, equal to the constants of action/Pickup.action and action/Deliver.action.
SUCCEEDED = 0  # done, the package is where it was wanted
FAILED = 1  # the gripper failed
UNKNOWN_PACKAGE = 2  # no such package in this world
NOT_HERE = 3  # package and robot are at different places
NOT_AT_LABEL = 4  # the robot is at no known location
FULL = 5  # the robot carries as much as it can
NOT_CARRIED = 6  # the robot does not carry the package
PREEMPTED = 7  # cancelled before it was done


class PackageError(ValueError):
    """A package or place that cannot be put into the office; the message gives the reason."""


class HandlingResult(NamedTuple):
    """The result of a pickup or a deliver: outcome code, the reason in words, the robot's label ("" if at none)."""

    outcome: int
    message: str
    location: str = ""

    @property
    def succeeded(self) -> bool:
        """True if the package is now where it was wanted."""
        return self.outcome == SUCCEEDED


class PackagePlace(NamedTuple):
    """Where one package is: at the label `location`, or carried by the robot (then `location` is "")."""

    package: str
    location: str
    carried: bool


def words_for(package: object) -> str:
    """Return what messages call a package: "package 1", but just "newspaper"."""
    return f"package {package}" if str(package).isdecimal() else str(package)


class PackageOffice:
    """All packages of one office and one robot that carries at most `capacity` of them.

    Packages and labels are ASP terms as text.  Failed handling changes nothing.  With `appear`, an unknown package is
    found wherever the robot first tries to pick it up (the client of a delivery has put it there); without, picking it
    up fails.
    """

    def __init__(self, labels: Tuple[str, ...], capacity: int = DEFAULT_CAPACITY, appear: bool = False) -> None:
        self._labels, self._capacity, self._appear = labels, capacity, appear
        self._locations: Dict[str, Optional[str]] = {}  # None: carried

    def read(self, lying: Reader, carried: Optional[Reader] = None) -> None:
        """Put `{label: [package, ...]}`, as config/office_packages.yaml holds it; the readers have the faults.

        ``carried`` lists those that the robot carries.
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
        """Every package, ordered by identifier (numbers first, in numerical order)."""
        known = sorted(self._locations.items(), key=lambda item: _order(item[0]))
        return [PackagePlace(package, location or "", location is None) for package, location in known]

    @property
    def carried(self) -> List[str]:
        """The packages that the robot carries."""
        return [place.package for place in self.places if place.carried]

    @property
    def lying(self) -> Dict[str, List[str]]:
        """The packages that lie somewhere, as ``read`` takes them."""
        found: Dict[str, List[str]] = {}
        for place in self.places:
            if not place.carried:
                found.setdefault(place.location, []).append(place.package)
        return found

    def put(self, package: str, location: Optional[str]) -> None:
        """Put a package at a label, wherever it was before, or into the robot's hands (None); raises PackageError."""
        if not package:
            raise PackageError("a package needs an identifier")
        if location is not None and location not in self._labels:
            known = ", ".join(self._labels) or "none"
            raise PackageError(f"{words_for(package)}: no label {location}; known labels: {known}")
        self._locations[package] = location

    def remove(self, package: str) -> None:
        """Take a package out of the office; raises PackageError if there is no such package."""
        if package not in self._locations:
            raise PackageError(f"there is no {words_for(package)}")
        del self._locations[package]

    def pickup(self, package: str, robot_at: Optional[str]) -> HandlingResult:
        """The robot, standing at the label `robot_at` (None: at none), picks up a package."""
        if self._appear and robot_at is not None and package not in self._locations:
            self.put(package, robot_at)
        words, location, count = words_for(package), self._locations.get(package), len(self.carried)
        faults = (
            (location is None, NOT_HERE, f"the robot carries {words} already"),
            (location != robot_at, NOT_HERE, f"{words} is at {location}, the robot at {robot_at}"),
            (count >= self._capacity, FULL, f"the robot carries {count} already, and no more fit"),
        )
        return self._handle(package, robot_at, faults, None, f"picked up {words} at {robot_at}")

    def deliver(self, package: str, robot_at: Optional[str]) -> HandlingResult:
        """The robot, standing at the label `robot_at` (None: at none), puts down a package that it carries."""
        words, location = words_for(package), self._locations.get(package)
        faults = ((location is not None, NOT_CARRIED, f"the robot does not carry {words}, it lies at {location}"),)
        return self._handle(package, robot_at, faults, robot_at, f"put down {words} at {robot_at}")

    def _handle(
        self, package: str, robot_at: Optional[str], faults: Tuple[Tuple[bool, int, str], ...], to: Optional[str],
        done: str,
    ) -> HandlingResult:  # fmt: skip
        """Move a package, unless one of the faults (whether, outcome, message) is there."""
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
