"""Watch a topic for a message that shows the effect of an action."""

import contextlib
import functools
from typing import Any, Mapping, Optional

import rospy

from rosoclingo.common.connections import is_connected
from rosoclingo.common.labels import UnknownLabelError
from rosoclingo.interfaces.answers import equal
from rosoclingo.interfaces.templates import ActionScope, FillError, evaluate
from rosoclingo.interfaces.values import TermError, as_real, as_text


class Watch:
    """Caches the last message of a topic while its publisher is connected: a dead node's message can be outdated."""

    def __init__(self, topic: str, kind: type) -> None:
        self._last: Any = None
        self._subscriber = rospy.Subscriber(topic, kind, self._note)

    def _note(self, message: Any) -> None:
        self._last = message

    def shows(self, wanted: Mapping[str, Any], scope: ActionScope) -> Optional[bool]:
        """Return whether the last message has these fields, see :func:`holds`; None without a message."""
        message = self._last
        if message is None or not is_connected(self._subscriber, message._connection_header):
            return None
        return holds(message, wanted, scope)


@functools.lru_cache(maxsize=None)
def watch(topic: str, kind: type) -> Watch:
    """Return the watch of a topic, shared by the process: rospy delivers a latched message once per process."""
    return Watch(topic, kind)


def holds(message: Any, wanted: Mapping[str, Any], scope: ActionScope) -> Optional[bool]:
    """Return whether a message has these fields, with templates filled for the action; None if one cannot be filled.

    Of an array, one element has to match.
    """
    try:
        return _matches(message, evaluate(wanted, scope))
    except (FillError, UnknownLabelError):
        return None


def _matches(value: Any, wanted: Any) -> bool:
    if isinstance(value, (list, tuple, bytes)):
        return any(_matches(one, wanted) for one in value)
    if isinstance(wanted, Mapping):
        return all(_matches(getattr(value, name, None), each) for name, each in wanted.items())
    if isinstance(value, float):
        with contextlib.suppress(TermError):
            return value == as_real(wanted)
    return equal(value, wanted) or as_text(value) == as_text(wanted)
