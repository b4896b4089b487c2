"""What rviz is to show of labels, packages and plan: plain shapes, laid out without ROS.

Lengths in metres; positions in the shape's frame; colours are red, green, blue, opacity from 0 to 1.
"""

import math
from typing import Dict, List, NamedTuple, Optional, Sequence, Tuple

from rosoclingo.common.labels import Label, LabelTable
from rosoclingo.reasoning.keywords import Action

Point = Tuple[float, float, float]
Colour = Tuple[float, float, float, float]

BLUE: Colour = (0.16, 0.42, 0.72, 0.35)
INK: Colour = (0.10, 0.14, 0.22, 1.0)
BROWN: Colour = (0.80, 0.55, 0.27, 1.0)
BODY: Colour = (0.20, 0.22, 0.26, 0.9)
NOSE: Colour = (0.96, 0.73, 0.14, 1.0)
NEXT: Colour = (0.90, 0.30, 0.10, 0.95)
LATER: Colour = (0.13, 0.55, 0.33, 0.8)

PACKAGE_SIZE = 0.24
TEXT_SIZE = 0.32
PLAN_TEXT_SIZE = 0.28
TITLE_SIZE = 0.5
LINE_HEIGHT = 1.2  # of a text, in sizes
MOST_LINES = 8
LANE = 0.2


class Shape(NamedTuple):
    """One marker: `kind` is cylinder, cube, arrow (from the first point to the second) or text."""

    group: str
    kind: str
    frame: str
    colour: Colour
    position: Point = (0.0, 0.0, 0.0)
    scale: Point = (1.0, 1.0, 1.0)
    text: str = ""
    points: Tuple[Point, ...] = ()


class PlanStep(NamedTuple):
    """One action of the plan, and the label at which the robot is after it (None if not known)."""

    action: Action
    place: Optional[Label]


def robot_shapes(frame: str, radius: float) -> List[Shape]:
    """The robot as a cylinder with an arrow for its nose."""
    height = 1.2 * radius
    nose = ((0.0, 0.0, height + 0.03), (1.5 * radius, 0.0, height + 0.03))
    return [
        Shape("robot", "cylinder", frame, BODY, (0.0, 0.0, height / 2), (2 * radius, 2 * radius, height)),
        Shape("robot", "arrow", frame, NOSE, scale=(0.3 * radius, 0.7 * radius, 0.5 * radius), points=nose),
    ]


def label_shapes(labels: LabelTable) -> List[Shape]:
    """A disc and a name for each label."""
    shapes = []
    for label in labels:
        shapes.append(Shape("labels", "cylinder", label.frame, BLUE, (label.x, label.y, 0.01), (0.6, 0.6, 0.02)))
        shapes.append(text_shape("labels", label.frame, label.name, (label.x, label.y - 0.55, 0.3), INK))
    return shapes


def larger(shape: Shape, factor: float) -> Shape:
    """A shape to be seen on a large map: texts, their upper edges where they were, and arrows are larger."""
    if shape.kind == "text":
        half = 0.5 * (shape.text.count("\n") + 1) * LINE_HEIGHT * shape.scale[2]
        x, y, z = shape.position
        shape = shape._replace(position=(x, y - half * (factor - 1.0), z))
    elif shape.kind != "arrow" or shape.group != "plan":
        return shape
    return shape._replace(scale=tuple(factor * length for length in shape.scale))


def title_shapes(title: str, panel: Point, frame: str, factor: float = 1.0) -> List[Shape]:
    """The title, to the left of the plan's text, which is larger than usual by a factor."""
    position = (panel[0] - 5.0 * factor, panel[1] - TITLE_SIZE, panel[2])
    return [text_shape("title", frame, title, position, INK, TITLE_SIZE)] if title else []


def package_shapes(places: Sequence[Tuple[str, str, bool]], labels: LabelTable, robot_frame: str) -> List[Shape]:
    """A cube with its name for each package (identifier, label, carried): beside its label, or on the robot."""
    shapes: List[Shape] = []
    there: Dict[str, int] = {}
    for package, location, carried in places:
        if not carried and location not in labels:
            continue
        number = there[location] = there.get(location, -1) + 1
        if carried:
            frame, position = robot_frame, (0.0, 0.0, 0.35 + number * 1.1 * PACKAGE_SIZE)
        else:
            frame, position = labels[location].frame, _beside(labels[location], number)
        x, y, z = position
        size = (PACKAGE_SIZE, PACKAGE_SIZE, PACKAGE_SIZE)
        shapes.append(Shape("packages", "cube", frame, BROWN, position, size))
        shapes.append(text_shape("packages", frame, package, (x, y, z + PACKAGE_SIZE), INK, 0.75 * TEXT_SIZE))
    return shapes


