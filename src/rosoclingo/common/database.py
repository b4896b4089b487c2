"""An SQLite database with one writer, which syncs each change to disk before it becomes visible."""

import contextlib
import os
import sqlite3
from pathlib import Path
from typing import Callable, Optional, Sequence, TypeVar

T = TypeVar("T")

#: SQLite's ``synchronous``: a commit waits for the disk.
SYNCED = "FULL"

#: Pages of the log before SQLite moves them into the database: a short log is overwritten, which is faster than growth.
LOG_PAGES = 60


class Database:
    """A database that is opened, with its tables, on first use.

    Errors are not raised: :attr:`fault` reports them, and the caller retries when :meth:`is_due`.

    Attributes:
        path: the file. SQLite writes the latest changes to its log, ``PATH-wal``.
        fault: why the last transaction failed, empty if it succeeded.

    """

    def __init__(self, path: Path, tables: Sequence[str], retry: float) -> None:
        """Use the file ``path``; ``tables`` are SQL statements, ``retry`` is the wait in seconds after a failure."""
        self.path, self.fault = path, ""
        self._tables, self._retry, self._retry_at = tables, retry, 0.0
        self._db: Optional[sqlite3.Connection] = None
        self._ready = False  # whether the tables exist

    def run(self, work: Callable[[sqlite3.Connection], T], now: float = 0.0) -> Optional[T]:
        """Run ``work`` in one transaction, synced to disk, and return its result; None if it failed.

        ``now`` is the steady time in seconds. A damaged database is renamed to ``PATH.damaged``, and the next
        transaction creates a new file.
        """
        try:
            db = self._connected()
            with db:
                db.execute("BEGIN")
                for statement in () if self._ready else self._tables:
                    db.execute(statement)
                result = work(db)
        except (OSError, sqlite3.Error) as error:
            self.fault, self._retry_at = str(error), now + self._retry
            if isinstance(error, sqlite3.DatabaseError) and not isinstance(error, sqlite3.OperationalError):
                with contextlib.suppress(OSError):
                    self.set_aside("damaged")
            return None
        self.fault, self._ready = "", True
        return result

    def is_due(self, now: float) -> bool:
        """Return whether to retry now after a failure."""
        return bool(self.fault) and now >= self._retry_at

    def set_aside(self, suffix: str) -> Path:
        """Rename the database to end with ``suffix``; return its new path; raises OSError."""
        with contextlib.suppress(OSError, sqlite3.Error):
            self._connected()
        self.close()
        aside = Path(f"{self.path}.{suffix}")
        os.replace(self.path, aside)  # before its log: SQLite ignores the log of a missing file
        for file in ("-wal", "-shm"):
            with contextlib.suppress(FileNotFoundError):
                os.replace(f"{self.path}{file}", f"{aside}{file}")
        folder = os.open(self.path.parent, os.O_RDONLY)
        os.fsync(folder)
        os.close(folder)
        return aside

    def close(self) -> None:
        """Close the file; if possible, move the log into it, so that the file can be copied alone."""
        db, self._db, self._ready = self._db, None, False
        if db is not None:
            with contextlib.suppress(sqlite3.Error):  # a full disk, a reader or damage
                db.execute("PRAGMA journal_mode = DELETE")
            db.close()

    def _connected(self) -> sqlite3.Connection:
        if self._db is None:
            self.path.parent.mkdir(parents=True, exist_ok=True)
            db = sqlite3.connect(str(self.path), 1.0, isolation_level=None, check_same_thread=False)
            self._db = db
            db.execute(f"PRAGMA synchronous = {SYNCED}")
            db.execute("PRAGMA page_size = 1024")  # small, as a commit writes whole pages and changes are short
            db.execute("PRAGMA journal_mode = WAL")
            db.execute(f"PRAGMA wal_autocheckpoint = {LOG_PAGES}")
        return self._db
