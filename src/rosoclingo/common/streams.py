"""Standard streams that accept any text in any locale, and survive a full disk."""

import io
import os
import sys
from contextlib import suppress
from typing import Any

_UTF8 = "utf-8"


def tolerate_any_locale() -> None:
    """Make this process print any text, and read standard input as UTF-8, in any locale.

    Characters that the encoding of standard output lacks are printed as ``?``.
    """
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and stream.errors in ("strict", "surrogateescape"):
            stream.reconfigure(errors="replace")
    if isinstance(sys.stdin, io.TextIOWrapper):
        with suppress(OSError, ValueError):  # some input has already been read
            sys.stdin.reconfigure(encoding=_UTF8, errors="replace")
    sys.argv = [_encodable(argument) for argument in sys.argv]


def print_utf8() -> None:
    """Write standard output in UTF-8, for commands that print a program, which is UTF-8."""
    if isinstance(sys.stdout, io.TextIOWrapper):
        sys.stdout.reconfigure(encoding=_UTF8)


def _encodable(argument: str) -> str:
    """Return an argument without invalid bytes; the name of an existing file is unchanged."""
    return argument if os.path.exists(argument) else argument.encode(_UTF8, "replace").decode(_UTF8)


class LenientStream:
    """A text stream that drops text it cannot write, and resumes as soon as there is space."""

    def __init__(self, stream: Any) -> None:
        self._stream = stream

    def write(self, text: str) -> int:
        """Write a text, or drop it; return its length."""
        with suppress(OSError):
            self._stream.write(text)
        return len(text)

    def flush(self) -> None:
        """Flush the stream, if possible."""
        with suppress(OSError):
            self._stream.flush()

    def __getattr__(self, name: str) -> Any:
        return getattr(self._stream, name)


def tolerate_full_disk() -> None:
    """Keep log messages from failing on a full disk: rospy's log raises errors of standard error.

    Logging also stops printing a traceback for each message that it cannot write.
    """
    import logging  # noqa: PLC0415 commands without a log do not load it

    logging.raiseExceptions = False
    sys.stdout, sys.stderr = LenientStream(sys.stdout), LenientStream(sys.stderr)  # type: ignore[assignment]