def plan_steps(actions: Sequence[Action], labels: LabelTable) -> List[PlanStep]:
    """The actions with their places: an action whose parameter is a label leads there, others happen on the spot."""
    steps: List[PlanStep] = []
    place: Optional[Label] = None
    for action in actions:
        if action.parameter in labels:  # noqa: SIM401 a table is no dict
            place = labels[action.parameter]
        steps.append(PlanStep(action, place))
    return steps


def plan_shapes(
    steps: Sequence[PlanStep], cycle: int, start: Optional[Tuple[float, float]], panel: Point, frame: str
) -> List[Shape]:
    """The way of the plan from cycle `cycle` on as arrows from `start` (where the robot is), and the plan as text."""
    ahead = [step for step in steps if step.action.cycle >= cycle]
    before = next((step.place for step in reversed(steps) if step.action.cycle < cycle and step.place), None)
    here = start if start is not None else (before.x, before.y) if before is not None else None
    shapes = [_panel(plan_text(steps, cycle), panel, frame)]
    for step in ahead:
        place = step.place
        if place is None:
            continue
        if here is not None and math.hypot(place.x - here[0], place.y - here[1]) > 0.1:
            colour = NEXT if step.action.cycle == cycle else LATER
            points = _lane(here, (place.x, place.y), 0.2 if colour is NEXT else 0.1)
            shapes.append(Shape("plan", "arrow", place.frame, colour, scale=(0.07, 0.2, 0.25), points=points))
        here = (place.x, place.y)
    return shapes


def plan_text(steps: Sequence[PlanStep], cycle: int) -> str:
    """The plan in words, a line for each action, the current one marked; what is far off is left out."""
    lines = [_line(step.action, cycle) for step in steps]
    first = max(0, min(sum(step.action.cycle < cycle for step in steps) - 1, len(lines) - MOST_LINES))
    shown = lines[first : first + MOST_LINES]
    if len(lines) - first > MOST_LINES:
        shown[-1] = f"... {len(lines) - first - MOST_LINES + 1} more"
    state = "plan" if any(step.action.cycle >= cycle for step in steps) else "idle"
    return "\n".join([f"cycle {cycle}: {state}", *shown])


def _line(action: Action, cycle: int) -> str:
    mark = "  done" if action.cycle < cycle else "  now" if action.cycle == cycle else ""
    return f"{action.cycle}. {action.interface_name} {action.parameter}{mark}"


def _panel(text: str, top: Point, frame: str) -> Shape:
    """The text with its upper edge at `top`; rviz puts the middle of a text where it is told."""
    height = (text.count("\n") + 1) * LINE_HEIGHT * PLAN_TEXT_SIZE
    return text_shape("plan", frame, text, (top[0], top[1] - height / 2, top[2]), INK, PLAN_TEXT_SIZE)


def text_shape(group: str, frame: str, text: str, position: Point, colour: Colour, size: float = TEXT_SIZE) -> Shape:
    """A text that faces the viewer; `size` is the height of a capital letter."""
    return Shape(group, "text", frame, colour, position, (size, size, size), text)


def _lane(start: Tuple[float, float], end: Tuple[float, float], z: float) -> Tuple[Point, Point]:
    """Both ends a little to the right of the way, so that there and back can be told apart."""
    dx, dy = end[0] - start[0], end[1] - start[1]
    length = math.hypot(dx, dy)
    right, down = LANE * dy / length, -LANE * dx / length
    return ((start[0] + right, start[1] + down, z), (end[0] + right, end[1] + down, z))


def _beside(label: Label, number: int) -> Point:
    """The place of a label's package: a row before the label, to the left and right in turn."""
    side = (number + 1) // 2 * (1 if number % 2 else -1) * 1.6 * PACKAGE_SIZE
    ahead = 0.65
    cos, sin = math.cos(label.yaw), math.sin(label.yaw)
    return (label.x + ahead * cos - side * sin, label.y + ahead * sin + side * cos, PACKAGE_SIZE / 2)
