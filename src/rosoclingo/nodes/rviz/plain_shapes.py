"""Plain shapes for rviz, without ROS.

Lengths in metres; positions in the shape's frame; colours are red, green, blue, opacity from 0 to 1. Sizes are for a
map of 16 m; :func:`larger` adapts them to another map.
"""

from typing import List, NamedTuple, Optional, Tuple

Point = Tuple[float, float, float]
Colour = Tuple[float, float, float, float]

INK: Colour = (0.10, 0.14, 0.22, 1.0)
PAPER: Colour = (1.0, 1.0, 1.0, 1.0)

TEXT_SIZE = 0.32
LINE_HEIGHT = 1.04  # of a text in rviz, relative to its size

#: The group of plates; their margin around the text, relative to its size; their distance below the text, which is
#: large enough for rviz's depth test, and their thickness, in m.
PLATES = "plates"
EDGE, BELOW, THICK = 0.2, 0.12, 0.01

#: Widths of letters in rviz, relative to the text's size; those of other letters are 0.46.
_WIDTHS = {" ": 0.6, **dict.fromkeys("fijlrt.,:;!'|()[]-/", 0.23), **dict.fromkeys("mwMW@%", 0.65)}


class Shape(NamedTuple):
    """One marker: ``kind`` is cylinder, cube, arrow (from the first point to the second), line or text.

    A ``plate`` of some colour keeps a text readable on any background; shapes on the robot turn (``turns``).
    """

    group: str
    kind: str
    frame: str
    colour: Colour
    position: Point = (0.0, 0.0, 0.0)
    scale: Point = (1.0, 1.0, 1.0)
    text: str = ""
    points: Tuple[Point, ...] = ()
    plate: Optional[Colour] = None
    turns: bool = False


def text_shape(
    group: str, frame: str, text: str, position: Point, colour: Colour = INK, size: float = TEXT_SIZE
) -> Shape:
    """Return a text that faces the viewer; ``size`` is the approximate height of its letters."""
    return Shape(group, "text", frame, colour, position, (size, size, size), text)


def text_width(text: str, size: float) -> float:
    """Return the approximate width of a text's longest line."""
    return size * max(sum(_WIDTHS.get(letter, 0.46) for letter in line) for line in text.split("\n"))


def with_plate(shape: Shape) -> List[Shape]:
    """Return a shape, and its plate if it has one, as wide as the text.

    For a shape that turns with the robot, the plate is a disc, as rviz turns no text.
    """
    if shape.plate is None:
        return [shape]
    x, y, z = shape.position
    size = shape.scale[2]
    width, height = text_width(shape.text, size) + 2 * EDGE * size, 1.1 * size
    kind, scale = "cube", (width, height, THICK)
    if shape.turns:
        kind, scale = "cylinder", (max(width, height), max(width, height), THICK)
    plate = Shape(PLATES, kind, shape.frame, shape.plate, (x, y, z - BELOW), scale)
    return [plate, shape]


def larger(shape: Shape, factor: float) -> Shape:
    """Return a shape scaled for a large map: texts, at the same upper edge, arrows of plans, and lines."""
    if shape.kind == "text":
        half = 0.5 * (shape.text.count("\n") + 1) * LINE_HEIGHT * shape.scale[2]
        x, y, z = shape.position
        shape = shape._replace(position=(x, y - half * (factor - 1.0), z))
    elif shape.kind != "line" and (shape.kind != "arrow" or shape.group != "plan"):
        return shape
    x, y, z = shape.scale
    return shape._replace(scale=(factor * x, factor * y, factor * z))
