"""Filling the fields of a ROS message from evaluated templates, checked against the message's own types.

Needs genpy only: messages are walked by their slots.
"""

import copy
import re
from typing import Any, Callable, Dict, List, Mapping, Tuple

import genpy
from clingo import Symbol, SymbolType

from rosoclingo.common.labels import Label, bare_frame
from rosoclingo.interfaces.templates import Now
from rosoclingo.interfaces.values import TermError, as_boolean, as_integer, as_real, as_text

_INTEGERS: Dict[str, Tuple[int, int]] = {"byte": (-128, 127), "char": (0, 255)}
for _bits in (8, 16, 32, 64):
    _INTEGERS[f"uint{_bits}"] = (0, 2**_bits - 1)
    _INTEGERS[f"int{_bits}"] = (-(2 ** (_bits - 1)), 2 ** (_bits - 1) - 1)

_FRAMES = ("frame_id", "child_frame_id")

_ARRAY = re.compile(r"(.*)\[([0-9]*)\]\Z")


class FieldError(ValueError):
    """A value that does not fit the field of the message; the message names the field."""


def fill(message: Any, values: Mapping[str, Any], now: genpy.Time, place: str = "goal") -> Any:
    """Set the fields of `message` from `values` (nested mappings) and return it.  Raises FieldError.

    The leading slash of a frame, as in "/map", is dropped: tf2 refuses it.
    """
    types = field_types(message)
    for name, value in values.items():
        where = f"{place}.{name}"
        if name not in types:
            raise FieldError("{}: {} has no such field; it has {}".format(where, message._type, ", ".join(types)))
        converted = _convert(value, types[name], getattr(message, name), now, where)
        setattr(message, name, bare_frame(converted) if name in _FRAMES and types[name] == "string" else converted)
    return message


def field_faults(message: Any, template: Mapping[str, Any], place: str = "goal") -> List[str]:
    """What is wrong with a template whatever is filled in: fields that the type lacks, values that fit no action."""
    types, faults = field_types(message), []
    for name, value in template.items():
        where = f"{place}.{name}"
        if name not in types:
            faults.append("{}: {} has no such field; it has {}".format(where, message._type, ", ".join(types)))
        elif not isinstance(value, Mapping):
            faults += _literal_faults(value, types[name], getattr(message, name), where)
        elif not isinstance(getattr(message, name), genpy.Message):
            faults.append(f"{where}: a field of type {types[name]} takes no mapping")
        else:
            faults += field_faults(getattr(message, name), value, where)
    return faults


def _literal_faults(value: Any, ros_type: str, current: Any, place: str) -> List[str]:
    """The fault of a value without references, if it does not fit its field."""
    texts = value if isinstance(value, (list, tuple)) else [value]
    if any(isinstance(text, (list, tuple, Mapping)) or (isinstance(text, str) and "$" in text) for text in texts):
        return []
    try:
        _convert(value, ros_type, copy.deepcopy(current), genpy.Time(), place)
    except FieldError as error:
        return [str(error)]
    return []


def field_types(message: Any) -> Dict[str, str]:
    """The fields of a message with their ROS types."""
    return dict(zip(message.__slots__, message._slot_types))


def _convert(value: Any, ros_type: str, current: Any, now: genpy.Time, place: str) -> Any:
    array = _ARRAY.match(ros_type)
    try:
        if array:
            return _convert_array(value, array.group(1), array.group(2), now, place)
        if ros_type in _SCALARS:
            _refuse_structure(value)
            return _SCALARS[ros_type](value)
        if ros_type in _INTEGERS:
            return _integer_in(value, *_INTEGERS[ros_type])
        if ros_type == "time":
            return now if isinstance(value, Now) else genpy.Time.from_sec(as_real(value))
    except TermError as error:
        raise FieldError(f"{place}: {ros_type} is wanted, but {error}") from error
    if isinstance(value, Label):
        value = _label_fields(value, ros_type, place)
    if not isinstance(value, Mapping):
        raise FieldError(f"{place}: {ros_type} cannot be filled from {as_text(value)}")
    return fill(current, value, now, place)


def _convert_array(value: Any, ros_type: str, length: str, now: genpy.Time, place: str) -> List[Any]:
    items = _items(value)
    if length and len(items) != int(length):
        raise FieldError(f"{place}: {length} values are wanted, not {len(items)}")
    return [_convert(item, ros_type, _empty(ros_type), now, f"{place}[{index}]") for index, item in enumerate(items)]


def _items(value: Any) -> List[Any]:
    if isinstance(value, (list, tuple)) and not isinstance(value, Label):
        return list(value)
    if isinstance(value, Symbol) and value.type == SymbolType.Function and not value.name:
        return list(value.arguments)
    return [value]


def _empty(ros_type: str) -> Any:
    message_class = genpy.message.get_message_class(ros_type) if "/" in ros_type else None
    return message_class() if message_class is not None else None


def _refuse_structure(value: Any) -> None:
    if isinstance(value, (Label, Now, Mapping, list)):
        raise TermError("it was given a {}".format(_KINDS.get(type(value), "list")))


def _integer_in(value: Any, least: int, greatest: int) -> int:
    number = as_integer(value)
    if not least <= number <= greatest:
        raise TermError(f"{number} is not between {least} and {greatest}")
    return number


_KINDS: Dict[type, str] = {Label: "pose", Now: "time", dict: "mapping"}

_SCALARS: Dict[str, Callable[[Any], Any]] = {
    "string": as_text,
    "bool": as_boolean,
    "float32": as_real,
    "float64": as_real,
    "duration": lambda value: genpy.Duration.from_sec(as_real(value)),
}


def _label_fields(label: Label, ros_type: str, place: str) -> Mapping[str, Any]:
    if ros_type not in _POSES:
        raise FieldError("{}: a pose fills {}, not {}".format(place, ", ".join(_POSES), ros_type))
    return _POSES[ros_type](label)


def _pose(label: Label) -> Dict[str, Any]:
    return {
        "position": {"x": label.x, "y": label.y},
        "orientation": dict(zip("xyzw", label.quaternion)),
    }


def _stamped(field: str, inside: Callable[[Label], Mapping[str, Any]]) -> Callable[[Label], Mapping[str, Any]]:
    return lambda label: {"header": {"frame_id": label.frame, "stamp": Now()}, field: inside(label)}


_POSES: Dict[str, Callable[[Label], Mapping[str, Any]]] = {
    "geometry_msgs/Pose": _pose,
    "geometry_msgs/PoseStamped": _stamped("pose", _pose),
    "geometry_msgs/Pose2D": lambda label: {"x": label.x, "y": label.y, "theta": label.yaw},
    "geometry_msgs/Point": lambda label: {"x": label.x, "y": label.y},
    "geometry_msgs/PointStamped": _stamped("point", lambda label: {"x": label.x, "y": label.y}),
    "geometry_msgs/Quaternion": lambda label: dict(zip("xyzw", label.quaternion)),
}
