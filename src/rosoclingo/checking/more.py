"""What a check can look at beyond program and stream: a robot's files, which need ROS's messages."""

import argparse
from typing import Iterable, List, Mapping, NamedTuple, Optional, Protocol, Sequence, Tuple

import clingo

from rosoclingo.oclingo.errors import Fault
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.program.sources import Source

Kinds = Sequence[Iterable[str]]
"""Requests, as texts, of each kind; the likely ones come first."""


class Texts(NamedTuple):
    """Faults, and the names and texts of the files in the order of the findings."""

    faults: List[Fault]
    files: List[Tuple[str, str]]


class More(Protocol):
    """What a command looks at beyond program and stream."""

    def add_arguments(self, parser: argparse.ArgumentParser) -> None:
        """Add its command line arguments."""

    def sources(self, options: argparse.Namespace) -> List[Source]:
        """Return what it adds to the program; raises ProgramError where a file cannot be read."""

    def look(self, options: argparse.Namespace, program: Optional[ReactiveProgram]) -> Texts:
        """Return what may be wrong with it; without the program where that could not be read."""

    def reasons(self) -> Mapping[str, Sequence[clingo.Symbol]]:
        """Return values with which actions may return that are no success, by interface."""

    def requests(self, program: ReactiveProgram) -> Kinds:
        """Return requests to try, of each kind; without kinds those that the program's rules ask for are tried."""
