"""clingo's messages as faults: file, line, what is wrong and, for the common ones, what to write instead."""

import re
from typing import List, Tuple

import clingo

from rosoclingo.oclingo.errors import Fault

_MESSAGE = re.compile(
    r"(?P<file>.+?):(?P<line>[0-9]+):(?P<column>[0-9]+)(?:-[0-9:]+)?: (?P<kind>[a-z]+): (?P<text>.*)", re.S
)
_NOTE = re.compile(r"\n?[^\n]*: note: '(?P<variable>[^']*)' is unsafe")


class Messages:
    """Collects what clingo says while it parses, grounds or solves; pass :meth:`log` as its logger."""

    def __init__(self) -> None:
        self._said: List[Tuple[clingo.MessageCode, str]] = []

    def log(self, code: clingo.MessageCode, text: str) -> None:
        """Take a message."""
        self._said.append((code, text.strip()))

    def clear(self) -> None:
        """Forget all messages."""
        self._said.clear()

    def text(self) -> str:
        """Return all messages as one text."""
        return "\n".join(text for _, text in self._said)

    def faults(self, error: RuntimeError) -> List[Fault]:
        """Return the errors among the messages; where there is none what ``error`` itself says, then all messages."""
        errors = [text for code, text in self._said if code == clingo.MessageCode.RuntimeError]
        return [_fault(text) for text in errors or [str(error).strip(), *(text for _, text in self._said)]]


def _fault(text: str) -> Fault:
    match = _MESSAGE.match(text)
    if match is None:
        return Fault("<program>", 0, 0, text)
    message = match.group("text").strip()
    mend = ""
    variables = sorted({note.group("variable") for note in _NOTE.finditer(message)})
    if variables:
        rule = _NOTE.sub("", message).split("\n", 1)[-1].strip().replace(":-[#inc_base];", ":- ")
        message = "unsafe variable{} {} in {}".format("s" * (len(variables) > 1), ", ".join(variables), rule)
        mend = "bind each variable by a positive body literal, for instance a domain like office(X)"
    return Fault(match.group("file"), int(match.group("line")), int(match.group("column")), message, mend)
