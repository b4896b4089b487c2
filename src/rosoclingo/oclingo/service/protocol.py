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
    return item(f"Warning: {_one_line(text)}\n")


def error(text: str) -> bytes:
    """Encode an error, followed by ``Input:``."""
    return item(f"Error: {_one_line(text)}") + INPUT


def _one_line(text: str) -> str:
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


def read_updates(text: str) -> Iterator[Request]:
    """Yield the updates of a text up to the first error, then the error; the rest is dropped."""
    try:
        yield from iterate_updates(text)
    except ProgressionError as fault:
        yield fault


def requests(message: Message) -> Iterator[Request]:
    """Yield the updates of a message up to the first error, then the error; a message without an update is an error."""
    if isinstance(message, ProgressionError):
        yield message
        return
    found = read_updates(message)
    yield next(found, ProgressionError(1, 1, "a message without an update; end each update with '#endstep.'"))
    yield from found


class MessageBuffer:
    """Splits the bytes from a client into messages."""

    def __init__(self) -> None:
        self._data = bytearray()
        self._is_skipping = False  # the rest of an oversized message

    def add(self, data: bytes) -> Iterator[Message]:
        """Append ``data`` and yield the messages that are now complete or too long."""
        pieces = data.split(END)
        for number, piece in enumerate(pieces, 1):
            is_end = number < len(pieces)
            if not self._is_skipping:
                self._data += piece
                self._is_skipping = len(self._data) >= MESSAGE_LIMIT
                if self._is_skipping:
                    text = f"a message of {MESSAGE_LIMIT} bytes or more; send it in several updates"
                    yield ProgressionError(1, 1, text)
                elif is_end:
                    yield _decoded(self._data)
            if is_end or self._is_skipping:
                self._data.clear()
            self._is_skipping = self._is_skipping and not is_end


def _decoded(data: bytearray) -> Message:
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError as fault:
        before = data[: fault.start].decode("utf-8")
        line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
        return ProgressionError(line, column, f"not UTF-8: byte 0x{data[fault.start]:02x}, {fault.reason}")
