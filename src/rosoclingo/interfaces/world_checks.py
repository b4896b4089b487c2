"""Looking at a message of the robot's for what an action was to bring about.  Needs genpy only."""

import contextlib
from typing import Any, List, Mapping, Optional

import genpy

from rosoclingo.common.labels import UnknownLabelError
from rosoclingo.interfaces.answers import equal
from rosoclingo.interfaces.message_filling import field_types, no_field
from rosoclingo.interfaces.templates import FillError, Scope, evaluate
from rosoclingo.interfaces.values import TermError, as_real, as_text


def holds(message: Any, wanted: Mapping[str, Any], scope: Scope) -> Optional[bool]:
    """Whether a message has these fields, templates filled for the action; None where they cannot be filled.

    Of a field that is an array one element has to be as wanted.
    """
    try:
        return _is_as(message, evaluate(wanted, scope))
    except (FillError, UnknownLabelError):
        return None


def _is_as(value: Any, wanted: Any) -> bool:
    if isinstance(value, (list, tuple, bytes)):
        return any(_is_as(one, wanted) for one in value)
    if isinstance(wanted, Mapping):
        return all(_is_as(getattr(value, name, None), each) for name, each in wanted.items())
    if isinstance(value, float):
        with contextlib.suppress(TermError):
            return value == as_real(wanted)
    return equal(value, wanted) or as_text(value) == as_text(wanted)


def check_faults(message: Any, wanted: Mapping[str, Any], place: str) -> List[str]:
    """The fields of a check that the message type lacks, each with its place."""
    types, faults = field_types(message), []
    for name, value in wanted.items():
        where = f"{place}.{name}"
        kind = types.get(name, "").partition("[")[0]
        if name not in types:
            faults.append(no_field(message, where))
        elif "/" not in kind and isinstance(value, Mapping):
            faults.append(f"{where}: a field of type {types[name]} takes no mapping")
        elif "/" in kind and not isinstance(value, Mapping):
            faults.append(f"{where}: a field of type {types[name]} takes a mapping of its fields")
        elif "/" in kind:
            inside = genpy.message.get_message_class(kind)
            faults += check_faults(inside(), value, where) if inside is not None else []
    return faults
