"""Standard streams that accept any text in any locale, and survive a full disk if a launch writes them to a file."""

import io
import os
import sys
from contextlib import suppress
from typing import Any

__all__ = ["LenientStream", "print_utf8", "tolerate_any_locale", "tolerate_full_disk"]

_UTF8 = "utf-8"


def tolerate_any_locale() -> None:
    """Have this process print any text, and read standard input as UTF-8, in any locale.

    Characters that the encoding of standard output lacks are printed as ``?``.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors in ("strict", "surrogateescape"):
            stream.reconfigure(errors="replace")
    if isinstance(sys.stdin, io.TextIOWrapper):
        with suppress(OSError, ValueError):  # some input has been read already
            sys.stdin.reconfigure(encoding=_UTF8, errors="replace")
    sys.argv = [_encodable(argument) for argument in sys.argv]


def print_utf8() -> None:
    """Write standard output in UTF-8, for a command that prints a program, which is a UTF-8 text."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding=_UTF8)


def _encodable(argument: str) -> str:
    """Return an argument without bytes that are no text; the name of an existing file stays as it is."""
    return argument if os.path.exists(argument) else argument.encode(_UTF8, "replace").decode(_UTF8)


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
    import logging  # noqa: PLC0415 commands without a log do not load it

    logging.raiseExceptions = False
    sys.stdout, sys.stderr = LenientStream(sys.stdout), LenientStream(sys.stderr)  # type: ignore[assignment]
