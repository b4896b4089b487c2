"""World files: YAML that names a map, robots, doors, obstacles and packages."""

import math
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Sequence, Tuple, Union

import yaml

from rosoclingo.navigation.geometry import Pose2D
from rosoclingo.navigation.grid import MapError, OccupancyGrid, load_map

__all__ = [
    "Box",
    "DoorSpec",
    "LaserSpec",
    "ObstacleSpec",
    "PackageSpec",
    "RobotSpec",
    "WorldError",
    "WorldSpec",
    "load_world",
]

Point = Tuple[float, float]
MISSING = object()


class WorldError(ValueError):
    """A world that cannot be, or a change that it does not allow; the message names the place."""


class LaserSpec(NamedTuple):
    """A planar laser scanner: m, degrees (``angle``: of the whole fan), beams, standard deviation (m), Hz, mounting pose."""

    range: float = 8.0
    angle: float = 270.0
    beams: int = 270
    noise: float = 0.0
    rate: float = 10.0
    pose: Pose2D = Pose2D(0.05, 0.0, 0.0)
    min_range: float = 0.0


class RobotSpec(NamedTuple):
    """A differential-drive robot: a disc of ``radius`` (m) or, where given, a ``footprint`` polygon; limits in m, rad, s.

    ``drift``: the greatest relative error (linear, angular) of its odometry; the error itself comes from the seed.
    """

    name: str = "robot_0"
    pose: Pose2D = Pose2D(0.0, 0.0, 0.0)
    radius: float = 0.18
    footprint: Tuple[Point, ...] = ()
    max_speed: float = 0.65
    max_turn: float = 3.14
    acceleration: float = 2.5
    turn_acceleration: float = 6.0
    laser: Optional[LaserSpec] = LaserSpec()
    drift: Tuple[float, float] = (0.0, 0.0)


class DoorSpec(NamedTuple):
    """A door: the segment that it closes (m)."""

    name: str
    start: Point
    end: Point
    open: bool = True


class Box(NamedTuple):
    """The size (m) of a rectangle and its turn (rad)."""

    width: float
    depth: float
    yaw: float = 0.0


class ObstacleSpec(NamedTuple):
    """A movable obstacle that no map shows: a disc of ``radius`` m, or a ``box``."""

    name: str
    at: Point
    radius: float = 0.0
    box: Optional[Box] = None


class PackageSpec(NamedTuple):
    """A package: its id (text, as in a term) and where it is (a label's name, or x, y in m)."""

    id: str
    at: Union[str, Point]


class WorldSpec(NamedTuple):
    """A whole world. ``interval`` is the length of a step in s."""

    grid: OccupancyGrid
    robots: Tuple[RobotSpec, ...]
    doors: Tuple[DoorSpec, ...] = ()
    obstacles: Tuple[ObstacleSpec, ...] = ()
    packages: Tuple[PackageSpec, ...] = ()
    interval: float = 0.1
    seed: int = 0


def load_world(path: Union[str, Path], map_file: str = "") -> WorldSpec:
    """Read a world file and its map (``map_file``: that one instead). Raises WorldError, which names file and key."""
    path = Path(path)
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
        raise WorldError("world {}: cannot be read: {}".format(path, error)) from error
    try:
        return _world(_Reader(data, "", "world {}".format(path)), path.parent, map_file)
    except MapError as error:
        raise WorldError("world {}: map: {}".format(path, error)) from error


class _Reader:
    """Reads the keys of one mapping, remembers which, and complains of wrong and unknown ones by their full name."""

    def __init__(self, data: Any, place: str, file: str) -> None:
        self.place, self.file = place, file
        self._seen: List[str] = []
        if not isinstance(data, dict):
            raise self.error("", "must hold keys and values")
        self.data: Dict[str, Any] = data

    def error(self, key: str, text: str) -> WorldError:
        name = ".".join(part for part in (self.place, key) if part)
        return WorldError("{}: {}{}".format(self.file, name + ": " if name else "", text))

    def get(self, key: str, default: Any = MISSING) -> Any:
        self._seen.append(key)
        value = self.data.get(key, default)
        if value is MISSING:
            raise self.error(key, "is missing")
        return value

    def number(self, key: str, default: Any = MISSING, low: float = -math.inf, whole: bool = False) -> Any:
        value = self.get(key, default)
        kind = int if whole else (int, float)
        if isinstance(value, bool) or not isinstance(value, kind) or not math.isfinite(value):
            raise self.error(key, "must be a {} number, is {!r}".format("whole" if whole else "finite", value))
        if value < low:
            raise self.error(key, "must be {} or more, is {}".format(low, value))
        return value

    def text(self, key: str, default: Any = MISSING) -> str:
        value = self.get(key, default)
        if not isinstance(value, str) or not value:
            raise self.error(key, "must be a text, is {!r}".format(value))
        return value

    def flag(self, key: str, default: bool) -> bool:
        value = self.get(key, default)
        if not isinstance(value, bool):
            raise self.error(key, "must be true or false, is {!r}".format(value))
        return value

    def numbers(self, key: str, sizes: Sequence[int], default: Any = MISSING) -> Tuple[float, ...]:
        return self.floats(key, self.get(key, default), sizes)

    def floats(self, key: str, value: Any, sizes: Sequence[int]) -> Tuple[float, ...]:
        good = isinstance(value, (list, tuple)) and len(value) in sizes
        if not good or not all(isinstance(v, (int, float)) and not isinstance(v, bool) for v in value):
            raise self.error(key, "must be {} numbers, is {!r}".format(" or ".join(map(str, sizes)), value))
        if not all(map(math.isfinite, value)):
            raise self.error(key, "must be finite, is {!r}".format(value))
        return tuple(float(v) for v in value)

    def each(self, key: str) -> List["_Reader"]:
        value = self.get(key, None) or []
        if not isinstance(value, list):
            raise self.error(key, "must be a list")
        place = "{}.{}".format(self.place, key) if self.place else key
        return [_Reader(item, "{}[{}]".format(place, i), self.file) for i, item in enumerate(value)]

    def finish(self) -> None:
        unknown = sorted(str(key) for key in set(self.data) - set(self._seen))
        if unknown:
            raise self.error(unknown[0], "is no key known here (known: {})".format(", ".join(sorted(self._seen))))


