"""Errors of the reactive solver; their texts contain the place and, if known, the fix."""

from dataclasses import dataclass
from typing import Sequence, Tuple


class OclingoError(Exception):
    """Base of all errors of the reactive solver."""


@dataclass(frozen=True)
class Fault:
    """A fault in a program.

    Attributes:
        file: name of the file.
        line: line from 1; 0 if the fault has no place in the file.
        column: column from 1.
        message: the description of the fault.
        remedy: how to fix the fault; empty if unknown.
        kind: the kind of the finding, see checking/lint/kinds.py.

    """

    file: str
    line: int
    column: int
    message: str
    remedy: str = ""
    kind: str = "syntax"

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}: " if self.line else f"{self.file}: "
        return place + self.message + (f" ({self.remedy})" if self.remedy else "")


class ProgramError(OclingoError):
    """A reactive logic program has faults, listed in :attr:`faults` in the order of their places."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults: Tuple[Fault, ...] = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


class ProgressionError(OclingoError):
    """A text is not a term, atom or online progression; lines and columns count from 1."""

    def __init__(self, line: int, column: int, message: str) -> None:
        self.line, self.column, self.message = line, column, message
        super().__init__(f"{line}:{column}: {message}")


class SolverError(OclingoError):
    """The solver refused an update; its state is unchanged."""


class DroppedError(SolverError):
    """A request was dropped because the solver was stopped, killed or crashed; its state is unchanged."""


class StoppedError(DroppedError):
    """The solver was stopped before it had a result."""

    def __init__(self, message: str = "stopped while grounding the program; the request was discarded") -> None:
        super().__init__(message)
