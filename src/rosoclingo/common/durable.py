"""Files of lines that are on the disk before anybody can see what follows from them.  No ROS.

A line is a JSON object that begins with the CRC-32 of what follows in it, so that it tells whether it is as it was
written.
"""

import contextlib
import json
import os
import zlib
from functools import lru_cache
from pathlib import Path
from typing import Any, Dict, Optional

#: Where Linux tells which start of the machine this is.
BOOT = Path("/proc/sys/kernel/random/boot_id")


def sealed(value: Dict[str, Any]) -> bytes:
    """Return a value, with at least one key, as a line."""
    return _sealed(json.dumps(value, separators=(",", ":")).encode("ascii")) + b"\n"


def opened(line: bytes) -> Optional[Dict[str, Any]]:
    """Return the value of a line without its end; None if it is not as it was written."""
    start = len(_sealed(b"{"))
    body = b"{" + line[start:]
    return dict(json.loads(body)) if len(line) > start and line == _sealed(body) else None


def _sealed(body: bytes) -> bytes:
    return b'{"crc":"%08x",' % zlib.crc32(body) + body[1:]


@lru_cache(maxsize=1)
def machine() -> Optional[str]:
    """Return what tells one start of the machine from another, None where that is not known.

    What was written without waiting for the disk is there as long as it is the same.
    """
    try:
        return BOOT.read_text(encoding="ascii").strip()
    except OSError:
        return None


def write(file: int, data: bytes, wait: bool = True) -> None:
    """Write to a file descriptor, and ``wait`` until the disk has it; raises OSError, with part of it written perhaps.

    What is not waited for outlives this process, but not the machine, until :func:`sync`.
    """
    left = memoryview(data)
    while left:
        left = left[os.write(file, left) :]
    if wait:
        sync(file)


def sync(file: int) -> None:
    """Return when the disk has all that was written to a file descriptor; raises OSError."""
    os.fdatasync(file)  # its length as well; the time of the change, which nobody reads, need not be there


def replace(path: Path, data: bytes) -> int:
    """Put a new file in the place of one that may be there, at once; return its descriptor, to :func:`write` more.

    Raises OSError, and then the old one is still there, or the new one whole.
    """
    new = Path(f"{path}.new")
    file = os.open(new, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_APPEND, 0o644)
    try:
        write(file, data)
        os.replace(new, path)
        sync_folder(path.parent)
    except OSError:
        os.close(file)
        with contextlib.suppress(OSError):
            new.unlink()
        raise
    return file


def sync_folder(folder: Path) -> None:
    """Have the names in a folder on the disk; raises OSError."""
    file = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(file)
    finally:
        os.close(file)
