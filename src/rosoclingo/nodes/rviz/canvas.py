"""A canvas of markers for rviz.

Lengths in metres; positions in the marker's frame; colours are red, green, blue, opacity from 0 to 1. Sizes are for a
map of 16 m; a canvas adapts those of texts and lines to another map.
"""

from typing import List, Optional, Sequence, Tuple

from geometry_msgs.msg import Point as PointMessage
from geometry_msgs.msg import Vector3
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker

Point = Tuple[float, float, float]
Colour = Tuple[float, float, float, float]

INK: Colour = (0.10, 0.14, 0.22, 1.0)
PAPER: Colour = (1.0, 1.0, 1.0, 1.0)

TEXT_SIZE = 0.32
LINE_HEIGHT = 1.04  # of a text in rviz, relative to its size

#: Plates of texts: their margin relative to the text's size; their distance below the text, which is large enough for
#: rviz's depth test, and their thickness, in m.
EDGE, BELOW, THICK = 0.2, 0.12, 0.01

#: Widths of letters in rviz, relative to the text's size; those of other letters are 0.46.
_WIDTHS = {" ": 0.6, **dict.fromkeys("fijlrt.,:;!'|()[]-/", 0.23), **dict.fromkeys("mwMW@%", 0.65)}


class Canvas:
    """Collects ``markers``; ``factor`` is the scale of texts and lines, 1 for a map of 16 m."""

    def __init__(self, factor: float = 1.0) -> None:
        self.factor = factor
        self.markers: List[Marker] = []

    def add(
        self,
        group: str,
        kind: int,
        frame: str,
        colour: Colour,
        position: Point = (0.0, 0.0, 0.0),
        scale: Point = (1.0, 1.0, 1.0),
        points: Sequence[Point] = (),
        text: str = "",
    ) -> None:
        """Add a marker of a ``kind`` of visualization_msgs/Marker."""
        marker = Marker(ns=group, id=len(self.markers), type=kind, action=Marker.ADD, text=text, frame_locked=True)
        marker.header.frame_id = frame
        marker.pose.position = PointMessage(*position)
        marker.pose.orientation.w = 1.0
        marker.scale, marker.color = Vector3(*scale), ColorRGBA(*colour)
        marker.points = [PointMessage(*point) for point in points]
        self.markers.append(marker)

    def line(self, frame: str, colour: Colour, width: float, start: Point, end: Point) -> None:
        """Add a line of the program's drawings."""
        self.add("drawn", Marker.LINE_STRIP, frame, colour, scale=(self.factor * width, 0.0, 0.0), points=(start, end))

    def text(
        self,
        group: str,
        frame: str,
        text: str,
        position: Point,
        colour: Colour = INK,
        size: float = TEXT_SIZE,
        plate: Optional[Colour] = None,
        turns: bool = False,
    ) -> None:
        """Add a text that faces the viewer; ``size`` is the approximate height of its letters.

        ``position`` is its centre for a map of 16 m; on other maps it has the same upper edge. A ``plate`` of some
        colour keeps it readable on any background. If the text ``turns`` with a robot, the plate is a disc, as rviz
        turns no text.
        """
        x, y, z = position
        y -= 0.5 * (text.count("\n") + 1) * LINE_HEIGHT * size * (self.factor - 1.0)
        size *= self.factor
        if plate is not None:
            width, height = text_width(text, size) + 2 * EDGE * size, 1.1 * size
            disc = max(width, height)
            kind, scale = (Marker.CYLINDER, (disc, disc, THICK)) if turns else (Marker.CUBE, (width, height, THICK))
            self.add("plates", kind, frame, plate, (x, y, z - BELOW), scale)
        self.add(group, Marker.TEXT_VIEW_FACING, frame, colour, (x, y, z), (size, size, size), text=text)


def text_width(text: str, size: float) -> float:
    """Return the approximate width of a text's longest line."""
    return size * max(sum(_WIDTHS.get(letter, 0.46) for letter in line) for line in text.split("\n"))
