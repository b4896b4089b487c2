"""Conversion of this simulator's world files to world files of Stage."""

import math
import os
from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from PIL import Image

from rosoclingo.robot.navigation.grid import read_map_info
from rosoclingo.robot.simulation.spec import LaserSpec, ObstacleSpec, Point, RobotSpec, WorldError, WorldSpec
from rosoclingo.robot.simulation.world_file import load_world

# Stage regards pixels as occupied if their first channel is at most this.
DARK_LIMIT = 127
# Heights (m) of lasers, robots and walls. Robots are higher than lasers, so that they see each other.
LASER_HEIGHT, ROBOT_HEIGHT, WALL_HEIGHT = 0.25, 0.4, 1.0
DOOR_THICKNESS = 0.04  # m: thickness of doors, which are boxes in Stage
CORNERS = 16  # number of corners of the polygon for a disc

HEAD = """\
# Made from {source} by "rosrun rosoclingo stage_world"; do not edit. Open doors are not in it.
resolution 0.01
interval_sim {interval}

define floorplan model
(
  color "gray30"
  boundary 0
  gui_nose 0
  gui_grid 0
  gui_outline 0
  gripper_return 0
  fiducial_return 0
  ranger_return 1
)

floorplan
(
  name "map"
  bitmap "{bitmap}"
  size [ {size} {height} ]
  pose [ {centre} 0 0 ]
)
"""


class StageWorld(NamedTuple):
    """The ``text`` of a world file, and a ``bitmap`` if Stage would misread the image of the map."""

    text: str
    bitmap: Optional[np.ndarray]


def write_stage_world(source: str, target: str) -> List[str]:
    """Convert a world file to one of Stage. Return the names of the written files.

    Raises WorldError, and OSError if a file cannot be written.
    """
    spec, path = load_world(source), Path(target)
    own = path.with_name(path.stem + "_stage.pgm")
    image = os.path.relpath(str(read_map_info(spec.map_file)["image"]), str(path.parent))
    world = stage_world(spec, Path(source).name, image, own.name)
    path.write_text(world.text, encoding="utf-8")
    if world.bitmap is None:
        return [str(path)]
    Image.fromarray(world.bitmap).save(str(own))
    return [str(path), str(own)]


def stage_world(spec: WorldSpec, source: str, image: str, own_bitmap: str) -> StageWorld:
    """Convert a world to one of Stage. Raises WorldError for a map without walls, which Stage cannot scale.

    ``source`` is the name of the original file, for a comment. ``image`` is the map's image and ``own_bitmap`` the file
    for a separate image, both relative to the world file.
    """
    occupied = spec.grid.occupied().astype(bool)
    if not occupied.any():
        raise WorldError(f"world {source}: map: no cell is occupied; Stage needs walls to scale the map")
    same = spec.map_file != "" and np.array_equal(_dark(spec.map_file), occupied)
    parts = [_head(spec, occupied, source, image if same else own_bitmap)]
    parts += [_robot(robot) for robot in spec.robots]
    parts += [_door(door.name, door.start, door.end) for door in spec.doors if not door.open]
    parts += [_obstacle(obstacle) for obstacle in spec.obstacles]
    bitmap = None if same else np.where(occupied[::-1], 0, 255).astype(np.uint8)
    return StageWorld("\n".join(parts), bitmap)


def _dark(map_file: str) -> np.ndarray:
    """Return the mask (bool; row 0 at the bottom) of pixels that Stage regards as occupied."""
    with Image.open(str(read_map_info(Path(map_file))["image"])) as image:
        pixels = np.asarray(image if image.mode in ("L", "RGB", "RGBA") else image.convert("L"))
    first = pixels if pixels.ndim == 2 else pixels[:, :, 0]
    return np.asarray(first <= DARK_LIMIT)[::-1]


def _head(spec: WorldSpec, occupied: np.ndarray, source: str, bitmap: str) -> str:
    """Return the map's section. Stage scales the bounding box of occupied pixels to ``size``."""
    rows, columns = np.flatnonzero(occupied.any(axis=1)), np.flatnonzero(occupied.any(axis=0))
    scale = spec.grid.resolution
    low = (spec.grid.origin_x + columns[0] * scale, spec.grid.origin_y + rows[0] * scale)
    high = (spec.grid.origin_x + (columns[-1] + 1) * scale, spec.grid.origin_y + (rows[-1] + 1) * scale)
    size, centre = _extent([low, high])
    return HEAD.format(
        source=source,
        interval=_number(1000.0 * spec.interval),
        bitmap=bitmap,
        size=_numbers(size),
        centre=_numbers(centre),
        height=_number(WALL_HEIGHT),
    )


