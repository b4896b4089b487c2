"""The reactive ASP solver: oClingo's language and behaviour on a current clingo.

A :class:`ReactiveProgram` is loaded once. A :class:`ReactiveSolver` accepts a sequence of :class:`StreamUpdate` and
answers each. The package is pure Python on clingo, without ROS and without threads.
"""

from rosoclingo.oclingo.errors import (
    DroppedError,
    Fault,
    OclingoError,
    ProgramError,
    ProgressionError,
    SolverError,
)
from rosoclingo.oclingo.program.reactive_program import ReactiveProgram
from rosoclingo.oclingo.progression.parser import parse_update, parse_updates
from rosoclingo.oclingo.progression.terms import parse_atom, parse_term
from rosoclingo.oclingo.progression.updates import (
    Assert,
    Cumulative,
    Forget,
    Literal,
    Retract,
    Section,
    Statement,
    Stop,
    StreamUpdate,
    Volatile,
    commitment,
    fact,
)
from rosoclingo.oclingo.solving.reactive_solver import ReactiveSolver
from rosoclingo.oclingo.solving.results import Answer, SolveOutcome, SolveResult

__all__ = [
    "Answer",
    "Assert",
    "Cumulative",
    "DroppedError",
    "Fault",
    "Forget",
    "Literal",
    "OclingoError",
    "ProgramError",
    "ProgressionError",
    "ReactiveProgram",
    "ReactiveSolver",
    "Retract",
    "Section",
    "SolveOutcome",
    "SolveResult",
    "SolverError",
    "Statement",
    "Stop",
    "StreamUpdate",
    "Volatile",
    "commitment",
    "fact",
    "parse_atom",
    "parse_term",
    "parse_update",
    "parse_updates",
]