def _world(reader: _Reader, folder: Path, map_file: str) -> WorldSpec:
    named = folder / reader.text("map", map_file or MISSING)
    grid = load_map(map_file or named)
    spec = WorldSpec(
        grid,
        tuple(_robot(item, "robot_{}".format(i)) for i, item in enumerate(reader.each("robots"))),
        tuple(_door(item) for item in reader.each("doors")),
        tuple(_obstacle(item) for item in reader.each("obstacles")),
        tuple(_package(item) for item in reader.each("packages")),
        float(reader.number("interval", 0.1, low=0.001)),
        reader.number("seed", 0, low=0, whole=True),
    )
    reader.finish()
    if not spec.robots:
        raise reader.error("robots", "a world needs a robot")
    for key, names in (
        ("robots", [r.name for r in spec.robots]),
        ("doors", [d.name for d in spec.doors]),
        ("obstacles", [o.name for o in spec.obstacles]),
        ("packages", [p.id for p in spec.packages]),
    ):
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            raise reader.error(key, "{!r} is there twice".format(twice[0]))
    return spec


def _robot(reader: _Reader, name: str) -> RobotSpec:
    base = RobotSpec()
    corners = reader.get("footprint", None) or []
    spec = RobotSpec(
        reader.text("name", name),
        Pose2D(*reader.numbers("pose", (2, 3))),
        float(reader.number("radius", base.radius, low=0.01)),
        tuple(reader.floats("footprint", corner, (2,)) for corner in corners),  # type: ignore[misc]
        *(float(reader.number(key, getattr(base, key), low=0.0)) for key in RobotSpec._fields[4:8]),
        _laser(reader),
        reader.numbers("drift", (2,), base.drift),  # type: ignore[arg-type]
    )
    if spec.footprint and len(spec.footprint) < 3:
        raise reader.error("footprint", "needs three corners or more")
    reader.finish()
    if spec.footprint:
        # The circle around the footprint: how far off the robot's outermost corner is.
        spec = spec._replace(radius=max(math.hypot(*corner) for corner in spec.footprint))
    return spec


def _laser(reader: _Reader) -> Optional[LaserSpec]:
    value = reader.get("laser", {})
    if value is False or value is None:
        return None
    laser, base = _Reader(value, reader.place + ".laser", reader.file), LaserSpec()
    spec = LaserSpec(
        float(laser.number("range", base.range, low=0.01)),
        float(laser.number("angle", base.angle, low=0.0)),
        laser.number("beams", base.beams, low=2, whole=True),
        float(laser.number("noise", base.noise, low=0.0)),
        float(laser.number("rate", base.rate, low=0.01)),
        Pose2D(*laser.numbers("pose", (2, 3), base.pose)),
        float(laser.number("min_range", base.min_range, low=0.0)),
    )
    if spec.angle > 360.0:
        raise laser.error("angle", "must be 360 degrees or less, is {}".format(spec.angle))
    laser.finish()
    return spec


def _door(reader: _Reader) -> DoorSpec:
    spec = DoorSpec(
        reader.text("name"), reader.numbers("from", (2,)), reader.numbers("to", (2,)), reader.flag("open", True)
    )  # type: ignore[arg-type]
    reader.finish()
    return spec


def _obstacle(reader: _Reader) -> ObstacleSpec:
    size = reader.get("box", None)
    spec = ObstacleSpec(
        reader.text("name"),
        reader.numbers("at", (2,)),  # type: ignore[arg-type]
        float(reader.number("radius", 0.0, low=0.0)),
        Box(*reader.floats("box", size, (2, 3))) if size is not None else None,
    )
    if (spec.radius > 0.0) == (spec.box is not None):
        raise reader.error("", "an obstacle has either a radius or a box: [width, depth] or [width, depth, yaw]")
    reader.finish()
    return spec


def _package(reader: _Reader) -> PackageSpec:
    at = reader.get("at")
    place = at if isinstance(at, str) and at else reader.floats("at", at, (2,))
    spec = PackageSpec(str(reader.get("id")), place)  # type: ignore[arg-type]
    reader.finish()
    return spec
