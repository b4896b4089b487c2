"""Filling the fields of a ROS message from evaluated templates, checked against the message's own types.

Needs genpy only: messages are walked by their slots.
"""

from typing import Any, Callable, Dict, Iterator, List, Mapping

import genpy
from clingo import Symbol, SymbolType
from genmsg.msgs import BUILTIN_TYPES, parse_type

from rosoclingo.common.labels import Label, bare_frame
from rosoclingo.interfaces.templates import Now, texts_in
from rosoclingo.interfaces.values import TermError, as_boolean, as_integer, as_real, as_text

_FRAMES = ("frame_id", "child_frame_id")


class FieldError(ValueError):
    """Values that do not fit the fields of the message; the message names each field."""


def fill(message: Any, values: Mapping[str, Any], now: genpy.Time, place: str = "goal") -> Any:
    """Set the fields of `message` from `values` (nested mappings) and return it.  Raises FieldError.

    The leading slash of a frame, as in "/map", is dropped: tf2 refuses it.
    """
    faults = list(_set_fields(message, values, now, place))
    if faults:
        raise FieldError("\n".join(faults))
    return message


def field_faults(message: Any, template: Mapping[str, Any], place: str = "goal") -> List[str]:
    """What is wrong with a template whatever is filled in: fields that the type lacks, values that fit no action."""
    return list(_set_fields(message, template, genpy.Time(), place, template=True))


def _set_fields(
    message: Any, values: Mapping[str, Any], now: genpy.Time, place: str, template: bool = False
) -> Iterator[str]:
    """Set the fields and yield their faults; of a ``template`` skip values with references."""
    types = field_types(message)
    for name, value in values.items():
        where = f"{place}.{name}"
        if name not in types:
            yield no_field(message, where)
        elif isinstance(value, Mapping) and isinstance(getattr(message, name), genpy.Message):
            yield from _set_fields(getattr(message, name), value, now, where, template)
        elif not (template and any("$" in text for _, text in texts_in(value))):
            try:
                converted = _convert(value, types[name], now, where)
            except FieldError as error:
                yield str(error)
            else:
                frame = name in _FRAMES and types[name] == "string"
                setattr(message, name, bare_frame(converted) if frame else converted)


def no_field(message: Any, place: str) -> str:
    """Return the fault that a message type lacks the field at this place."""
    return "{}: {} has no such field; it has {}".format(place, message._type, ", ".join(message.__slots__))


def field_types(message: Any) -> Dict[str, str]:
    """The fields of a message with their ROS types."""
    return dict(zip(message.__slots__, message._slot_types))


def _convert(value: Any, ros_type: str, now: genpy.Time, place: str) -> Any:
    base, is_array, length = parse_type(ros_type)
    if is_array:
        items = _items(value)
        if length is not None and len(items) != length:
            raise FieldError(f"{place}: {length} values are wanted, not {len(items)}")
        return [_convert(item, base, now, f"{place}[{index}]") for index, item in enumerate(items)]
    try:
        if ros_type == "time" and isinstance(value, Now):
            return now
        if ros_type in BUILTIN_TYPES:
            return _primitive(value, ros_type)
    except TermError as error:
        raise FieldError(f"{place}: {ros_type} is wanted, but {error}") from error
    if isinstance(value, Label):
        value = _label_fields(value, ros_type, place)
    if not isinstance(value, Mapping):
        raise FieldError(f"{place}: {ros_type} cannot be filled from {as_text(value)}")
    return fill(genpy.message.get_message_class(ros_type)(), value, now, place)


def _items(value: Any) -> List[Any]:
    if isinstance(value, (list, tuple)) and not isinstance(value, Label):
        return list(value)
    if isinstance(value, Symbol) and value.type == SymbolType.Function and not value.name:
        return list(value.arguments)
    return [value]


def _primitive(value: Any, ros_type: str) -> Any:
    if isinstance(value, (Label, Now, Mapping, list)):
        raise TermError("it was given a {}".format(_KINDS.get(type(value), "list")))
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
