"""The journal's database: a header, and one record for each change of the core's state.

The first record contains the whole state, and each later record the changed rows. Applied in order, the records up
to a given one yield the state at that time. SQLite makes each record atomic, and recovers the database after a crash. A
checksum of each row detects corruption.
"""

import json
import sqlite3
import zlib
from contextlib import closing
from pathlib import Path
from typing import Any, Callable, Iterable, Iterator, List, NamedTuple, Tuple, TypeVar

from rosoclingo.reasoning.records import Record

#: The file in the folder of a journal.
NAME = "journal.db"

#: The format that this version writes and reads, SQLite's ``user_version``.
FORMAT = 8

#: The tables. ``change`` is a JSON object: the names of rows of the state to ``drop``, and the rows to ``set``.
TABLES = (
    "CREATE TABLE IF NOT EXISTS header (run TEXT, program TEXT, launch TEXT, description TEXT, crc INTEGER)",
    "CREATE TABLE IF NOT EXISTS record (number INTEGER PRIMARY KEY, time REAL, change TEXT, crc INTEGER)",
    f"PRAGMA user_version = {FORMAT}",
)

_T = TypeVar("_T")


class JournalError(Exception):
    """A journal cannot be used; the text gives the reason and the remedy."""


class Header(NamedTuple):
    """The identity of the run and the program that a journal belongs to.

    Attributes:
        run: the identity of the core's run.
        program: the program's fingerprint.
        launch: the launch that started the core, empty if it was started in another way.
        description: the whole program and all settings that influence decisions, as text for ``replay``.

    """

    run: str
    program: str
    launch: str = ""
    description: str = ""


class JournalContent(NamedTuple):
    """The content of a journal: its header, the state after the last record, and the number of records."""

    header: Header
    state: Record
    records: int


class Moment(NamedTuple):
    """The state after a record, and the time of the record in seconds of the run's clock."""

    state: Record
    time: float


def file_of(path: Path) -> Path:
    """Return the database of a journal, given its folder or the database itself."""
    return path / NAME if path.is_dir() else path


def is_journal(file: Path) -> bool:
    """Return whether a file is a journal, and not another kind of recording."""
    try:
        with file.open("rb") as stream:
            return stream.read(6) == b"SQLite" or file.name == NAME
    except OSError:  # reading the journal reports the error
        return file.name == NAME


def checksum(*values: Any) -> int:
    """Return the checksum of the values of a row."""
    return zlib.crc32(repr(values).encode())


def read(file: Path) -> JournalContent:
    """Return the content of a journal; raises JournalError, OSError."""
    header, moments = history(file)
    found = [moment.state for moment in moments]
    return JournalContent(header, found[-1], len(found))


def history(file: Path) -> Tuple[Header, Iterator[Moment]]:
    """Return the header, and the moment after each record; raises JournalError, OSError.

    The moments share one state, which changes in place.
    """
    header, rows = _reading(file, _content)

    def moments() -> Iterator[Moment]:
        """Yield the moments."""
        state: Record = {}
        for _, time, change, _ in rows:
            _apply(state, json.loads(change))
            yield Moment(state, time)

    return header, moments()


def launch_of(file: Path) -> str:
    """Return the launch in the header of a journal, which can be corrupt otherwise; empty if it cannot be read."""
    try:
        row = _reading(file, lambda db: db.execute("SELECT launch FROM header").fetchone())
    except JournalError:
        return ""
    return str(row[0]) if row else ""


def is_empty(file: Path) -> bool:
    """Return whether there is no journal, or its first record was never written; raises OSError."""
    try:
        return _reading(file, lambda db: db.execute("PRAGMA schema_version").fetchone()) == (0,)
    except FileNotFoundError:
        return True
    except JournalError:
        return False


def _reading(file: Path, ask: Callable[[sqlite3.Connection], _T]) -> _T:
    """Return the result of the query ``ask``, even while a core writes; raises JournalError, OSError."""
    file.stat()  # raises an OSError that names the file
    try:
        with closing(sqlite3.connect(f"{file.absolute().as_uri()}?mode=ro", uri=True)) as db:
            return ask(db)
    except sqlite3.Error as error:
        remedy = f"copy it again, together with {file.name}-wal, to a writable folder"
        raise JournalError(f"it cannot be read as a journal ({error}): {remedy}") from None


def _content(db: sqlite3.Connection) -> Tuple[Header, List[Tuple[int, float, str, int]]]:
    """Return the header and the rows of the records; raises JournalError if a row is missing or corrupt."""
    db.execute("BEGIN")  # one snapshot for all queries
    (version,) = db.execute("PRAGMA user_version").fetchone()
    if version != FORMAT:
        raise JournalError(f"it is of format {version}, this version reads {FORMAT}")
    row = db.execute("SELECT run, program, launch, description, crc FROM header").fetchone()
    if row is None or row[-1] != checksum(*row[:-1]):
        raise JournalError("the header is missing or corrupt")
    rows = db.execute("SELECT number, time, change, crc FROM record ORDER BY number").fetchall()
    if not rows:
        raise JournalError("record 1 is missing")
    for expected, (number, time, change, crc) in enumerate(rows, 1):
        if number != expected:
            raise JournalError(f"record {expected} is missing")
        if crc != checksum(number, time, change):
            raise JournalError(f"record {number} is corrupt")
    return Header(*row[:-1]), rows


def lines_of(content: JournalContent) -> Iterable[str]:
    """Yield the content of a journal as lines of text."""
    yield f"run {content.header.run}, {content.records} records since the last checkpoint"
    for name, value in content.state.items():
        yield f"{name} {json.dumps(value)}"


def _apply(state: Record, change: Record) -> None:
    for name in change.get("drop", ()):
        state.pop(name, None)
    state.update(change.get("set", {}))
