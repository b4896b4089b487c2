"""Packages in the simulated office: where each one is, and what picking up and putting down do to it."""

from typing import Any, Dict, List, NamedTuple, Optional, Tuple

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
    """A package or place that cannot be put into the office; the message tells why."""


class HandlingResult(NamedTuple):
    """What came of a pickup or a deliver: outcome code, the reason in words, the robot's label ("" if at none)."""

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
    """What messages call a package: "package 1", but just "newspaper"."""
    return f"package {package}" if str(package).isdecimal() else str(package)


class PackageOffice:
    """All packages of one office and one robot that carries at most `capacity` of them.

    Packages and labels are ASP terms as text.  Failed handling changes nothing.  With `appear`, a package that
    the office never heard of is found wherever the robot first tries to pick it up (who asks for a delivery has put
    it there); without, picking it up fails.
    """

    def __init__(self, labels: Tuple[str, ...], capacity: int = DEFAULT_CAPACITY, appear: bool = False) -> None:
        if capacity < 1:
            raise PackageError(f"the capacity must be at least 1, not {capacity}")
        self._labels = labels
        self._capacity = capacity
        self._appear = appear
        self._locations: Dict[str, Optional[str]] = {}

    @classmethod
    def from_mapping(cls, packages: Any, labels: Tuple[str, ...], appear: bool = False) -> "PackageOffice":
        """An office with packages as ``read`` takes them; raises PackageError with all faults."""
        office, reader = cls(labels, appear=appear), Reader(packages, "packages")
        office.read(reader)
        reader.check(PackageError)
        return office

    def read(self, reader: Reader, carried: Optional[Reader] = None) -> None:
        """Put `{label: [package, ...]}`, as config/office_packages.yaml holds it; the readers have the faults.

        ``carried`` lists those that the robot carries.
        """
        for location, there in reader.entries("a mapping of labels to lists of packages", {}):
            for package in there.items("a list of packages"):
                if str(package.value) in self._locations:
                    package.fault(f"{words_for(package.value)} is listed twice")
                try:
                    self.put(str(package.value), location)
                except PackageError as error:
                    package.fault(str(error))
        for package in carried.items("a list of packages") if carried is not None else ():
            if not str(package.value):
                package.fault("a package needs an identifier")
            elif str(package.value) in self._locations:
                package.fault(f"{words_for(package.value)} is listed twice")
            self._locations[str(package.value)] = None

    @property
    def places(self) -> List[PackagePlace]:
        """Every package, ordered by identifier (numbers first, in numerical order)."""
        return [
            PackagePlace(package, location or "", location is None)
            for package, location in sorted(self._locations.items(), key=lambda item: _order(item[0]))
        ]

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

    def put(self, package: str, location: str) -> None:
        """Put a package at a label, wherever it was before, also out of the robot's hands; raises PackageError."""
        if not package:
            raise PackageError("a package needs an identifier")
        if location not in self._labels:
            raise PackageError(
                "{}: no label {}; known labels: {}".format(
                    words_for(package), location, ", ".join(self._labels) or "none"
                )
            )
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
        refusal = self._refuse(package, robot_at) or self._refuse_pickup(package, robot_at or "")
        if refusal is not None:
            return refusal
        self._locations[package] = None
        return HandlingResult(SUCCEEDED, f"picked up {words_for(package)} at {robot_at}", robot_at or "")

    def deliver(self, package: str, robot_at: Optional[str]) -> HandlingResult:
        """The robot, standing at the label `robot_at` (None: at none), puts down a package that it carries."""
        refusal = self._refuse(package, robot_at)
        if refusal is not None:
            return refusal
        location = robot_at or ""
        if self._locations[package] is not None:
            message = f"the robot does not carry {words_for(package)}, it lies at {self._locations[package]}"
            return HandlingResult(NOT_CARRIED, message, location)
        self._locations[package] = location
        return HandlingResult(SUCCEEDED, f"put down {words_for(package)} at {location}", location)

    def _refuse(self, package: str, robot_at: Optional[str]) -> Optional[HandlingResult]:
        if robot_at is None:
            return HandlingResult(NOT_AT_LABEL, "the robot is at no known location")
        if package not in self._locations:
            return HandlingResult(UNKNOWN_PACKAGE, f"there is no {words_for(package)}", robot_at)
        return None

    def _refuse_pickup(self, package: str, robot_at: str) -> Optional[HandlingResult]:
        location = self._locations[package]
        if location is None:
            return HandlingResult(NOT_HERE, f"the robot carries {words_for(package)} already", robot_at)
        if location != robot_at:
            message = f"{words_for(package)} is at {location}, the robot at {robot_at}"
            return HandlingResult(NOT_HERE, message, robot_at)
        if len(self.carried) >= self._capacity:
            message = f"the robot carries {len(self.carried)} already, and no more fit"
            return HandlingResult(FULL, message, robot_at)
        return None


def _order(package: str) -> Tuple[int, int, str]:
    return (0, int(package), "") if package.isdecimal() else (1, 0, package)
