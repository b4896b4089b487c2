"""How the loops over cells and beams are compiled, and where the compiled code is kept."""

import hashlib
import os
import platform
import shutil
from pathlib import Path
from typing import Any, Callable

import numba

SOURCES = Path(os.path.abspath(__file__)).parents[2]  # as numba knows it, with its links
BUILT = Path("share", "rosoclingo", "numba")  # what the build has compiled, in the devel or install space


def cache_folder(sources: Path) -> str:
    """Return where compiled code is kept: one folder for each place and content of the modules in ``compiled`` folders.

    numba itself looks at the file of a function alone, not at those of the functions that it calls. The folder is in
    numba's own (``NUMBA_CACHE_DIR``), else in the user's cache folder.
    """
    content = [f"{sources} {platform.python_version()}".encode()]
    content += [file.read_bytes() for file in sorted(sources.glob("*/compiled/*.py"))]
    digest = hashlib.sha256(b"".join(content)).hexdigest()[:16]
    user = os.environ.get("XDG_CACHE_HOME") or os.path.join(os.path.expanduser("~"), ".cache")
    return os.path.join(numba.config.CACHE_DIR or os.path.join(user, "rosoclingo", "numba"), digest)


def _prepared(folder: str) -> bool:
    """Fill the folder with what the build has compiled unless it exists; return whether it can be written."""
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
    except OSError:  # no place for it, or another process was faster
        shutil.rmtree(copy, ignore_errors=True)
    return os.access(folder, os.W_OK)


FOLDER = cache_folder(SOURCES)
CACHES = _prepared(FOLDER)  # else each process compiles again


def jit(function: Callable) -> Any:
    """Have numba compile a function at its first call, to run without holding the interpreter's lock."""
    others, numba.config.CACHE_DIR = numba.config.CACHE_DIR, FOLDER
    try:
        return numba.njit(cache=CACHES, nogil=True)(function)
    finally:
        numba.config.CACHE_DIR = others
