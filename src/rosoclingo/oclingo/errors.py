"""Typed errors of the reactive solver.

Every fault names its place and, where there is one, the mend, so that a node or a service can pass the text on as it
stands.
"""

from dataclasses import dataclass
from typing import Sequence, Tuple


class OclingoError(Exception):
    """Base of all errors that the reactive solver raises."""


@dataclass(frozen=True)
class Fault:
    """One fault of a program: where it is, what it is, what to write instead, its kind (checking/lint/kinds.py)."""

    file: str
    line: int
    column: int
    message: str
    mend: str = ""
    kind: str = "syntax"

    def __str__(self) -> str:
        place = f"{self.file}:{self.line}:{self.column}: " if self.line else f"{self.file}: "
        return place + self.message + (f" ({self.mend})" if self.mend else "")


class ProgramError(OclingoError):
    """A reactive logic program cannot be used; :attr:`faults` lists all that was found, in order of place."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults: Tuple[Fault, ...] = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


class ProgressionError(OclingoError):
    """A text is no term, no atom or no online progression; lines and columns count from 1."""

    def __init__(self, line: int, column: int, message: str) -> None:
        self.line, self.column, self.message = line, column, message
        super().__init__(f"{line}:{column}: {message}")


class SolverError(OclingoError):
    """An update was refused as a whole; the solver keeps the state that it had before."""


class DroppedError(SolverError):
    """What was asked for was dropped, since the solver had to be ended or ended by itself; its state is kept."""


class NotReadyError(DroppedError):
    """A stop came while a new process still took what had led to the state; it goes on with that, ask again."""
