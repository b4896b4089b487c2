"""The folder of a journal: the core's state on disk, written before anybody outside can see what follows from it."""

import contextlib
import errno
import fcntl
import json
import os
import sqlite3
from pathlib import Path
from typing import List, Optional

from rosoclingo.reasoning.journal.database import (
    NAME,
    TABLES,
    Header,
    JournalError,
    Kept,
    State,
    changes,
    checksum,
    is_empty,
    read,
)

#: Records after which the journal begins again with the whole state.
RECORDS = 500

#: SQLite's ``synchronous``: with the one a commit waits for the disk, with the other it outlives only this process.
SYNCED, UNSYNCED = "FULL", "NORMAL"

#: Pages of the log before SQLite moves them into the database: a short log is overwritten, which is faster than growth.
LOG_PAGES = 60

#: Seconds between two attempts to write, after a write has failed.
RETRY = 10.0

#: The folders of a shelf that stay: the number of the latest ones, and the seconds since one was last written.
STAY, YOUNG = 20, 7 * 24 * 3600.0


class TakenError(JournalError):
    """Another core has the journal."""


class JournalFolder:
    """The folder of a journal, locked by this process until :meth:`close`.

    ``journal.db.old`` is the journal that was set aside last, ``journal.db.stale`` one that could not be
    written any more: later changes are not in it.
    """

    def __init__(self, folder: Path) -> None:
        """Lock the folder, which is made if there is none; raises TakenError if another core has it, and OSError."""
        self.path = folder / NAME
        folder.mkdir(parents=True, exist_ok=True)
        self._lock: Optional[int] = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o644)
        self._db: Optional[sqlite3.Connection] = None
        self.records = 0  # since the whole state was written
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if not os.path.samestat(os.fstat(self._lock), os.stat(folder / "lock")):
                raise BlockingIOError(errno.EAGAIN, "the folder was removed meanwhile")
        except OSError as error:
            self.close()
            if error.errno not in (errno.EACCES, errno.EAGAIN, errno.ENOENT):
                raise
            raise TakenError(
                f"another core has the journal in {folder}: end it, or give this one another folder by ~journal"
            ) from None

    def read(self) -> Optional[Kept]:
        """Return the content of the journal, None if there is none; raises JournalError, OSError."""
        if is_empty(self.path):
            return None
        try:
            return read(self.path)
        except JournalError as error:
            mend = f"start without it (~resume: no, or rosrun rosoclingo journal clear {self.path.parent})"
            raise JournalError(f"{self.path}: {error}: {mend}; nothing of it is used") from None

    def begin(self, header: Header, state: State, time: Optional[float] = None) -> None:
        """Write the whole state in place of all records; raises sqlite3.Error."""
        db = self._connect()
        db.execute(f"PRAGMA synchronous = {SYNCED}")
        db.execute("PRAGMA page_size = 1024")  # a commit writes whole pages, and a record is shorter than one
        db.execute("PRAGMA journal_mode = WAL")
        db.execute(f"PRAGMA wal_autocheckpoint = {LOG_PAGES}")
        self.records = 0
        with db:
            db.execute("BEGIN")
            for statement in (*TABLES, "DELETE FROM header", "DELETE FROM record"):
                db.execute(statement)
            db.execute("INSERT INTO header VALUES (?, ?, ?, ?, ?)", (*header, checksum(*header)))
            self._insert({"set": state}, time)

    def append(self, change: State, time: Optional[float] = None, wait: bool = True) -> None:
        """Write one more record; raises sqlite3.Error, and then the record is not in the journal.

        On return the disk has it if ``wait`` is true. Otherwise it survives the process, but not the machine, until the
        disk has a later record.
        """
        self._connect().execute(f"PRAGMA synchronous = {SYNCED if wait else UNSYNCED}")
        self._insert(change, time)

    def _insert(self, change: State, time: Optional[float]) -> None:
        text = json.dumps(change, separators=(",", ":"))
        row = self.records + 1, None if time is None else round(time, 3), text
        self._connect().execute("INSERT INTO record VALUES (?, ?, ?, ?)", (*row, checksum(*row)))
        self.records += 1

    def set_aside(self, suffix: str) -> Optional[Path]:
        """Rename the journal to end with ``suffix``; return its path, None if there is none; raises OSError."""
        if is_empty(self.path):
            self._disconnect()
            with contextlib.suppress(FileNotFoundError):
                self.path.unlink()
            return None
        self._connect()
        self._disconnect()
        aside = Path(f"{self.path}.{suffix}")
        os.replace(self.path, aside)  # first of all: SQLite ignores the log of a file that does not exist
        for file in ("-wal", "-shm"):
            with contextlib.suppress(FileNotFoundError):
                os.replace(f"{self.path}{file}", f"{aside}{file}")
        folder = os.open(self.path.parent, os.O_RDONLY)
        os.fsync(folder)
        os.close(folder)
        return aside

    def clear(self) -> List[str]:
        """Remove the journal and those that were set aside; return the names of the files; raises OSError."""
        self._disconnect()
        found = sorted(self.path.parent.glob(f"{NAME}*"))
        for one in found:
            one.unlink()
        return [one.name for one in found]

    def close(self) -> None:
        """Unlock the folder."""
        self._disconnect()
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _connect(self) -> sqlite3.Connection:
        if self._db is None:
            self._db = sqlite3.connect(str(self.path), 1.0, isolation_level=None, check_same_thread=False)
        return self._db

    def _disconnect(self) -> None:
        if self._db is not None:
            with contextlib.suppress(sqlite3.Error):  # a full disk, a reader or damage: the log stays beside the file
                self._db.execute("PRAGMA journal_mode = DELETE")  # a single file, for copies and read-only folders
            self._db.close()
            self._db = None