def _robot(robot: RobotSpec) -> str:
    corners = list(robot.footprint) or _disc(robot.radius)
    size, centre = _extent(corners)
    turn, turn_change = math.degrees(robot.max_turn), math.degrees(robot.turn_acceleration)
    lines = [
        f"name {_text(robot.name)}",
        f"size [ {_numbers(size)} {_number(ROBOT_HEIGHT)} ]",
        f"origin [ {_numbers(centre)} 0 0 ]",
        'drive "diff"',
        'color "blue"',
        f"pose [ {_numbers(robot.pose[:2])} 0 {_number(math.degrees(robot.pose.yaw))} ]",
        f"velocity_bounds [ {_bounds(robot.max_speed)} 0 0 0 0 {_bounds(turn)} ]",
        f"acceleration_bounds [ {_bounds(robot.acceleration)} 0 0 0 0 {_bounds(turn_change)} ]",
        *_block(corners),
    ]
    for laser in robot.lasers:
        lines += _ranger(laser)
    return _entity("position", lines)


def _ranger(laser: LaserSpec) -> List[str]:
    # Noise in Stage: a variance, a relative error of the range, an angle.
    noise = f" noise [ {_number(laser.noise**2)} 0 0 ]" if laser.noise > 0.0 else ""
    height = _number(LASER_HEIGHT - ROBOT_HEIGHT)  # relative to the top of the robot
    return [
        "ranger",
        "(",
        f"  sensor ( range [ {_numbers((laser.min_range, laser.range))} ] "
        f"fov {_number(laser.angle)} samples {laser.beams}{noise} )",
        '  color "black"',
        "  size [ 0.05 0.05 0.05 ]",
        f"  pose [ {_numbers(laser.pose[:2])} {height} {_number(math.degrees(laser.pose.yaw))} ]",
        f"  update_interval {_number(1000.0 / laser.rate)}",
        ")",
    ]


def _door(name: str, start: Point, end: Point) -> str:
    length, yaw = math.hypot(end[0] - start[0], end[1] - start[1]), math.atan2(end[1] - start[1], end[0] - start[0])
    middle = ((start[0] + end[0]) / 2.0, (start[1] + end[1]) / 2.0)
    return _thing(f"door {name}", (length, DOOR_THICKNESS), middle, yaw)


def _obstacle(obstacle: ObstacleSpec) -> str:
    if obstacle.box is not None:
        return _thing(obstacle.name, obstacle.box[:2], obstacle.at, obstacle.box.yaw)
    size = (2.0 * obstacle.radius, 2.0 * obstacle.radius)
    return _thing(obstacle.name, size, obstacle.at, 0.0, _block(_disc(obstacle.radius)))


def _thing(name: str, size: Sequence[float], at: Point, yaw: float, block: Sequence[str] = ()) -> str:
    return _entity(
        "model",
        [
            f"name {_text(name)}",
            'color "brown"',
            f"size [ {_numbers(size)} {_number(WALL_HEIGHT)} ]",
            f"pose [ {_numbers(at)} 0 {_number(math.degrees(yaw))} ]",
            *block,
        ],
    )


def _entity(kind: str, lines: Sequence[str]) -> str:
    return "\n".join([kind, "(", *("  " + line for line in lines), ")", ""])


def _block(corners: Sequence[Point]) -> List[str]:
    """Return the lines of a polygon, which Stage scales to the size of the model."""
    points = " ".join(f"point[{i}] [ {_numbers(corner)} ]" for i, corner in enumerate(corners))
    return [f"block ( points {len(corners)} {points} z [ 0 1 ] )"]


def _disc(radius: float) -> List[Point]:
    turns = [2.0 * math.pi * i / CORNERS for i in range(CORNERS)]
    return [(radius * math.cos(turn), radius * math.sin(turn)) for turn in turns]


def _extent(points: Sequence[Point]) -> Tuple[Point, Point]:
    """Return (size, centre) of the bounding box of points."""
    (low_x, low_y), (high_x, high_y) = np.min(points, axis=0).tolist(), np.max(points, axis=0).tolist()
    return (high_x - low_x, high_y - low_y), ((low_x + high_x) / 2.0, (low_y + high_y) / 2.0)


def _bounds(limit: float) -> str:
    return _numbers((-limit, limit))


def _numbers(values: Sequence[float]) -> str:
    return " ".join(map(_number, values))


def _number(value: float) -> str:
    return f"{value:.6g}" if abs(value) > 1e-9 else "0"


def _text(value: str) -> str:
    """Return a quoted string. Stage's files cannot escape quotes, so they are replaced."""
    return '"{}"'.format(value.replace('"', "'").replace("\n", " "))
