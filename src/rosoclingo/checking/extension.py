"""The extension of ``check`` by further files, such as those of a robot, whose check needs ROS."""

import argparse
from typing import Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

Kinds = Sequence[Iterable[str]]
"""The texts of requests of each kind, the most likely first."""


class CheckedFiles(NamedTuple):
    """The faults of files, and the names and texts of the files, in the order of the report."""

    faults: List[Fault]
    files: List[Tuple[str, str]]


class CheckExtension:
    """An extension that adds nothing; subclasses override its methods."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Add command line arguments."""

    def sources(self, options: argparse.Namespace) -> List[Source]:
        """Return further rules of the program; raises ProgramError if a file is unreadable."""
        return []

    def check(self, program: Optional[ReactiveProgram]) -> CheckedFiles:
        """Check the files, also against the program if it is readable."""
        return CheckedFiles([], [])

    def reasons(self) -> Mapping[str, Sequence[clingo.Symbol]]:
        """Return the return values of failed actions by interface."""
        return {}

    def requests(self, program: ReactiveProgram) -> Kinds:
        """Return requests of each kind to try; if empty, they are formed from the program's rules."""
        return ()


NO_EXTENSION = CheckExtension()
