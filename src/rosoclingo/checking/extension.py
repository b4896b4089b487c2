"""The extension of a check beyond program and stream, by the files of a robot, which need ROS's messages."""

import argparse
from typing import Iterable, List, Mapping, NamedTuple, Optional, Sequence, Tuple

import clingo

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

Kinds = Sequence[Iterable[str]]
"""Requests, as texts, of each kind; the likely ones come first."""


class CheckedFiles(NamedTuple):
    """The faults of files, and the names and texts of these in the order of the findings."""

    faults: List[Fault]
    files: List[Tuple[str, str]]


class CheckExtension:
    """An extension that adds nothing; subclasses override what they add."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Add command line arguments."""

    def sources(self, options: argparse.Namespace) -> List[Source]:
        """Return further texts of the program; raises ProgramError if a file cannot be read."""
        return []

    def look(self, program: Optional[ReactiveProgram]) -> CheckedFiles:
        """Return the faults of files, also against the program if it could be read."""
        return CheckedFiles([], [])

    def reasons(self) -> Mapping[str, Sequence[clingo.Symbol]]:
        """Return the values of failed actions by interface."""
        return {}

    def requests(self, program: ReactiveProgram) -> Kinds:
        """Return requests to try, of each kind; if empty, those that the program's rules ask for are tried."""
        return ()


NO_EXTENSION = CheckExtension()
