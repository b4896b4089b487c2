"""Fill the fields of a ROS message from evaluated templates, checked against the types of the message.

Needs genpy only.
"""

from typing import Any, Callable, Dict, List, Mapping

import genpy
from clingo import Symbol, SymbolType
from genmsg.msgs import BUILTIN_TYPES, parse_type

from rosoclingo.common.labels import Label, bare_frame
from rosoclingo.interfaces.answers import pattern_of
from rosoclingo.interfaces.templates import Now
from rosoclingo.interfaces.values import TermError, as_boolean, as_integer, as_real, as_text

_FRAMES = ("frame_id", "child_frame_id")


class FieldError(ValueError):
    """Values that do not fit the fields of a message; the text names each field."""


def fill(message: Any, values: Mapping[str, Any], now: genpy.Time, place: str = "goal") -> Any:
    """Set the fields of `message` from `values` (nested mappings) and return it.  Raises FieldError.

    The leading slash of a frame, as in "/map", is dropped: tf2 refuses it.
    """
    filler = _Filler(now, is_template=False)
    filler.fill(message, values, place)
    if filler.faults:
        raise FieldError("\n".join(filler.faults))
    return message


def field_faults(message: Any, template: Mapping[str, Any], place: str = "goal") -> List[str]:
    """Return the faults of a template, independent of the action: unknown fields and values of a wrong type.

    A mapping or a value in place of an array stands for one element.
    """
    filler = _Filler(genpy.Time(), is_template=True)
    filler.fill(message, template, place)
    return filler.faults


def field_types(message: Any) -> Dict[str, str]:
    """Return the fields of a message with their ROS types."""
    return dict(zip(message.__slots__, message._slot_types))


class _Filler:
    """Fills messages and collects the faults; skips texts of a template that depend on the action."""

    def __init__(self, now: genpy.Time, is_template: bool) -> None:
        self.faults: List[str] = []
        self._now, self._is_template = now, is_template

    def fill(self, message: Any, values: Mapping[str, Any], place: str) -> Any:
        types = field_types(message)
        for name, value in values.items():
            where = f"{place}.{name}"
            if name not in types:
                known = ", ".join(message.__slots__)
                self.faults.append(f"{where}: {message._type} has no such field; it has {known}")
                continue
            found = self._value(value, types[name], getattr(message, name), where)
            frame = name in _FRAMES and isinstance(found, str)
            setattr(message, name, bare_frame(found) if frame else found)
        return message

    def _value(self, value: Any, ros_type: str, default: Any, place: str) -> Any:
        """Convert a value to the type of a field; for an invalid value, note a fault and return the default."""
        if self._is_template and isinstance(value, str) and ("$" in value or pattern_of(value) is not None):
            return default
        base, is_array, length = parse_type(ros_type)
        try:
            if is_array:
                return self._array(value, base, length, place)
            if ros_type == "time" and isinstance(value, Now):
                return self._now
            if ros_type in BUILTIN_TYPES:
                return _primitive(value, ros_type)
        except TermError as error:
            self.faults.append(f"{place}: needs {ros_type}, but {error}")
            return default
        if isinstance(value, Label) and ros_type in _POSES:
            value = _POSES[ros_type](value)
        if isinstance(value, Mapping):
            message = default if isinstance(default, genpy.Message) else genpy.message.get_message_class(ros_type)()
            return self.fill(message, value, place)
        fix = "a pose fills " + ", ".join(_POSES) if isinstance(value, Label) else "write a mapping of its fields"
        self.faults.append(f"{place}: {ros_type} cannot be filled from {as_text(value)}: {fix}")
        return default

    def _array(self, value: Any, base: str, length: Any, place: str) -> List[Any]:
        items = _items(value)
        given = [value] if items is None else items
        if length not in (None, len(given)) and not (self._is_template and items is None):
            raise TermError(f"has {len(given)} values")
        places = [place] if items is None else [f"{place}[{index}]" for index in range(len(given))]
        return [self._value(one, base, None, where) for one, where in zip(given, places)]


def _items(value: Any) -> Any:
    """Return the elements of a list or of a tuple of the program, None for any other value."""
    if isinstance(value, (list, tuple)) and not isinstance(value, Label):
        return value
    is_tuple = isinstance(value, Symbol) and value.type == SymbolType.Function and not value.name
    return value.arguments if is_tuple else None


def _primitive(value: Any, ros_type: str) -> Any:
    if isinstance(value, (Label, Now, Mapping, list)):
        raise TermError("has a {}".format(_KINDS.get(type(value), "list")))
    if ros_type in _SCALARS:
        return _SCALARS[ros_type](value)
    number = as_integer(value)
    try:
        genpy.message.check_type(ros_type, ros_type, number)
    except genpy.SerializationError:
        raise TermError(f"{number} is out of its range") from None
    return number


_KINDS: Dict[type, str] = {Label: "pose", Now: "time", dict: "mapping"}

_SCALARS: Dict[str, Callable[[Any], Any]] = {
    "string": as_text,
    "bool": as_boolean,
    "float32": as_real,
    "float64": as_real,
    "duration": lambda value: genpy.Duration.from_sec(as_real(value)),
    "time": lambda value: genpy.Time.from_sec(as_real(value)),
}


def _point(label: Label) -> Mapping[str, Any]:
    return {"x": label.x, "y": label.y}


def _turn(label: Label) -> Mapping[str, Any]:
    return dict(zip("xyzw", label.quaternion))


def _pose(label: Label) -> Mapping[str, Any]:
    return {"position": _point(label), "orientation": _turn(label)}


def _header(label: Label) -> Mapping[str, Any]:
    return {"frame_id": label.frame, "stamp": Now()}


_POSES: Dict[str, Callable[[Label], Mapping[str, Any]]] = {
    "geometry_msgs/Pose": _pose,
    "geometry_msgs/PoseStamped": lambda label: {"header": _header(label), "pose": _pose(label)},
    "geometry_msgs/Pose2D": lambda label: {**_point(label), "theta": label.yaw},
    "geometry_msgs/Point": _point,
    "geometry_msgs/PointStamped": lambda label: {"header": _header(label), "point": _point(label)},
    "geometry_msgs/Quaternion": _turn,
}
