"""Draws on the map in rviz: labels, packages, the plan's way, and the program's drawings."""

import math
from typing import Dict, Iterable, List, Optional, Sequence, Tuple

from visualization_msgs.msg import Marker

from rosoclingo.common.labels import Label, LabelTable
from rosoclingo.nodes.rviz.canvas import INK, PAPER, TEXT_SIZE, Canvas, Colour, Point
from rosoclingo.reasoning.keywords import Action
from rosoclingo.runs.drawing import Drawing, DrawingKind

BLUE: Colour = (0.16, 0.42, 0.72, 0.35)
BROWN: Colour = (0.80, 0.55, 0.27, 1.0)
BODY: Colour = (0.20, 0.22, 0.26, 0.9)
NOSE: Colour = (0.96, 0.73, 0.14, 1.0)
NEXT: Colour = (0.90, 0.30, 0.10, 0.95)
LATER: Colour = (0.13, 0.55, 0.33, 0.8)
SHUT: Colour = (0.75, 0.21, 0.17, 0.95)
GRAY: Colour = (0.35, 0.40, 0.47, 0.5)

#: Colours of ways, and their widths in m.
WAYS = {DrawingKind.WAY: (GRAY, 0.04), DrawingKind.OPEN: (LATER, 0.08), DrawingKind.BLOCKED: (SHUT, 0.08)}
BAR = 0.6  # length in m of the bar across a blocked way

PACKAGE_SIZE = 0.24
TAIL = 0.75  # distance in m of a robot's name from its middle, where its load is
LANE = 0.2


def draw_robot(canvas: Canvas, frame: str, radius: float, name: str = "") -> None:
    """Draw the robot as a cylinder with an arrow for its heading, and its name behind it."""
    height = 1.2 * radius
    if name:
        canvas.text("robot", frame, name, (-TAIL, 0.0, height + 0.3), plate=PAPER, turns=True)
    size = (2 * radius, 2 * radius, height)
    canvas.add("robot", Marker.CYLINDER, frame, BODY, (0.0, 0.0, height / 2), size)
    nose = ((0.0, 0.0, height + 0.03), (1.5 * radius, 0.0, height + 0.03))
    canvas.add("robot", Marker.ARROW, frame, NOSE, scale=(0.3 * radius, 0.7 * radius, 0.5 * radius), points=nose)


def draw_labels(canvas: Canvas, labels: LabelTable) -> None:
    """Draw a disc and a name for each label."""
    for label in labels:
        canvas.add("labels", Marker.CYLINDER, label.frame, BLUE, (label.x, label.y, 0.01), (0.6, 0.6, 0.02))
        _tag(canvas, "labels", label.frame, label.name, (label.x, label.y - 0.55))


def draw_packages(
    canvas: Canvas, places: Sequence[Tuple[str, str, bool]], labels: LabelTable, robot_frame: str
) -> None:
    """Draw a cube with its name for each package (identifier, label, carried), at its label or on the robot.

    A carried package can have the name of one of several robots in place of the label.
    """
    there: Dict[str, int] = {}
    for package, location, carried in places:
        if not carried and location not in labels:
            continue
        number = there[location] = there.get(location, -1) + 1
        if carried:
            frame = f"{location}/{robot_frame}" if location else robot_frame
            position: Point = (0.0, _aside(number), 0.35)
        else:
            frame, position = labels[location].frame, _package_place(labels[location], number)
        x, y, z = position
        canvas.add("packages", Marker.CUBE, frame, BROWN, position, (PACKAGE_SIZE, PACKAGE_SIZE, PACKAGE_SIZE))
        above, size = (x, y, z + PACKAGE_SIZE), 0.75 * TEXT_SIZE
        canvas.text("packages", frame, package, above, size=size, plate=BROWN, turns=carried)


def things_in(drawings: Iterable[Drawing]) -> List[Tuple[str, str, bool]]:
    """Return the things in drawings of the program, in the form of :func:`draw_packages`."""
    return [
        (one.text, one.labels[0] if one.labels else "", one.kind is DrawingKind.CARRIED)
        for one in drawings
        if one.kind in (DrawingKind.THING, DrawingKind.CARRIED)
    ]