def tidy(shelf: Path, now: float) -> None:
    """Remove old journals among the folders of a shelf, except those that a core has; ``now`` as files have times.

    A folder with other files stays, and so does a file that cannot be removed.
    """
    with contextlib.suppress(OSError):
        found = sorted(((_last_written(one), one) for one in shelf.iterdir() if (one / "lock").exists()), reverse=True)
        for written, one in found[STAY:]:
            if now - written > YOUNG:
                _remove(one)


def _last_written(folder: Path) -> float:
    return max(one.stat().st_mtime for one in folder.iterdir())


def _remove(path: Path) -> None:
    with contextlib.suppress(OSError, TakenError):
        folder = JournalFolder(path)
        try:
            folder.clear()
            (path / "lock").unlink()
            path.rmdir()
        finally:
            folder.close()


class Journal:
    """Keeps a state in a folder: each :meth:`write` adds the sections that have changed.

    A disk that is full or fails does not stop the robot: :attr:`fault` reports it, and the next attempt is made after
    some time. Until then there is no journal: the old one is out of date and has another name.

    Attributes:
        fault: why nothing is written at present, empty if all is well.

    """

    def __init__(self, folder: JournalFolder, header: Header, retry: float = RETRY) -> None:
        self._folder, self._header, self._retry = folder, header, retry
        self._written: Optional[State] = None
        self._tried = float("-inf")
        self.fault = ""

    def write(self, state: State, now: float, time: Optional[float] = None, wait: bool = True) -> None:
        """Write the ``state``, and ``wait`` until the disk has it and all earlier ones.

        ``now`` is in seconds of a monotonic clock; ``time``, which is written too, is in seconds of the run's clock.
        """
        if self.fault and not self.is_due(now):
            return
        try:
            self._write(state, time, wait)
            self.fault = ""
        except (OSError, sqlite3.Error) as error:
            self._written, self._tried = None, now
            self.fault = f"the journal {self._folder.path} cannot be written: {error}"
            with contextlib.suppress(OSError):
                self._folder.set_aside("stale")

    def is_due(self, now: float) -> bool:
        """Return whether it is time for another attempt after a write that failed."""
        return bool(self.fault) and now - self._tried >= self._retry

    def _write(self, state: State, time: Optional[float], wait: bool) -> None:
        if self._written is None or self._folder.records >= RECORDS:
            self._folder.begin(self._header, state, time)
        else:
            change = changes(self._written, state)
            if change or wait:  # an empty record makes the disk have the earlier ones
                self._folder.append(change, time, wait=wait)
        self._written = state

    def close(self) -> None:
        """Write no more."""
        self._folder.close()
