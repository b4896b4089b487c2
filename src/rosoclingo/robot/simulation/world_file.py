"""World files: YAML with a map, robots, doors and obstacles."""

import math
from pathlib import Path
from typing import Tuple, Union

import numpy as np

from rosoclingo.common.reading import MISSING, Reader, read_yaml
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import MapError, OccupancyGrid, load_map
from rosoclingo.robot.simulation.spec import (
    Box,
    DoorSpec,
    LaserSpec,
    ObstacleSpec,
    Point,
    RobotSpec,
    WorldError,
    WorldSpec,
)

LIMIT, BEAM_LIMIT = 1000.0, 100000  # limits of lengths and speeds (m, m/s, rad/s), and of the beams of a scan
DELAY_LIMIT = 2.0  # s: limit of the delay of scans


def load_world(path: Union[str, Path], map_file: str = "") -> WorldSpec:
    """Load a world file and its map, which ``map_file`` overrides. Raises WorldError, which names file and key."""
    path = Path(path)
    reader = read_yaml(path, "world", WorldError)
    named = reader.at("map").text(map_file or MISSING)
    spec = WorldSpec(
        _map(reader.at("map"), map_file or (named and str(path.parent / named))),
        tuple(_robot(item, f"robot_{i}") for i, item in enumerate(reader.at("robots").items())),
        tuple(_door(item) for item in reader.at("doors").items()),
        tuple(_obstacle(item) for item in reader.at("obstacles").items()),
        reader.at("interval").number(0.1, low=0.001, high=10.0),
        reader.at("seed").whole(0, low=0),
        map_file or str(path.parent / named),
    )
    reader.close()
    reader.check(WorldError)
    _check_names(reader, spec)
    _check_points(reader, spec)
    reader.check(WorldError)
    return spec


def _map(reader: Reader, path: str) -> OccupancyGrid:
    """Load the map of a world. Report a fault and return an empty map if that fails."""
    try:
        if path:
            return load_map(path)
    except MapError as error:
        reader.fault(str(error))
    return OccupancyGrid(np.zeros((1, 1), dtype=np.int8), 1.0)


def _check_names(reader: Reader, spec: WorldSpec) -> None:
    if not spec.robots:
        reader.at("robots").fault("a world needs at least one robot")
    for key, names in (
        ("robots", [r.name for r in spec.robots]),
        ("doors", [d.name for d in spec.doors]),
        ("obstacles", [o.name for o in spec.obstacles]),
    ):
        for name in sorted({name for name in names if names.count(name) > 1}):
            reader.at(key).fault(f"{name!r} is used twice")


def _check_points(reader: Reader, spec: WorldSpec) -> None:
    """Report points off the map, and doors of length 0."""
    points = [(f"robots[{i}].pose", robot.pose[:2]) for i, robot in enumerate(spec.robots)]
    points += [(f"doors[{i}].from", door.start) for i, door in enumerate(spec.doors)]
    points += [(f"doors[{i}].to", door.end) for i, door in enumerate(spec.doors)]
    points += [(f"obstacles[{i}].at", obstacle.at) for i, obstacle in enumerate(spec.obstacles)]
    for key, (x, y) in points:
        outside = spec.grid.off_map(x, y)
        if outside:
            reader.at(key).fault(outside)
    for i, door in enumerate(spec.doors):
        if door.start == door.end:
            reader.at(f"doors[{i}]").fault("has the length 0: from and to must differ")


def _robot(reader: Reader, name: str) -> RobotSpec:
    base = RobotSpec()
    footprint = _footprint(reader.at("footprint"))
    # Radius of the circumscribed circle.
    radius = max((math.hypot(*corner) for corner in footprint), default=base.radius)
    spec = RobotSpec(
        reader.at("name").text(name),
        Pose2D(*reader.at("pose").numbers((2, 3))),
        reader.at("radius").number(radius, low=0.01, high=LIMIT),
        footprint,
        reader.at("max_speed").number(base.max_speed, low=0.0, high=LIMIT),
        reader.at("max_turn").number(base.max_turn, low=0.0, high=LIMIT),
        reader.at("acceleration").number(base.acceleration, low=0.0),
        reader.at("turn_acceleration").number(base.turn_acceleration, low=0.0),
        _lasers(reader),
        _point(reader.at("drift").numbers((2,), base.drift)),
    )
    if not all(0.0 <= error <= 1.0 for error in spec.drift):
        reader.at("drift").fault(f"must be two relative errors from 0 to 1, not {list(spec.drift)}")
    reader.close()
    return spec._replace(radius=radius) if footprint else spec


def _footprint(reader: Reader) -> Tuple[Point, ...]:
    """Return the corners of a footprint; empty for a disc."""
    points = tuple(_point(corner.numbers((2,))) for corner in reader.items("a list of at least three corners [x, y]"))
    if 0 < len(points) < 3:
        reader.fault(f"needs at least three corners [x, y], not {reader.value!r}")
    elif max((abs(v) for point in points for v in point), default=0.0) > LIMIT:
        reader.fault(f"a corner is more than {LIMIT} m away")
    elif points and np.linalg.matrix_rank(np.subtract(points, points[0]), tol=1e-3) < 2:
        reader.fault("its corners lie on a line: the footprint needs an area")
    return points


def _lasers(reader: Reader) -> Tuple[LaserSpec, ...]:
    """Return the lasers of ``laser`` or ``lasers``; without either, one with default values."""
    one, several = reader.at("laser"), reader.at("lasers")
    if several.given:
        if one.given:
            several.fault("a robot has either laser or lasers, not both")
        return tuple(_laser(laser) for laser in several.items())
    return () if one.value in (False, None) else (_laser(one),)


def _laser(reader: Reader) -> LaserSpec:
    base = LaserSpec()
    spec = LaserSpec(
        reader.at("range").number(base.range, low=0.01, high=LIMIT),
        reader.at("angle").number(base.angle, low=0.0, high=360.0),
        reader.at("beams").whole(base.beams, low=2, high=BEAM_LIMIT),
        reader.at("noise").number(base.noise, low=0.0, high=LIMIT),
        reader.at("rate").number(base.rate, low=0.01),
        Pose2D(*reader.at("pose").numbers((2, 3), base.pose)),
        reader.at("min_range").number(base.min_range, low=0.0),
        reader.at("delay").number(base.delay, low=0.0, high=DELAY_LIMIT),
    )
    if spec.min_range >= spec.range:
        reader.at("min_range").fault(f"must be less than the range, {spec.range}, not {spec.min_range}")
    reader.close()
    return spec


def _door(reader: Reader) -> DoorSpec:
    spec = DoorSpec(
        reader.at("name").text(),
        _point(reader.at("from").numbers((2,))),
        _point(reader.at("to").numbers((2,))),
        reader.at("open").flag(True),
    )
    reader.close()
    return spec


def _obstacle(reader: Reader) -> ObstacleSpec:
    box, faults = reader.at("box"), len(reader.faults)
    spec = ObstacleSpec(
        reader.at("name").text(),
        _point(reader.at("at").numbers((2,))),
        reader.at("radius").number(0.0, low=0.0),
        Box(*box.numbers((2, 3))) if box.given else None,
    )
    problem = spec.problem()
    if problem and len(reader.faults) == faults:
        reader.fault(problem)
    reader.close()
    return spec


def _point(numbers: Tuple[float, ...]) -> Point:
    return numbers[0], numbers[1]
