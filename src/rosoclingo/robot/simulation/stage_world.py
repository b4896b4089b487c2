"""Conversion of this simulator's world files to world files of Stage."""

import math
import os
from pathlib import Path
from typing import List, NamedTuple, Optional, Sequence, Tuple

import numpy as np
from PIL import Image

from rosoclingo.robot.navigation.grid import read_map_info
from rosoclingo.robot.simulation.spec import DoorSpec, LaserSpec, ObstacleSpec, Point, RobotSpec, WorldError, WorldSpec
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
  {size}
  {pose}
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
    things = [_robot(robot) for robot in spec.robots]
    things += [_door(door) for door in spec.doors if not door.open]
    things += [_obstacle(obstacle) for obstacle in spec.obstacles]
    parts = [_head(spec, occupied, source, image if same else own_bitmap), *("\n".join([*one, ""]) for one in things)]
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
        size=_field("size", *size, WALL_HEIGHT),
        pose=_field("pose", *centre, 0, 0),
    )


def _robot(robot: RobotSpec) -> List[str]:
    corners = list(robot.footprint) or _disc(robot.radius)
    size, centre = _extent(corners)
    turn, turn_change = math.degrees(robot.max_turn), math.degrees(robot.turn_acceleration)
    return _entity(
        "position",
        f"name {_text(robot.name)}",
        _field("size", *size, ROBOT_HEIGHT),
        _field("origin", *centre, 0, 0),
        'drive "diff"',
        'color "blue"',
        _field("pose", *robot.pose[:2], 0, math.degrees(robot.pose.yaw)),
        _field("velocity_bounds", -robot.max_speed, robot.max_speed, 0, 0, 0, 0, -turn, turn),
        _field("acceleration_bounds", -robot.acceleration, robot.acceleration, 0, 0, 0, 0, -turn_change, turn_change),
        _block(corners),
        *(line for laser in robot.lasers for line in _ranger(laser)),
    )


def _ranger(laser: LaserSpec) -> List[str]:
    view = f"fov {_number(laser.angle)} samples {laser.beams}"
    # Noise in Stage: a variance, a relative error of the range, an angle.
    noise = " " + _field("noise", laser.noise**2, 0, 0) if laser.noise > 0.0 else ""
    height = LASER_HEIGHT - ROBOT_HEIGHT  # relative to the top of the robot
    return _entity(
        "ranger",
        f"sensor ( {_field('range', laser.min_range, laser.range)} {view}{noise} )",
        'color "black"',
        "size [ 0.05 0.05 0.05 ]",
        _field("pose", *laser.pose[:2], height, math.degrees(laser.pose.yaw)),
        f"update_interval {_number(1000.0 / laser.rate)}",
    )


def _door(door: DoorSpec) -> List[str]:
    (ax, ay), (bx, by) = door.start, door.end
    size, middle = (math.hypot(bx - ax, by - ay), DOOR_THICKNESS), ((ax + bx) / 2.0, (ay + by) / 2.0)
    return _thing(f"door {door.name}", size, middle, math.atan2(by - ay, bx - ax))


def _obstacle(obstacle: ObstacleSpec) -> List[str]:
    if obstacle.box is not None:
        return _thing(obstacle.name, obstacle.box[:2], obstacle.at, obstacle.box.yaw)
    size = (2.0 * obstacle.radius, 2.0 * obstacle.radius)
    return _thing(obstacle.name, size, obstacle.at, 0.0, _block(_disc(obstacle.radius)))


def _thing(name: str, size: Sequence[float], at: Point, yaw: float, *block: str) -> List[str]:
    size_and_pose = _field("size", *size, WALL_HEIGHT), _field("pose", *at, 0, math.degrees(yaw))
    return _entity("model", f"name {_text(name)}", 'color "brown"', *size_and_pose, *block)


def _entity(kind: str, *lines: str) -> List[str]:
    return [kind, "(", *("  " + line for line in lines), ")"]


def _block(corners: Sequence[Point]) -> str:
    """Return a polygon, which Stage scales to the size of the model."""
    points = " ".join(_field(f"point[{i}]", *corner) for i, corner in enumerate(corners))
    return f"block ( points {len(corners)} {points} z [ 0 1 ] )"


def _disc(radius: float) -> List[Point]:
    turns = [2.0 * math.pi * i / CORNERS for i in range(CORNERS)]
    return [(radius * math.cos(turn), radius * math.sin(turn)) for turn in turns]


def _extent(points: Sequence[Point]) -> Tuple[Point, Point]:
    """Return (size, centre) of the bounding box of points."""
    (low_x, low_y), (high_x, high_y) = np.min(points, axis=0).tolist(), np.max(points, axis=0).tolist()
    return (high_x - low_x, high_y - low_y), ((low_x + high_x) / 2.0, (low_y + high_y) / 2.0)


def _field(name: str, *values: float) -> str:
    return f"{name} [ {' '.join(map(_number, values))} ]"


def _number(value: float) -> str:
    return f"{value:.6g}" if abs(value) > 1e-9 else "0"


def _text(value: str) -> str:
    """Return a quoted string. Stage's files cannot escape quotes, so they are replaced."""
    return '"{}"'.format(value.replace('"', "'").replace("\n", " "))