def draw_drawings(canvas: Canvas, drawings: Sequence[Drawing], labels: LabelTable) -> None:
    """Draw the program's drawings: ways between labels, also blocked, and texts at labels."""
    ways = sorted((one for one in drawings if one.kind in WAYS), key=lambda one: list(WAYS).index(one.kind))
    for height, one in enumerate(ways):
        _draw_way(canvas, one, labels[one.labels[0]], labels[one.labels[1]], 0.02 + 0.0001 * height)
    marks: Dict[str, int] = {}
    for one in drawings:
        if one.kind is DrawingKind.MARK:
            label, number = labels[one.labels[0]], marks.get(one.labels[0], 0)
            marks[one.labels[0]] = number + 1
            _tag(canvas, "drawn", label.frame, one.text, (label.x, label.y + 0.55 + 0.4 * number))


def _draw_way(canvas: Canvas, one: Drawing, start: Label, end: Label, height: float) -> None:
    """Draw a line between two labels, a bar across it if it is blocked, and its text."""
    colour, width = WAYS[one.kind]
    x, y = (start.x + end.x) / 2, (start.y + end.y) / 2
    canvas.line(start.frame, colour, width, (start.x, start.y, height), (end.x, end.y, height))
    length = math.hypot(end.x - start.x, end.y - start.y)
    if one.kind is DrawingKind.BLOCKED and length:
        across, up = BAR / 2 * (end.y - start.y) / length, BAR / 2 * (start.x - end.x) / length
        canvas.line(start.frame, colour, 3 * width, (x - across, y - up, 0.25), (x + across, y + up, 0.25))
    if one.text:
        _tag(canvas, "drawn", start.frame, one.text, (x, y + 0.5), (*colour[:3], 1.0))


def _tag(canvas: Canvas, group: str, frame: str, text: str, place: Tuple[float, float], colour: Colour = INK) -> None:
    """Draw a text that is readable on walls and furniture, above arrows."""
    canvas.text(group, frame, text, (*place, 0.4), colour, plate=PAPER)


def draw_plan(
    canvas: Canvas, actions: Sequence[Action], labels: LabelTable, cycle: int, start: Optional[Tuple[float, float]]
) -> None:
    """Draw the plan's way from cycle `cycle` on as arrows from `start` (the robot's position).

    An action whose parameter is a label leads there; others do not move the robot.
    """
    here, size = start, (0.07 * canvas.factor, 0.2 * canvas.factor, 0.25 * canvas.factor)
    for action in actions:
        if action.parameter not in labels:
            continue
        place = labels[action.parameter]
        if action.cycle < cycle:
            here = start or (place.x, place.y)
            continue
        if here is not None and math.hypot(place.x - here[0], place.y - here[1]) > 0.1:
            colour = NEXT if action.cycle == cycle else LATER
            points = _lane(here, (place.x, place.y), 0.2 if colour is NEXT else 0.1)
            canvas.add("plan", Marker.ARROW, place.frame, colour, scale=size, points=points)
        here = (place.x, place.y)


def _lane(start: Tuple[float, float], end: Tuple[float, float], z: float) -> Tuple[Point, Point]:
    """Return both ends, moved a little to the right, so that ways in both directions are visible."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.hypot(dx, dy)
    right, down = LANE * dy / length, -LANE * dx / length
    return ((start[0] + right, start[1] + down, z), (end[0] + right, end[1] + down, z))


def _aside(number: int) -> float:
    """Return the place of a package in a row, alternating left and right of the first one, in m."""
    return (number + 1) // 2 * (1 if number % 2 else -1) * 1.6 * PACKAGE_SIZE


def _package_place(label: Label, number: int) -> Point:
    """Return the place of a label's package, in a row before the label."""
    side = _aside(number)
    ahead = 0.65
    cos, sin = math.cos(label.yaw), math.sin(label.yaw)
    return (label.x + ahead * cos - side * sin, label.y + ahead * sin + side * cos, PACKAGE_SIZE / 2)
