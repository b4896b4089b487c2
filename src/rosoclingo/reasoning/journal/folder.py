"""The folder of a journal: the core's state on disk, written before anybody outside can see what follows from it."""

import contextlib
import errno
import fcntl
import os
from pathlib import Path
from typing import Callable, List, NamedTuple, Optional, Union

from rosoclingo.common import durable
from rosoclingo.reasoning.journal.lines import Header, JournalError, Kept, State, changes, line_of, read

#: The file in the folder.
NAME = "journal.jsonl"

#: Bytes after which all is written anew into another file, if that is at most half as long.
LONG = 256 * 1024

#: Seconds until it is tried again to write, after a write that failed.
RETRY = 10.0

#: Which folders of a shelf stay: the latest so many, and those written to in so many seconds.
STAY, YOUNG = 20, 7 * 24 * 3600.0


class TakenError(JournalError):
    """Another core has the journal."""


def file_of(path: Path) -> Path:
    """Return the journal in a folder; a path that is no folder is that of a journal itself."""
    return path / NAME if path.is_dir() else path


def is_journal(file: Path) -> bool:
    """Whether this is a journal rather than a recording of another kind, by how it begins, or else is called."""
    try:
        with file.open("rb") as stream:
            return stream.read(1) == b"{" or file.name == NAME
    except OSError:  # whoever reads it tells
        return file.name == NAME


class JournalFolder:
    """The folder of a journal, which is this process's own until :meth:`close`.

    ``journal.jsonl.old`` is the journal that was set aside last, ``journal.jsonl.stale`` one that could not be
    written any more: what came later is not in it.
    """

    def __init__(self, folder: Path) -> None:
        """Take the folder, made where there is none; raises TakenError where another core has it, and OSError."""
        self.path = folder / NAME
        folder.mkdir(parents=True, exist_ok=True)
        self._lock: Optional[int] = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o644)
        self._file: Optional[int] = None
        self._size = self._first_size = self._number = 0
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
        """Return what the journal holds, None where there is none; raises JournalError, and OSError."""
        try:
            return read(self.path.read_bytes())
        except FileNotFoundError:
            return None
        except JournalError as error:
            mend = f"start without it (~resume: no, or rosrun rosoclingo journal clear {self.path.parent})"
            raise JournalError(f"{self.path}: {error}: {mend}; nothing of it is used") from None

    def begin(self, header: Header, state: State, time: Optional[float] = None) -> None:
        """Write all into a new file, which takes the place of the one that is; raises OSError."""
        data = line_of(0, header.record) + line_of(1, {"set": state}, time)
        file = durable.replace(self.path, data)
        self._drop_file()
        self._file, self._size, self._first_size, self._number = file, len(data), len(data), 2

    def append(self, change: State, time: Optional[float] = None, wait: bool = True) -> None:
        """Write one more record; raises OSError, and then nobody will take for the last state what stands there.

        The disk need not have it on return where it does not ``wait``: that is for :meth:`sync`.
        """
        assert self._file is not None
        data = line_of(self._number, change, time)
        durable.write(self._file, data, wait)
        self._size += len(data)
        self._number += 1

    def sync(self) -> None:
        """Wait until the disk has all records; raises OSError."""
        assert self._file is not None
        durable.sync(self._file)

    @property
    def is_long(self) -> bool:
        """Whether it is time to write all anew."""
        return self._size > max(LONG, 2 * self._first_size)

    def set_aside(self, word: str) -> Optional[Path]:
        """Let the file have its name with a ``word`` behind it, None where there is none; raises OSError."""
        self._drop_file()
        aside = Path(f"{self.path}.{word}")
        try:
            os.replace(self.path, aside)
        except FileNotFoundError:
            return None
        durable.sync_folder(self.path.parent)
        return aside

    def clear(self) -> List[str]:
        """Remove the journal and what was set aside; return the names of the files that were there; raises OSError."""
        self._drop_file()
        found = sorted(self.path.parent.glob(f"{NAME}*"))
        for one in found:
            one.unlink()
        return [one.name for one in found]

    def close(self) -> None:
        """Leave the folder to others."""
        self._drop_file()
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _drop_file(self) -> None:
        if self._file is not None:
            os.close(self._file)
            self._file = None


def tidy(shelf: Path, now: float) -> None:
    """Remove old journals among the folders of a shelf, but those that a core has; ``now`` is as files tell times.

    A folder with anything else in it stays, and so does what cannot be removed.
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
    """Keeps a state in a folder: each :meth:`write` adds what has changed since the last one.

    A disk that is full or fails does not stop the robot: :attr:`fault` tells of it, and after some time all is tried
    again. What stood there is out of date then, and gets another name.

    Attributes:
        fault: why nothing is written at present, empty where all is well.

    """

    def __init__(self, folder: JournalFolder, header: Header, retry: float = RETRY) -> None:
        self._folder, self._header, self._retry = folder, header, retry
        self._written: Optional[State] = None
        self._tried = float("-inf")
        self._unsynced = False  # whether something was written that the disk may not have
        self.fault = ""

    def write(self, state: State, now: float, time: Optional[float] = None, wait: bool = True) -> None:
        """Write the ``state``, and ``wait`` until the disk has it; else it outlives the process, not yet the machine.

        ``now`` is in seconds of a clock that only goes forward, ``time``, which is written too, of the run's clock.
        """
        if self.fault and not self.is_due(now):
            return
        self._try(lambda: self._write(state, time, wait), now)

    def settle(self, now: float) -> None:
        """Have on disk what was written without waiting for that."""
        if self._unsynced:
            self._try(self._sync, now)

    def _try(self, action: Callable[[], None], now: float) -> None:
        """Do something with the disk; where it fails all is written anew at the next try."""
        try:
            action()
            self.fault = ""
        except OSError as error:
            self._written, self._unsynced, self._tried = None, False, now
            self.fault = f"the journal {self._folder.path} cannot be written: {error.strerror or error}"
            with contextlib.suppress(OSError):
                self._folder.set_aside("stale")

    def is_due(self, now: float) -> bool:
        """Whether it is time to try again, where something could not be written."""
        return bool(self.fault) and now - self._tried >= self._retry

    def _write(self, state: State, time: Optional[float], wait: bool) -> None:
        if self._written is None or self._folder.is_long:
            self._folder.begin(self._header, state, time)
            self._unsynced = False
        else:
            change = changes(self._written, state)
            if change:
                self._folder.append(change, time, wait)
                self._unsynced = not wait
            elif wait and self._unsynced:
                self._sync()
        self._written = state

    def _sync(self) -> None:
        self._folder.sync()
        self._unsynced = False

    def close(self) -> None:
        """Write no more."""
        self._folder.close()


class NoJournal(NamedTuple):
    """In the place of a journal that was wanted, and why there is none: its ``fault``."""

    fault: str

    def write(self, state: State, now: float, time: Optional[float] = None, wait: bool = True) -> None:
        """Write nothing."""

    def settle(self, now: float) -> None:
        """There is nothing to wait for."""

    def is_due(self, now: float) -> bool:
        """It is not tried again."""
        return False

    def close(self) -> None:
        """Nobody waits for it."""


AnyJournal = Union[Journal, NoJournal]
