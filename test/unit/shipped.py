"""The shipped encodings as programs, and the recorded answers of the original oClingo."""

import json
from functools import lru_cache
from pathlib import Path

from rosoclingo.oclingo import ReactiveProgram

ROOT = Path(__file__).resolve().parents[2]
ENCODINGS, DATA = ROOT / "encodings", ROOT / "test" / "data"

#: Programs with updates, and the answers, the horizon and the end of each.
GOLDEN = json.loads((DATA / "oclingo_golden.json").read_text(encoding="utf-8"))


@lru_cache(maxsize=None)
def shipped(*names: str) -> ReactiveProgram:
    """Return the program of these encodings, cached for all tests, because solvers never change it."""
    return ReactiveProgram.from_files([ENCODINGS / name for name in names])
