"""Compilation of numerical loops, and the cache of the compiled code."""

import hashlib
import os
import platform
import shutil
from pathlib import Path
from typing import Any, Callable

import numba

SOURCES = Path(os.path.abspath(__file__)).parents[2]  # with symbolic links, as in numba's index
BUILT = Path("share", "rosoclingo", "numba")  # code compiled by the build, in the devel or install space


def cache_folder(sources: Path) -> str:
    """Return the cache folder for the present path and content of all modules in ``compiled`` folders.

    numba itself only checks the file of a function, not the files of the functions that it calls. The folder is inside
    numba's own (``NUMBA_CACHE_DIR``), else in the user's cache folder.
    """
    content = [f"{sources} {platform.python_version()}".encode()]
    content += [file.read_bytes() for file in sorted(sources.glob("*/compiled/*.py"))]
    digest = hashlib.sha256(b"".join(content)).hexdigest()[:16]
    user = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.path.join(numba.config.CACHE_DIR or os.path.join(user, "rosoclingo", "numba"), digest)


def _prepared(folder: str) -> bool:
    """Create the cache folder from the code compiled by the build. Return whether the folder is writable."""
    prefixes = [*SOURCES.parents, *map(Path, filter(None, os.environ.get("CMAKE_PREFIX_PATH", "").split(os.pathsep)))]
    built = [prefix / BUILT / os.path.basename(folder) for prefix in prefixes]
    copy = f"{folder}.{os.getpid()}"
    try:
        os.makedirs(os.path.dirname(folder), exist_ok=True)
        if not os.path.isdir(folder):
            for found in [path for path in built if path.is_dir()][:1]:
                shutil.copytree(str(found), copy)
                os.rename(copy, folder)
        os.makedirs(folder, exist_ok=True)
    except OSError:  # not writable, or another process was faster
        shutil.rmtree(copy, ignore_errors=True)
    return os.access(folder, os.W_OK)


FOLDER = cache_folder(SOURCES)
CACHES = _prepared(FOLDER)  # otherwise each process compiles its own code


def jit(function: Callable) -> Any:
    """Compile a function with numba at its first call; it runs without the interpreter lock."""
    others, numba.config.CACHE_DIR = numba.config.CACHE_DIR, FOLDER
    try:
        return numba.njit(cache=CACHES, nogil=True)(function)
    finally:
        numba.config.CACHE_DIR = others
