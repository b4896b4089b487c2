"""oClingo's wire protocol, without sockets: items in both directions end in a NUL byte.

The client sends the text of updates. For each update the server sends ``Input:`` (ready for the next update), the
warnings, the answers, and a final item: ``End of Step.``, ``UNSAT at step N`` or ``Error: text``. After an error it
sends ``Input:`` once more.
"""

from typing import Iterator, Union

from rosoclingo.oclingo.errors import ProgressionError
from rosoclingo.oclingo.progression.parser import iterate_updates
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult

DEFAULT_PORT = 25277
"""The port that oClingo listened on."""

MESSAGE_LIMIT = 1_000_000
"""Size limit in bytes; a message that reaches it is dropped."""

END = b"\0"


def item(text: str) -> bytes:
    """Encode ``text`` as one item."""
    return text.replace("\0", " ").encode("utf-8", "replace") + END


INPUT = item("Input:\n")
END_OF_STEP = item("End of Step.\n")
GREETING = INPUT + END_OF_STEP
"""The items that each new client receives."""


def warning(text: str) -> bytes:
    """Encode a warning."""
    return item(f"Warning: {one_line(text)}\n")


def error(text: str) -> bytes:
    """Encode an error, followed by ``Input:``."""
    return item(f"Error: {one_line(text)}") + INPUT


def one_line(text: str) -> str:
    """Return ``text`` on one line: oClingo's client reads line by line."""
    return "; ".join(line.strip() for line in text.splitlines() if line.strip())


def reply(result: SolveResult) -> Iterator[bytes]:
    """Yield the items of ``result``, warnings first: oClingo's client discards the answers before a warning."""
    for text in result.warnings:
        yield warning(text)
    for answer in result.answers:
        yield item(f"Step: {result.horizon}\n" + "".join(f"{atom} " for atom in answer))
    yield item(f"UNSAT at step {result.horizon}") if result.outcome is SolveOutcome.UNSATISFIABLE else END_OF_STEP


Message = Union[str, ProgressionError]
"""The text of a client's message, or an error if it is too long or not UTF-8."""

Request = Union[StreamUpdate, ProgressionError]
"""An update, or its error."""


def requests(message: Message) -> Iterator[Request]:
    """Yield the updates of a message up to the first error, then the error; the rest is dropped."""
    if isinstance(message, ProgressionError):
        yield message
        return
    empty = True
    try:
        for update in iterate_updates(message):
            empty = False
            yield update
    except ProgressionError as fault:
        yield fault
        return
    if empty:
        yield ProgressionError(1, 1, "a message without an update; end each update with '#endstep.'")


class MessageBuffer:
    """Splits the bytes from a client into messages."""

    def __init__(self) -> None:
        self._data = bytearray()
        self._is_skipping = False  # the rest of an oversized message

    def add(self, data: bytes) -> Iterator[Message]:
        """Append ``data`` and yield the messages that are now complete or too long."""
        *ended, rest = data.split(END)
        for piece in ended:
            self._data += piece
            if not self._is_skipping:
                yield _decoded(self._data) if len(self._data) < MESSAGE_LIMIT else _too_long()
            self._data.clear()
            self._is_skipping = False
        if not self._is_skipping:
            self._data += rest
        if len(self._data) >= MESSAGE_LIMIT:
            self._data.clear()
            self._is_skipping = True
            yield _too_long()


def _too_long() -> ProgressionError:
    return ProgressionError(1, 1, f"a message of {MESSAGE_LIMIT} bytes or more; send it in several updates")


def _decoded(data: bytearray) -> Message:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as fault:
        before = data[: fault.start].decode("utf-8")
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        return ProgressionError(line, column, f"not UTF-8: byte 0x{data[fault.start]:02x}, {fault.reason}")
