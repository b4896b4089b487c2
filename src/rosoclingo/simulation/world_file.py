"""World files: YAML that names a map, robots, doors, obstacles and packages."""

import math
from pathlib import Path
from typing import Optional, Tuple, Union

import yaml

from rosoclingo.navigation.geometry import Pose2D
from rosoclingo.navigation.grid import MapError, load_map
from rosoclingo.simulation.spec import Box, DoorSpec, LaserSpec, ObstacleSpec, PackageSpec, Point, RobotSpec, WorldSpec
from rosoclingo.simulation.world_reader import MISSING, WorldError, WorldReader

__all__ = ["load_world"]


def load_world(path: Union[str, Path], map_file: str = "") -> WorldSpec:
    """Read a world file and its map (``map_file``: that one instead). Raises WorldError, which names file and key."""
    path = Path(path)
    try:
        data = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, yaml.YAMLError) as error:
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
        float(reader.number("interval", 0.1, low=0.001)),
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
    grid = spec.grid
    rows, columns = grid.shape
    right, top = grid.origin_x + columns * grid.resolution, grid.origin_y + rows * grid.resolution
    for key, (x, y) in points:
        # A door may end where the map does.
        if not (grid.origin_x <= x <= right and grid.origin_y <= y <= top):
            extent = f"x {grid.origin_x:g} .. {right:g}, y {grid.origin_y:g} .. {top:g}"
            raise reader.error(key, f"({x:g}, {y:g}) is off the map, which covers {extent}")
    for i, door in enumerate(spec.doors):
        if door.start == door.end:
            raise reader.error(f"doors[{i}]", "has the length 0: from and to must be different")


def _robot(reader: WorldReader, name: str) -> RobotSpec:
    base = RobotSpec()
    corners = reader.get("footprint", None) or []
    spec = RobotSpec(
        reader.text("name", name),
        Pose2D(*reader.numbers("pose", (2, 3))),
        float(reader.number("radius", base.radius, low=0.01)),
        tuple(_point(reader.floats("footprint", corner, (2,))) for corner in corners),
        float(reader.number("max_speed", base.max_speed, low=0.0)),
        float(reader.number("max_turn", base.max_turn, low=0.0)),
        float(reader.number("acceleration", base.acceleration, low=0.0)),
        float(reader.number("turn_acceleration", base.turn_acceleration, low=0.0)),
        _laser(reader),
        _point(reader.numbers("drift", (2,), base.drift)),
    )
    if spec.footprint and len(spec.footprint) < 3:
        raise reader.error("footprint", "needs three corners or more")
    reader.finish()
    if spec.footprint:
        # The circle around the footprint: how far off the robot's outermost corner is.
        spec = spec._replace(radius=max(math.hypot(*corner) for corner in spec.footprint))
    return spec


def _laser(reader: WorldReader) -> Optional[LaserSpec]:
    value = reader.get("laser", {})
    if value is False or value is None:
        return None
    laser, base = WorldReader(value, reader.place + ".laser", reader.file), LaserSpec()
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
        raise laser.error("angle", f"must be 360 degrees or less, is {spec.angle}")
    laser.finish()
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
    if (spec.radius > 0.0) == (spec.box is not None):
        raise reader.error("", "an obstacle has either a radius or a box: [width, depth] or [width, depth, yaw]")
    reader.finish()
    return spec


def _package(reader: WorldReader) -> PackageSpec:
    at = reader.get("at")
    place = at if isinstance(at, str) and at else _point(reader.floats("at", at, (2,)))
    spec = PackageSpec(str(reader.get("id")), place)
    reader.finish()
    return spec


def _point(numbers: Tuple[float, ...]) -> Point:
    return numbers[0], numbers[1]
