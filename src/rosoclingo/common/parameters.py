"""Reading a node's parameters, with an error that names the parameter."""

import math
from typing import Any

import rospy

from rosoclingo.common.private_parameters import read_parameter

_WORDS = {
    bool: "true or false",
    int: "a whole number",
    float: "a number",
    str: "a text",
    dict: "a mapping",
    list: "a list",
}


class ParameterError(ValueError):
    """A parameter that the node cannot work with; the message names it and says what it has to be."""


def parameter(name: str, kind: type, default: Any = None) -> Any:
    """The value of a ROS parameter, or `default`; raises ParameterError if it is missing or not of that kind."""
    value = read_parameter(name, default)
    if value is None:
        mend = f"give it in the launch file, or on the command line as {name.replace('~', '_', 1)}:=..."
        raise ParameterError(f"parameter {rospy.resolve_name(name)} is not set; {mend}")
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        value = float(value)
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        raise ParameterError(f"parameter {rospy.resolve_name(name)} must be {_WORDS[kind]}, not {value!r}")
    return value


def finite(name: str, default: float) -> float:
    """The value of a ROS parameter that is a finite number; raises ParameterError."""
    value = float(parameter(name, float, default))
    if not math.isfinite(value):
        raise ParameterError(f"parameter {rospy.resolve_name(name)} must be a finite number, not {value!r}")
    return value


def not_negative(name: str, default: float) -> float:
    """The value of a ROS parameter that is a finite number from 0 on; raises ParameterError."""
    value = float(parameter(name, float, default))
    if not 0.0 <= value < float("inf"):
        raise ParameterError(f"parameter {rospy.resolve_name(name)} must be a number from 0 on, not {value!r}")
    return value
