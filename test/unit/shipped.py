"""The shipped encodings as programs."""

from functools import lru_cache
from pathlib import Path

from rosoclingo.oclingo import ReactiveProgram

ENCODINGS = Path(__file__).resolve().parents[2] / "encodings"


@lru_cache(maxsize=None)
def shipped(*names: str) -> ReactiveProgram:
    """Return the program of these encodings, cached for all tests, because solvers never change it."""
    return ReactiveProgram.from_files([ENCODINGS / name for name in names])
