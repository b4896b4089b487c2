"""Labels: named locations on the map, the abstract places that an answer set program reasons about."""

import math
import re
from typing import Any, Dict, Iterator, List, Mapping, NamedTuple, Optional, Tuple

DEFAULT_FRAME = "map"

_NAME = re.compile(r"(_*[a-z][A-Za-z0-9_']*(\(.+\))?|-?[0-9]+|\(.+\)|\".*\")\Z")


class LabelError(ValueError):
    """A label table that cannot be used; the message lists every fault with its mend."""


class UnknownLabelError(KeyError):
    """A term that names no label of the table."""

    def __init__(self, name: str, known: Tuple[str, ...]) -> None:
        super().__init__(name)
        self.name = name
        self.known = known

    def __str__(self) -> str:
        return "no label {}; known labels: {}".format(self.name, ", ".join(self.known) or "none")


class Label(NamedTuple):
    """A pose on the map with a name: metres and radians (counter-clockwise from the x axis) in `frame`."""

    name: str
    x: float
    y: float
    yaw: float = 0.0
    frame: str = DEFAULT_FRAME

    @property
    def quaternion(self) -> Tuple[float, float, float, float]:
        """The heading as a unit quaternion (x, y, z, w)."""
        return (0.0, 0.0, math.sin(self.yaw / 2.0), math.cos(self.yaw / 2.0))

    def distance(self, x: float, y: float) -> float:
        """Distance in metres from this label to (x, y)."""
        return math.hypot(self.x - x, self.y - y)


class LabelTable:
    """The labels of one world, by name; names are ASP terms as clingo prints them ("office1", "room(1,2)")."""

    def __init__(self, labels: Tuple[Label, ...] = ()) -> None:
        self._labels: Dict[str, Label] = {label.name: label for label in labels}

    @classmethod
    def from_mapping(cls, data: Any, frame: str = DEFAULT_FRAME) -> "LabelTable":
        """Read `{name: {x: 1.0, y: 2.0, yaw: 0.0, frame: map}}` or `{name: [x, y, yaw]}`, as a YAML file holds it.

        `yaw` (0) and `frame` may be left out.  Raises LabelError listing all faults.
        """
        if not isinstance(data, Mapping):
            raise LabelError(f"labels must be a mapping of names to {{x, y, yaw}}, not {data!r}")
        labels: List[Label] = []
        faults: List[str] = []
        for key, value in data.items():
            try:
                labels.append(_read_label(key, value, frame))
            except LabelError as error:
                faults.append(str(error))
        if faults:
            raise LabelError("; ".join(faults))
        return cls(tuple(labels))

    def __getitem__(self, name: object) -> Label:
        """The label of that name (text, or anything that prints as the term); raises UnknownLabelError."""
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

    def nearest(self, x: float, y: float, tolerance: float) -> Optional[Label]:
        """The label nearest to (x, y) that is at most `tolerance` metres away, else None."""
        label = min(self, key=lambda each: each.distance(x, y), default=None)
        return label if label is not None and label.distance(x, y) <= tolerance else None


def _read_label(key: Any, value: Any, frame: str) -> Label:
    name = _read_name(key)
    if isinstance(value, Mapping):
        unknown = sorted(str(field) for field in value if field not in ("x", "y", "yaw", "frame"))
        if unknown:
            raise LabelError("label {}: unknown field {}; fields are x, y, yaw, frame".format(name, ", ".join(unknown)))
        missing = [field for field in ("x", "y") if field not in value]
        if missing:
            raise LabelError("label {}: {} is missing".format(name, " and ".join(missing)))
        numbers = [value["x"], value["y"], value.get("yaw", 0.0)]
        frame = _read_frame(name, value.get("frame", frame))
    elif isinstance(value, (list, tuple)) and len(value) in (2, 3):
        numbers = [*value, 0.0]  # a yaw that is given comes before
    else:
        raise LabelError(f"label {name}: expected {{x, y, yaw}} or [x, y, yaw], not {value!r}")
    x, y, yaw = (_read_number(name, field, number) for field, number in zip(("x", "y", "yaw"), numbers))
    return Label(name, x, y, yaw, frame)


def _read_name(key: Any) -> str:
    name = re.sub(r"\s*([(),])\s*", r"\1", str(key).strip())
    if not _NAME.match(name):
        raise LabelError(
            f"label {str(key)!r} is no ASP term: write it in lower case without spaces, as the program does"
        )
    return name


def _read_frame(name: str, frame: Any) -> str:
    if not isinstance(frame, str) or not frame:
        raise LabelError(f"label {name}: frame must be the name of a tf frame, not {frame!r}")
    return frame


def _read_number(name: str, field: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
        raise LabelError(f"label {name}: {field} must be a finite number, not {value!r}")
    return float(value)
