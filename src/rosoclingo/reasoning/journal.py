"""The journal: the core's state on disk, written before anybody outside can see what follows from it.

A folder holds one file, ``journal.jsonl``: a header, then records. A record says which sections of the state are other
than before; the first holds all of them, so that the file has a beginning however long the core has run. Each line
tells whether it is as it was written (:mod:`rosoclingo.common.durable`). A last line without its end was not written
to the end and is cut off; any other line that is not as it was written makes the journal one that nobody should trust.
"""

import contextlib
import errno
import fcntl
import json
import math
import os
from pathlib import Path
from typing import Any, Dict, Iterable, NamedTuple, Optional, Set

from rosoclingo.common import durable

#: What this version writes, and reads.
FORMAT = 1

#: Bytes after which all is written anew into another file, if that is at most half as long.
LONG = 256 * 1024

#: Seconds until it is tried again to write, after a write that failed.
RETRY = 10.0

#: A state by sections: plain values that JSON knows, in the order in which they came.
State = Dict[str, Any]


class JournalError(Exception):
    """A journal that cannot be used; the text says what is wrong with it and what to do."""


class TakenError(JournalError):
    """Another core has the journal."""


class Header(NamedTuple):
    """What a journal is of: the ``run`` of a core, the ``program`` (a hash) and the ``launch`` that has started it."""

    run: str
    program: str
    launch: str = ""

    @property
    def record(self) -> State:
        """The header as a line's value."""
        return {"format": FORMAT, **self._asdict()}


class Kept(NamedTuple):
    """What a journal holds: its header, the state after the last whole record, and how many records there are."""

    header: Header
    state: State
    records: int


def line_of(number: int, record: State) -> bytes:
    """Return a record as the line of this ``number``, from 0."""
    return durable.sealed({"n": number, **record})


def read(data: bytes) -> Kept:
    """Return what the bytes of a file hold; raises JournalError with the number of the line that is not right."""
    *lines, rest = data.split(b"\n")
    if rest and durable.opened(rest[:-1]) is not None:
        raise JournalError(f"line {len(lines) + 1} does not end as it was written")
    header = _header(_value(lines[0], 0) if lines else {})
    values = [_value(line, number) for number, line in enumerate(lines)]
    if len(values) < 2:
        raise JournalError("line 2 is missing: a journal begins with all that was known")
    state: State = {}
    for value in values[1:]:
        _apply(state, value)
    return Kept(header, state, len(values) - 1)


def changes(before: State, after: State) -> State:
    """Return what makes one state of the other, in the same order within each group; empty where they are the same."""
    moved = set() if list(before) == list(after) else _moved(before, after)
    gone = [name for name in before if name not in after or name in moved]
    new = {
        name: value
        for name, value in after.items()
        if name not in before or name in moved or not _same(before[name], value)
    }
    return {**({"drop": gone} if gone else {}), **({"set": new} if new else {})}


def group_of(name: str) -> str:
    """Return the group of a section ``GROUP:KEY``; one without a key is alone."""
    return name.partition(":")[0]


def _moved(before: State, after: State) -> Set[str]:
    """The sections that stand behind others of their group than before: new ones come last."""
    places = {name: place for place, name in enumerate(before)}
    last: Dict[str, float] = {}
    found: Set[str] = set()
    for name in after:
        group, place = group_of(name), places.get(name, math.inf)
        if place < last.get(group, -1):
            found.add(name)
            place = math.inf
        last[group] = place
    return found


def _apply(state: State, change: State) -> None:
    for name in change.get("drop", ()):
        state.pop(name, None)
    state.update(change.get("set", {}))


def _same(one: Any, other: Any) -> bool:
    return one is other or one == other


def _value(line: bytes, number: int) -> State:
    value = durable.opened(line)
    if value is None:
        raise JournalError(f"line {number + 1} is not as it was written")
    if value["n"] != number:
        raise JournalError(f"line {number + 1} is missing: record {value['n']} stands in its place")
    return value


def _header(value: State) -> Header:
    if not value:
        raise JournalError("line 1 is missing: there is no header")
    if value.get("format") != FORMAT:
        raise JournalError(f"line 1: it is of format {value.get('format')}, this version reads {FORMAT}")
    return Header(*(str(value[field]) for field in Header._fields))


def launch_of(data: bytes) -> str:
    """Return the launch that a journal says it is of, whatever is wrong with the rest; empty where it says none."""
    try:
        return str(json.loads(data.split(b"\n")[0])["launch"])
    except (ValueError, KeyError, TypeError):
        return ""


class JournalFolder:
    """The folder of a journal, which is this process's own until :meth:`close`.

    ``journal.jsonl.old`` is the journal that was set aside last, ``journal.jsonl.stale`` one that could not be
    written any more: what came later is not in it.
    """

    def __init__(self, folder: Path) -> None:
        """Take the folder, made where there is none; raises TakenError where another core has it, and OSError."""
        self.path = folder / "journal.jsonl"
        folder.mkdir(parents=True, exist_ok=True)
        self._lock: Optional[int] = os.open(folder / "lock", os.O_RDWR | os.O_CREAT, 0o644)
        self._file: Optional[int] = None
        self._size = self._first_size = self._number = 0
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self.close()
            if error.errno not in (errno.EACCES, errno.EAGAIN):
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

    def begin(self, header: Header, state: State) -> None:
        """Write all into a new file, which takes the place of the one that is; raises OSError."""
        data = line_of(0, header.record) + line_of(1, {"set": state})
        file = durable.replace(self.path, data)
        self._drop_file()
        self._file, self._size, self._first_size, self._number = file, len(data), len(data), 2

    def append(self, change: State) -> None:
        """Write one more record; raises OSError, and then nobody will take for the last state what stands there."""
        assert self._file is not None
        data = line_of(self._number, change)
        durable.write(self._file, data)
        self._size += len(data)
        self._number += 1

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
        self.fault = ""

    def write(self, state: State, now: float) -> None:
        """Have the ``state`` on disk; ``now`` is in seconds of a clock that only goes forward."""
        if self.fault and now - self._tried < self._retry:
            return
        try:
            self._write(state)
            self.fault = ""
        except OSError as error:
            self._written, self._tried = None, now
            self.fault = f"the journal {self._folder.path} cannot be written: {error.strerror or error}"
            with contextlib.suppress(OSError):
                self._folder.set_aside("stale")

    def _write(self, state: State) -> None:
        if self._written is None or self._folder.is_long:
            self._folder.begin(self._header, state)
        else:
            change = changes(self._written, state)
            if change:
                self._folder.append(change)
        self._written = state

    def close(self) -> None:
        """Write no more."""
        self._folder.close()


def lines_of(kept: Kept) -> Iterable[str]:
    """Yield a journal in words, for people."""
    yield f"run {kept.header.run}, {kept.records} records since all was written"
    for name, value in kept.state.items():
        yield f"{name} {json.dumps(value)}"
