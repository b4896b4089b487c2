"""Standard output and error on a full disk, where a launch writes them to a file: what is said there may get lost."""

import logging
import sys
from contextlib import suppress
from typing import Any

__all__ = ["LenientStream", "tolerate_full_disk"]


class LenientStream:
    """A text stream that loses what cannot be written; later text is written again as soon as there is room."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write a text, or lose it; returns its length."""
        with suppress(OSError):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Write what has not been written yet, if that is possible."""
        with suppress(OSError):
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def tolerate_full_disk() -> None:
    """Have no message of this process fail: rospy's log raises what its writing to standard error raises.

    Nor does logging show a traceback for each message that its file does not take.
    """
    logging.raiseExceptions = False
    sys.stdout, sys.stderr = LenientStream(sys.stdout), LenientStream(sys.stderr)  # type: ignore[assignment]
