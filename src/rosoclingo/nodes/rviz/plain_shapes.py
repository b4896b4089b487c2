"""Plain shapes that rviz is to show, without ROS.

Lengths in metres; positions in the shape's frame; colours are red, green, blue, opacity from 0 to 1. Sizes are those
for a map of 16 m; :func:`larger` makes them fit another one.
"""

from typing import List, NamedTuple, Optional, Tuple

__all__ = [
    "INK",
    "LINE_HEIGHT",
    "PAPER",
    "PLATES",
    "TEXT_SIZE",
    "Colour",
    "Point",
    "Shape",
    "larger",
    "plated",
    "text_shape",
    "text_width",
]

Point = Tuple[float, float, float]
Colour = Tuple[float, float, float, float]

INK: Colour = (0.10, 0.14, 0.22, 1.0)
PAPER: Colour = (1.0, 1.0, 1.0, 1.0)

TEXT_SIZE = 0.32
LINE_HEIGHT = 1.04  # of a text as rviz draws it, in sizes

#: The group of plates. How far one reaches beyond its text, in sizes; how far below it is, which is far enough for rviz
#: to see, and how thick, in m.
PLATES = "plates"
EDGE, BELOW, THICK = 0.2, 0.12, 0.01

#: Widths of letters as rviz draws them, in sizes.
_NARROW, _WIDE = frozenset("fijlrt.,:;!'|()[]-/"), frozenset("mwMW@%")
_WIDTHS = {" ": 0.6}


class Shape(NamedTuple):
    """One marker: ``kind`` is cylinder, cube, arrow (from the first point to the second), line or text.

    A ``plate`` of some colour keeps a text readable on any ground; shapes on the robot turn (``turns``).
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
    """A text that faces the viewer; ``size`` is about the height of a letter with its ascender and descender."""
    return Shape(group, "text", frame, colour, position, (size, size, size), text)


def text_width(text: str, size: float) -> float:
    """About how wide a text is: its longest line."""
    return size * max(sum(map(_letter, line)) for line in text.split("\n"))


def _letter(letter: str) -> float:
    return _WIDTHS.get(letter, 0.23 if letter in _NARROW else 0.65 if letter in _WIDE else 0.46)


def plated(shape: Shape) -> List[Shape]:
    """A shape behind its plate, where it has one, which is as wide as its text.

    On what turns with the robot it is a disc: rviz turns no text.
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
    """A shape to be seen on a large map: texts, their upper edges where they were, arrows of plans and lines."""
    if shape.kind == "text":
        half = 0.5 * (shape.text.count("\n") + 1) * LINE_HEIGHT * shape.scale[2]
        x, y, z = shape.position
        shape = shape._replace(position=(x, y - half * (factor - 1.0), z))
    elif shape.kind != "line" and (shape.kind != "arrow" or shape.group != "plan"):
        return shape
    x, y, z = shape.scale
    return shape._replace(scale=(factor * x, factor * y, factor * z))
