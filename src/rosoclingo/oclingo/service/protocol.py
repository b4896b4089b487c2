"""oClingo's wire protocol, without sockets: items in both directions end in a NUL byte.

The client sends the text of updates. For each update the server sends ``Input:`` (the next one may come), its
warnings, its answers, and one item that ends it: ``End of Step.``, ``UNSAT at step N`` or ``Error: text``. After an
error ``Input:`` is said once more.
"""

from typing import Iterator, List, Optional, Union

from rosoclingo.oclingo.errors import ProgressionError
from rosoclingo.oclingo.progression.parser import iterate_updates
from rosoclingo.oclingo.progression.updates import StreamUpdate
from rosoclingo.oclingo.solving.results import SolveOutcome, SolveResult

DEFAULT_PORT = 25277
"""The port that oClingo listened on."""

MESSAGE_LIMIT = 1_000_000
"""Bytes that a message may have; what has no end by then is dropped."""

END = b"\0"


def item(text: str) -> bytes:
    """Return ``text`` as one item."""
    return text.replace("\0", " ").encode("utf-8", "replace") + END


INPUT = item("Input:\n")
END_OF_STEP = item("End of Step.\n")
GREETING = INPUT + END_OF_STEP
"""What a client is sent when it has connected."""


def warning(text: str) -> bytes:
    """Return a warning."""
    return item(f"Warning: {one_line(text)}\n")


def error(text: str) -> bytes:
    """Return an error, and that input is welcome again."""
    return item(f"Error: {one_line(text)}") + INPUT


def one_line(text: str) -> str:
    """Return ``text`` on one line: oClingo's client reads line by line."""
    return "; ".join(line.strip() for line in text.splitlines() if line.strip())


def reply(result: SolveResult) -> Iterator[bytes]:
    """Yield what a client is sent for ``result``; warnings first, since oClingo's client gives up answers at one."""
    for text in result.warnings:
        yield warning(text)
    for answer in result.answers:
        yield item(f"Step: {result.horizon}\n" + "".join(f"{atom} " for atom in answer))
    yield item(f"UNSAT at step {result.horizon}") if result.outcome is SolveOutcome.UNSATISFIABLE else END_OF_STEP


Message = Union[str, ProgressionError]
"""A message from a client: its text, or why there is none."""

Request = Union[StreamUpdate, ProgressionError]
"""An update, or what is wrong with it."""


def requests(message: Message) -> Iterator[Request]:
    """Yield the updates of a message; a fault is yielded in its turn, the rest of the message dropped."""
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
        yield ProgressionError(1, 1, "a message without an update; write one that ends with '#endstep.'")


class Inbox:
    """Assembles a client's messages from the bytes that come in."""

    def __init__(self) -> None:
        self._unfinished = bytearray()
        self._skipping = False

    def feed(self, data: bytes) -> List[Message]:
        """Take ``data`` and return the messages that are complete by now, or dropped."""
        *complete, rest = data.split(END)
        taken = [self._take(piece, ends=True) for piece in complete] + [self._take(rest, ends=False)]
        return [message for message in taken if message is not None]

    def _take(self, piece: bytes, ends: bool) -> Optional[Message]:
        """Take a piece without NUL; ``ends`` tells that one follows it."""
        if self._skipping:
            self._skipping = not ends
            return None
        self._unfinished += piece
        if len(self._unfinished) >= MESSAGE_LIMIT:
            self._skipping = not ends
            self._unfinished.clear()
            return ProgressionError(1, 1, f"a message of {MESSAGE_LIMIT} bytes or more; send it in several updates")
        return self._finish() if ends else None

    def _finish(self) -> Message:
        data = bytes(self._unfinished)
        self._unfinished.clear()
        try:
            return data.decode("utf-8")
        except UnicodeDecodeError as fault:
            before = data[: fault.start].decode("utf-8")
            line, column = before.count("\n") + 1, len(before) - before.rfind("\n")
            text = f"no UTF-8 text: byte 0x{data[fault.start]:02x}, {fault.reason}"
            return ProgressionError(line, column, text)
