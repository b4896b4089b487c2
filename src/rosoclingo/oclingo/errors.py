"""Typed errors of the reactive solver; their texts name the place and, if there is one, the mend."""

from dataclasses import dataclass
from typing import Sequence, Tuple


class OclingoError(Exception):
    """Base of all errors of the reactive solver."""


@dataclass(frozen=True)
class Fault:
    """A fault of a program: place, message, mend and kind (checking/lint/kinds.py)."""

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
    """A reactive logic program cannot be used; :attr:`faults` lists the faults in order of place."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults: Tuple[Fault, ...] = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


class ProgressionError(OclingoError):
    """A text is no term, atom or online progression; lines and columns count from 1."""

    def __init__(self, line: int, column: int, message: str) -> None:
        self.line, self.column, self.message = line, column, message
        super().__init__(f"{line}:{column}: {message}")


class SolverError(OclingoError):
    """An update was refused as a whole; the state of the solver is unchanged."""


class DroppedError(SolverError):
    """A request was dropped, since the solver was killed or died; its state is unchanged."""


class NotReadyError(DroppedError):
    """A stop came while a new process was reading the history; it goes on, and the request can be repeated."""
