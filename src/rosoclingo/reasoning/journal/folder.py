"""The folder of a journal: locking, writing and tidying."""

import contextlib
import errno
import fcntl
import json
import os
import sqlite3
from pathlib import Path
from typing import Callable, List, Optional

from rosoclingo.common.database import Database
from rosoclingo.reasoning.journal.database import (
    NAME,
    TABLES,
    Header,
    JournalContent,
    JournalError,
    checksum,
    is_empty,
    read,
)
from rosoclingo.reasoning.records import Record

#: Number of records after which the journal is rewritten with the whole state.
RECORDS = 500

#: Seconds until the next attempt after a failed write.
RETRY = 10.0

#: Folders of a shelf are kept if they are among the latest ``STAY`` or were written in the last ``YOUNG`` seconds.
STAY, YOUNG = 20, 7 * 24 * 3600.0


#: The header of a journal that is only read.
NO_RUN = Header("", "")


class LockedError(JournalError):
    """Another core uses the journal."""


class Journal:
    """The journal in a folder, locked by this process until :meth:`close`. It records the changes of a state.

    A full or broken disk does not stop the robot: :attr:`fault` reports it, and writing is tried again after
    :data:`RETRY` seconds. Until then there is no journal: the outdated one is renamed to ``journal.db.stale``. The
    journal of an earlier run is renamed to ``journal.db.old``.

    Attributes:
        path: the database.
        header: the run that is written.
        records: the number of records since the whole state was written.

    """

    def __init__(self, folder: Path, header: Header = NO_RUN) -> None:
        """Create and lock the folder; raises LockedError if another core has locked it, and OSError."""
        self.path, self.header = folder / NAME, header
        self._database = Database(self.path, TABLES, RETRY)
        self._complete = False  # whether the records yield the latest state
        folder.mkdir(parents=True, exist_ok=True)
        self._lock: Optional[int] = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o644)
        self.records = 0
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if not os.path.samestat(os.fstat(self._lock), os.stat(folder / "lock")):
                raise BlockingIOError(errno.EAGAIN, "another process has removed the folder")
        except OSError as error:
            self.close()
            if error.errno not in (errno.EACCES, errno.EAGAIN, errno.ENOENT):
                raise
            raise LockedError(
                f"another core uses the journal in {folder}: stop it, or set ~journal to another folder"
            ) from None

    def read(self) -> Optional[JournalContent]:
        """Return the content of the journal, None if there is none; raises JournalError, OSError."""
        if is_empty(self.path):
            return None
        try:
            return read(self.path)
        except JournalError as error:
            remedy = f"start without it (~resume: no, or rosrun rosoclingo journal clear {self.path.parent})"
            raise JournalError(f"{self.path}: {error}: {remedy}") from None

    @property
    def fault(self) -> str:
        """Why the journal cannot be written at present, empty for none."""
        return self._database.fault and f"the journal {self.path} cannot be written: {self._database.fault}"

    def is_due(self, now: float) -> bool:
        """Return whether it is time for another attempt after a failed write."""
        return self._database.is_due(now)

    def write(self, change: Record, state: Optional[Callable[[], Record]], now: float, time: float) -> None:
        """Write a ``change``, or the whole state after :data:`RECORDS` changes or a failure, and wait for the disk.

        ``state`` returns the whole state; None appends the change if the journal is complete. ``now`` is in seconds of
        a monotonic clock. ``time`` is recorded, in seconds of the run's clock.
        """
        if self.fault and not self.is_due(now):
            return
        if state is not None and (not self._complete or self.records >= RECORDS):
            self.records, change = 0, {"set": state()}
        elif not self._complete or not change:
            return
        self._complete = self._commit(change, time, now)
        if not self._complete:
            with contextlib.suppress(OSError):
                self.set_aside("stale")

    def _commit(self, change: Record, time: float, now: float) -> bool:
        """Append a record, or replace all by the first one; return whether it is durable."""
        text = json.dumps(change, separators=(",", ":"))
        row = self.records + 1, round(time, 3), text

        def write(db: sqlite3.Connection) -> bool:
            """Insert the record; the first one replaces everything."""
            if row[0] == 1:
                db.execute("DELETE FROM header")
                db.execute("DELETE FROM record")
                db.execute("INSERT INTO header VALUES (?, ?, ?, ?, ?)", (*self.header, checksum(*self.header)))
            db.execute("INSERT INTO record VALUES (?, ?, ?, ?)", (*row, checksum(*row)))
            return True

        written = bool(self._database.run(write, now))
        self.records += written
        return written

    def set_aside(self, suffix: str) -> Optional[Path]:
        """Rename the journal with ``suffix``; return its new path, None if there is no journal; raises OSError."""
        if not is_empty(self.path):
            return self._database.set_aside(suffix)
        self._database.close()
        with contextlib.suppress(FileNotFoundError):
            self.path.unlink()
        return None

    def clear(self) -> List[str]:
        """Remove the journal and all renamed ones; return the names of the files; raises OSError."""
        self._database.close()
        found = sorted(self.path.parent.glob(f"{NAME}*"))
        for one in found:
            one.unlink()
        return [one.name for one in found]

    def close(self) -> None:
        """Unlock the folder."""
        self._database.close()
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None


def tidy(shelf: Path, now: float) -> None:
    """Remove old journals from the folders of a shelf; ``now`` is in seconds, as the times of files.

    Journals in use, folders with other files and files that cannot be removed stay.
    """
    with contextlib.suppress(OSError):
        folders = (one for one in shelf.iterdir() if (one / "lock").exists())
        found = ((max(file.stat().st_mtime for file in one.iterdir()), one) for one in folders)
        for written, one in sorted(found, reverse=True)[STAY:]:
            if now - written > YOUNG:
                _remove(one)


def _remove(path: Path) -> None:
    with contextlib.suppress(OSError, LockedError):
        folder = Journal(path)
        try:
            folder.clear()
            (path / "lock").unlink()
            path.rmdir()
        finally:
            folder.close()
