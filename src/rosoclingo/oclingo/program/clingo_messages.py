"""Conversion of clingo's messages into faults, with a proposed fix for common ones."""

import re
from dataclasses import dataclass, field
from typing import Callable, List, Tuple

import clingo

from rosoclingo.oclingo.errors import Fault

_MESSAGE = re.compile(
    r"(?P<file>.+?):(?P<line>[0-9]+):(?P<column>[0-9]+)(?:-[0-9:]+)?: (?P<kind>[a-z]+): (?P<text>.*)", re.S
)
_NOTE = re.compile(r"\n?[^\n]*: note: '(?P<variable>[^']*)' is unsafe")
_SCRIPT = re.compile(r"\w+ support not available")
_WARNINGS = (clingo.MessageCode.OperationUndefined, clingo.MessageCode.GlobalVariable, clingo.MessageCode.Other)
_ANONYMOUS = re.compile(r"\bAny__[0-9]+\b")

ParameterAt = Callable[[str, int], str]
"""Returns the step parameter of the program part at a file and line."""

StatementAt = Callable[[str, int, int], str]
"""Returns the source text of the statement at a file, line and column, or an empty string."""


@dataclass
class Messages:
    """Collects clingo's messages while it parses, grounds or solves; pass :meth:`log` as its logger.

    Attributes:
        received: the messages, each with its code.
        reported: the number of messages that :meth:`new_remarks` has processed.

    """

    received: List[Tuple[clingo.MessageCode, str]] = field(default_factory=list)
    reported: int = 0

    def log(self, code: clingo.MessageCode, text: str) -> None:
        """Record a message."""
        self.received.append((code, text.strip()))

    def faults(
        self,
        error: RuntimeError,
        parameter_at: ParameterAt = lambda file, line: "t",
        statement_at: StatementAt = lambda file, line, column: "",
    ) -> List[Fault]:
        """Return the errors among the messages; without any, the text of ``error`` and all messages."""
        errors = [text for code, text in self.received if code == clingo.MessageCode.RuntimeError]
        found = errors or [str(error).strip(), *(text for _, text in self.received)]
        return [_fault(text, parameter_at, statement_at) for text in found]

    def new_remarks(self, parameter_at: ParameterAt) -> List[Fault]:
        """Return the warnings that clingo has issued since the last call."""
        fresh, self.reported = self.received[self.reported :], len(self.received)
        return [_fault(text, parameter_at, lambda *place: "") for code, text in fresh if code in _WARNINGS]


def _fault(text: str, parameter_at: ParameterAt, statement_at: StatementAt) -> Fault:
    match = _MESSAGE.match(text)
    if match is None:
        return Fault("<program>", 0, 0, text, kind="clingo")
    file, line, column = match.group("file"), int(match.group("line")), int(match.group("column"))
    message = _ANONYMOUS.sub("_", match.group("text").strip()).replace("#Inc0", parameter_at(file, line))
    remedy, kind = "", "syntax" if match.group("kind") == "error" else "clingo"
    variables = sorted({note.group("variable") for note in _NOTE.finditer(message)})
    if variables:
        kind = "unsafe"
        rule = statement_at(file, line, column)
        message = "unsafe variable{} {}".format("s" * (len(variables) > 1), ", ".join(variables))
        message += f" in {rule}" if rule else ""
        remedy = "bind each variable by a positive body literal, for instance a domain like office(X)"
        if rule.startswith("#external"):
            remedy = "bind each variable by a condition, for instance #external e(X) : office(X)."
    elif message.startswith("operation undefined:"):
        kind = "undefined-operation"
        operation = message.split("\n", 1)[-1].strip()
        message = f"undefined operation {operation}: clingo omits the instances that need it"
        remedy = "make sure that both sides are numbers and no divisor is 0"
    elif _SCRIPT.match(message):
        message, remedy = "scripts are not executed", "write the results of the script as facts"
    elif message.startswith("no definition found for theory atom:"):
        message = f"no #theory defines the theory atom &{message.split()[-1]}, and none is interpreted"
        remedy = "write rules about atoms with the step, or an aggregate like #sum"
    return Fault(file, line, column, message, remedy, kind)
