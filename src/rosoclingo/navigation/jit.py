"""How the loops over cells and beams are compiled, and where the result is kept."""

import hashlib
import os
from pathlib import Path
from typing import Any, Callable

import numba

__all__ = ["cache_folder", "jit"]

SOURCES = Path(__file__).resolve().parents[1]


def cache_folder(sources: Path) -> str:
    """Return where compiled code is kept: a folder for each state of all ``compiled*.py`` in the packages of a folder.

    It is in numba's own (``NUMBA_CACHE_DIR``), else in the user's cache folder.

    By itself numba looks at the file of a function alone: when a function of another file is changed that it calls, it
    would go on with what that once was.
    """
    files = sorted(sources.glob("*/compiled*.py"))
    digest = hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()[:16]
    user = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.path.join(numba.config.CACHE_DIR or os.path.join(user, "rosoclingo", "numba"), digest)


def _is_writable(folder: str) -> bool:
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


FOLDER = cache_folder(SOURCES)
CACHES = _is_writable(FOLDER)  # else each process compiles anew


def jit(function: Callable) -> Any:
    """Have a function compiled by numba when it is called first, to run without holding the interpreter's lock."""
    others, numba.config.CACHE_DIR = numba.config.CACHE_DIR, FOLDER
    try:
        return numba.njit(cache=CACHES, nogil=True)(function)
    finally:
        numba.config.CACHE_DIR = others
