"""Labels: named locations on the map, the places in an answer set program."""

import math
import re
from typing import Any, Dict, Iterator, NamedTuple, Optional, Tuple

from rosoclingo.common.reading import Reader

DEFAULT_FRAME = "map"

_NAME = re.compile(r"(_*[a-z][A-Za-z0-9_']*(\(.+\))?|-?[0-9]+|\(.+\)|\".*\")\Z")


class LabelError(ValueError):
    """An invalid label table; the message lists all faults and how to fix them."""


class UnknownLabelError(KeyError):
    """A term that names no label of the table."""

    def __init__(self, name: str, known: Tuple[str, ...]) -> None:
        super().__init__(name)
        self.name = name
        self.known = known

    def __str__(self) -> str:
        return "no label {}; known labels: {}".format(self.name, ", ".join(self.known) or "none")


class Label(NamedTuple):
    """A named pose: metres and radians (counter-clockwise from the x axis) in the tf frame `frame`.

    `title` is its name for people, empty for none.
    """

    name: str
    x: float
    y: float
    yaw: float = 0.0
    frame: str = DEFAULT_FRAME
    title: str = ""

    @property
    def quaternion(self) -> Tuple[float, float, float, float]:
        """The heading as a unit quaternion (x, y, z, w)."""
        return (0.0, 0.0, math.sin(self.yaw / 2.0), math.cos(self.yaw / 2.0))

    def distance(self, x: float, y: float) -> float:
        """Return the distance in metres from this label to (x, y)."""
        return math.hypot(self.x - x, self.y - y)


class LabelTable:
    """The labels of one world, by name; names are ASP terms as clingo prints them ("office1", "room(1,2)")."""

    def __init__(self, labels: Tuple[Label, ...] = ()) -> None:
        self._labels: Dict[str, Label] = {label.name: label for label in labels}

    @classmethod
    def from_mapping(cls, data: Any) -> "LabelTable":
        """Create a table like ``read``; raises LabelError, which lists all faults."""
        reader = Reader(data, "labels")
        table = cls.read(reader)
        reader.check(LabelError)
        return table

    @classmethod
    def read(cls, reader: Reader, frame: str = DEFAULT_FRAME) -> "LabelTable":
        """Read a mapping like `{name: {x: 1.0, y: 2.0, yaw: 0.0, frame: map, title: hall}}` or `{name: [x, y, yaw]}`.

        `yaw` (0), `frame` and `title` are optional; a frame's leading slash is dropped, as tf2 refuses it.
        The reader collects the faults; the table has only the valid labels.
        """
        found = reader.entries("a mapping of names to {x, y, yaw}")
        return cls(tuple(_label(name, place, bare_frame(frame)) for name, place in found))

    def __getitem__(self, name: object) -> Label:
        """Return the label with this name (a text or symbol); raises UnknownLabelError."""
        text = str(name)
        if text not in self._labels:
            raise UnknownLabelError(text, tuple(self._labels))
        return self._labels[text]

    def __contains__(self, name: object) -> bool:
        return str(name) in self._labels

    def __iter__(self) -> Iterator[Label]:
        return iter(self._labels.values())

    def __len__(self) -> int:
        return len(self._labels)

    @property
    def names(self) -> Tuple[str, ...]:
        """All names, in the table's order."""
        return tuple(self._labels)

    def nearest(self, x: float, y: float, tolerance: float) -> Optional[Label]:
        """Return the label nearest to (x, y) within `tolerance` metres, None if there is none."""
        label = min(self, key=lambda each: each.distance(x, y), default=None)
        return label if label is not None and label.distance(x, y) <= tolerance else None


def bare_frame(frame: str) -> str:
    """Return a tf frame's name without leading slashes, which tf2 refuses."""
    return frame.lstrip("/") or frame


def _label(key: str, reader: Reader, frame: str) -> Label:
    name = re.sub(r"\s*([(),])\s*", r"\1", key.strip())
    if not _NAME.match(name):
        reader.fault("the name is not an ASP term: write it in lower case without spaces, as in the program")
    if isinstance(reader.value, (list, tuple)):
        x, y, yaw = (*reader.numbers((2, 3), wanted="[x, y] or [x, y, yaw] in finite numbers"), 0.0)[:3]
        return Label(name, x, y, yaw, frame)
    x, y, yaw = reader.at("x").number(), reader.at("y").number(), reader.at("yaw").number(0.0)
    frame = bare_frame(reader.at("frame").text(frame, wanted="the name of a tf frame"))
    title = reader.at("title").text("", wanted="a name for people")
    reader.close("{x, y, yaw} or [x, y, yaw]")
    return Label(name, x, y, yaw, frame, title)
