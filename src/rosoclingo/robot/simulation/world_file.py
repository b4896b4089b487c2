"""World files: YAML that names a map, robots, doors, obstacles and packages."""

import math
from pathlib import Path
from typing import Tuple, Union

import numpy as np
import yaml

from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import MapError, load_map
from rosoclingo.robot.simulation.spec import (
    Box,
    DoorSpec,
    LaserSpec,
    ObstacleSpec,
    PackageSpec,
    Point,
    RobotSpec,
    WorldSpec,
)
from rosoclingo.robot.simulation.world_reader import MISSING, WorldError, WorldReader

__all__ = ["load_world"]

# Beyond any robot: m, m/s, rad/s; and what a message can hold in a step of reasonable length.
MOST, MOST_BEAMS = 1000.0, 100000


def load_world(path: Union[str, Path], map_file: str = "") -> WorldSpec:
    """Read a world file and its map (``map_file``: that one instead). Raises WorldError, which names file and key."""
    path = Path(path)
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, yaml.YAMLError) as error:
        raise WorldError(f"world {path}: cannot be read: {error}") from error
    try:
        return _world(WorldReader(data, "", f"world {path}"), path.parent, map_file)
    except MapError as error:
        raise WorldError(f"world {path}: map: {error}") from error


def _world(reader: WorldReader, folder: Path, map_file: str) -> WorldSpec:
    named = folder / reader.text("map", map_file or MISSING)
    chosen = map_file or str(named)
    grid = load_map(chosen)
    spec = WorldSpec(
        grid,
        tuple(_robot(item, f"robot_{i}") for i, item in enumerate(reader.each("robots"))),
        tuple(_door(item) for item in reader.each("doors")),
        tuple(_obstacle(item) for item in reader.each("obstacles")),
        tuple(_package(item) for item in reader.each("packages")),
        float(reader.number("interval", 0.1, low=0.001, high=10.0)),
        reader.number("seed", 0, low=0, whole=True),
        chosen,
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
            raise reader.error(key, f"{twice[0]!r} is there twice")
    _check_points(reader, spec)
    return spec


def _check_points(reader: WorldReader, spec: WorldSpec) -> None:
    """Raise WorldError for what lies off the map."""
    points = [(f"robots[{i}].pose", robot.pose[:2]) for i, robot in enumerate(spec.robots)]
    points += [(f"doors[{i}].from", door.start) for i, door in enumerate(spec.doors)]
    points += [(f"doors[{i}].to", door.end) for i, door in enumerate(spec.doors)]
    points += [(f"obstacles[{i}].at", obstacle.at) for i, obstacle in enumerate(spec.obstacles)]
    points += [(f"packages[{i}].at", p.at) for i, p in enumerate(spec.packages) if not isinstance(p.at, str)]
    for key, (x, y) in points:
        beyond = spec.grid.beyond(x, y)
        if beyond:
            raise reader.error(key, beyond)
    for i, door in enumerate(spec.doors):
        if door.start == door.end:
            raise reader.error(f"doors[{i}]", "has the length 0: from and to must be different")


def _robot(reader: WorldReader, name: str) -> RobotSpec:
    base = RobotSpec()
    footprint = _footprint(reader)
    # The circle around the footprint: how far off the robot's outermost corner is.
    radius = max((math.hypot(*corner) for corner in footprint), default=base.radius)
    spec = RobotSpec(
        reader.text("name", name),
        Pose2D(*reader.numbers("pose", (2, 3))),
        float(reader.number("radius", radius, low=0.01, high=MOST)),
        footprint,
        float(reader.number("max_speed", base.max_speed, low=0.0, high=MOST)),
        float(reader.number("max_turn", base.max_turn, low=0.0, high=MOST)),
        float(reader.number("acceleration", base.acceleration, low=0.0)),
        float(reader.number("turn_acceleration", base.turn_acceleration, low=0.0)),
        _lasers(reader),
        _point(reader.numbers("drift", (2,), base.drift)),
    )
    if not all(0.0 <= error <= 1.0 for error in spec.drift):
        raise reader.error("drift", f"must be two relative errors from 0 to 1, is {list(spec.drift)}")
    reader.finish()
    return spec._replace(radius=radius) if footprint else spec


def _footprint(reader: WorldReader) -> Tuple[Point, ...]:
    """Return the corners of a robot's footprint, none for a disc."""
    corners = reader.get("footprint", None) or []
    if not isinstance(corners, list) or 0 < len(corners) < 3:
        raise reader.error("footprint", f"needs three corners or more, a list of [x, y], is {corners!r}")
    points = tuple(_point(reader.floats("footprint", corner, (2,))) for corner in corners)
    if max((abs(v) for point in points for v in point), default=0.0) > MOST:
        raise reader.error("footprint", f"a corner is more than {MOST} m off")
    if points and np.linalg.matrix_rank(np.subtract(points, points[0]), tol=1e-3) < 2:
        raise reader.error("footprint", "its corners lie in a line: a robot has a length and a width")
    return points


def _lasers(reader: WorldReader) -> Tuple[LaserSpec, ...]:
    """Return the lasers: one by ``laser``, several by ``lasers``, one of defaults without either."""
    value = reader.get("laser", {})
    several = reader.each("lasers")
    if "lasers" not in reader.data:
        several = [] if value in (False, None) else [WorldReader(value, reader.place + ".laser", reader.file)]
    elif "laser" in reader.data:
        raise reader.error("lasers", "a robot has either laser or lasers, not both")
    return tuple(_laser(laser) for laser in several)


def _laser(reader: WorldReader) -> LaserSpec:
    base = LaserSpec()
    spec = LaserSpec(
        float(reader.number("range", base.range, low=0.01, high=MOST)),
        float(reader.number("angle", base.angle, low=0.0, high=360.0)),
        reader.number("beams", base.beams, low=2, high=MOST_BEAMS, whole=True),
        float(reader.number("noise", base.noise, low=0.0, high=MOST)),
        float(reader.number("rate", base.rate, low=0.01)),
        Pose2D(*reader.numbers("pose", (2, 3), base.pose)),
        float(reader.number("min_range", base.min_range, low=0.0)),
    )
    if spec.min_range >= spec.range:
        raise reader.error("min_range", f"must be less than the range, {spec.range}, is {spec.min_range}")
    reader.finish()
    return spec


def _door(reader: WorldReader) -> DoorSpec:
    spec = DoorSpec(
        reader.text("name"),
        _point(reader.numbers("from", (2,))),
        _point(reader.numbers("to", (2,))),
        reader.flag("open", True),
    )
    reader.finish()
    return spec


def _obstacle(reader: WorldReader) -> ObstacleSpec:
    size = reader.get("box", None)
    spec = ObstacleSpec(
        reader.text("name"),
        _point(reader.numbers("at", (2,))),
        float(reader.number("radius", 0.0, low=0.0)),
        Box(*reader.floats("box", size, (2, 3))) if size is not None else None,
    )
    problem = spec.problem()
    if problem:
        raise reader.error("", problem)
    reader.finish()
    return spec


def _package(reader: WorldReader) -> PackageSpec:
    at = reader.get("at")
    place = at if isinstance(at, str) and at else _point(reader.floats("at", at, (2,)))
    name = reader.get("id")
    if isinstance(name, bool) or not isinstance(name, (int, str)) or name == "":
        raise reader.error("id", f"must be a whole number or a text, is {name!r}")
    spec = PackageSpec(str(name), place)
    reader.finish()
    return spec


def _point(numbers: Tuple[float, ...]) -> Point:
    return numbers[0], numbers[1]
