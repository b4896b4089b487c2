"""Compiles everything once, before anybody waits for it, and says so."""

import contextlib
import fcntl
import importlib
import json
import os
import platform
from pathlib import Path
from typing import Callable, Iterator

import llvmlite.binding
import numba

from rosoclingo.robot.navigation.compiled.jit import FOLDER, FUNCTIONS

__all__ = ["PARTS", "compile_once"]

_REHEARSALS = {"navigation": "drive_rehearsal", "simulation": "simulation_rehearsal"}

#: The packages with compiled functions; a module of each rehearses all of them.
PARTS = tuple(_REHEARSALS)


def compile_once(part: str, say: Callable[[str], None]) -> None:
    """Have all functions of one of PARTS ready to be called; ``say`` so first where they have to be compiled.

    Another process that compiles the same is waited for.
    """
    rehearsal = importlib.import_module(f"rosoclingo.robot.{part}.{_REHEARSALS[part]}")
    mark = Path(FOLDER, f"{part}.json")
    stamp = _stamp(f"rosoclingo.robot.{part}.")
    with _alone(part):
        known = _read(mark) == stamp
        if not known:
            say(f"compiling {part} once, which takes up to a minute; what was compiled is kept in {FOLDER}")
        rehearsal.rehearse()
        if not known:
            with contextlib.suppress(OSError):  # without a folder it is compiled every time
                mark.write_text(stamp, encoding="utf-8")


def _stamp(package: str) -> str:
    """All that numba looks at to tell whether what it has kept is still good."""
    files = {numba.__file__} | {
        one.py_func.__code__.co_filename for one in FUNCTIONS if one.py_func.__module__.startswith(package)
    }
    state = [(name, os.stat(name).st_mtime_ns, os.stat(name).st_size) for name in sorted(files)]
    return json.dumps([platform.python_version(), llvmlite.binding.get_host_cpu_name(), state])


def _read(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8")
    except OSError:
        return ""


@contextlib.contextmanager
def _alone(part: str) -> Iterator[None]:
    """Be the only process that compiles a part; without a folder there is nothing to share."""
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):
            file = stack.enter_context(Path(FOLDER, f"{part}.lock").open("w"))
            fcntl.flock(file, fcntl.LOCK_EX)
        yield
