"""How the loops over cells and beams are compiled, and where the result is kept."""

import hashlib
import os
import platform
import shutil
from pathlib import Path
from typing import Any, Callable

import numba

__all__ = ["cache_folder", "jit"]

SOURCES = Path(os.path.abspath(__file__)).parents[2]  # as numba knows it, with its links
BUILT = Path("share", "rosoclingo", "numba")  # in the devel or install space: what the build has compiled


def cache_folder(sources: Path) -> str:
    """Return where compiled code is kept: a folder for each place and state of the modules in ``compiled`` folders.

    It is in numba's own (``NUMBA_CACHE_DIR``), else in the user's cache folder; where nothing is there yet, it begins
    with what was compiled when the package was built.

    By itself numba looks at the file of a function alone: when a function of another file is changed that it calls, it
    would go on with what that once was.
    """
    files = sorted(sources.glob("*/compiled/*.py"))
    versions = f"{sources} {platform.python_version()}"
    content = [versions.encode(), *(file.read_bytes() for file in files)]
    digest = hashlib.sha256(b"".join(content)).hexdigest()[:16]
    user = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.path.join(numba.config.CACHE_DIR or os.path.join(user, "rosoclingo", "numba"), digest)


def _is_writable(folder: str) -> bool:
    try:
        os.makedirs(folder, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)


def _take_over(folder: str) -> None:
    """Begin with what the build has compiled, unless there is something already."""
    prefixes = [*SOURCES.parents, *map(Path, filter(None, os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)))]
    built = [prefix / BUILT / os.path.basename(folder) for prefix in prefixes]
    found = next((path for path in built if path.is_dir()), None)
    if found is None or os.path.isdir(folder):
        return
    mine = f"{folder}.{os.getpid()}"
    try:
        shutil.copytree(str(found), mine)
        os.rename(mine, folder)
    except OSError:  # no place for it, or another process was faster
        shutil.rmtree(mine, ignore_errors=True)


FOLDER = cache_folder(SOURCES)
_take_over(FOLDER)
CACHES = _is_writable(FOLDER)  # else each process compiles anew


def jit(function: Callable) -> Any:
    """Have a function compiled by numba when it is called first, to run without holding the interpreter's lock."""
    others, numba.config.CACHE_DIR = numba.config.CACHE_DIR, FOLDER
    try:
        return numba.njit(cache=CACHES, nogil=True)(function)
    finally:
        numba.config.CACHE_DIR = others
