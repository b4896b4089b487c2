"""What an interface has begun and answered in a run of the core, kept in a file that outlives it.  No ROS.

A line (:mod:`rosoclingo.common.durable`) for each thing that happened, written before anybody else can see it:
`{"action": "_action_lib(pickup,1,3)", "goal": ID}` for a goal that is sent, `{"action": ..., "facts": [...]}` for an
answer. Each run of the core has a file of its own.
"""

import contextlib
import hashlib
import os
import re
from collections import OrderedDict
from pathlib import Path
from typing import Any, Dict, List, NamedTuple, Optional, Tuple

from rosoclingo.common import durable

KEPT = 1000  # answers that are remembered, the last ones; what is under way is remembered whatever it takes
RUNS = 5  # files of former runs that stay, the last ones

RETRY = 2.0  # seconds of wall time after which a file that could not be written is tried again

_SLACK = 4 * KEPT  # lines beyond those needed with which a file is written anew


class Record(NamedTuple):
    """What is known of an action that was begun: the id of its last goal; its answer's facts, None without one."""

    goal: str
    facts: Optional[Tuple[str, ...]] = None


class ActionMemory:
    """The actions of the present run. ``folder`` holds the files, None for none; ``owner`` names whose they are.

    A disk that cannot be written stops nothing: ``trouble`` says what is wrong, and all is tried again with each
    further line, and by ``tend``.
    """

    def __init__(self, folder: Optional[Path], owner: str) -> None:
        self._folder, self._owner = folder, owner
        self._records: OrderedDict[str, Record] = OrderedDict()
        self._file: Optional[int] = None
        self._lines = self._answered = 0
        self._damage = self._failure = ""
        self._retry_at = 0.0
        self.run: Optional[str] = None

    @property
    def trouble(self) -> str:
        """What is wrong with the file, for people; empty where nothing is."""
        return self._failure or self._damage

    def begin_run(self, run: str) -> bool:
        """Know what the file of this run knows, and forget any other; False if it is the present one already."""
        if run == self.run:
            return False
        self.close()
        self.run, self._damage, self._failure = run, "", ""
        self._records.clear()
        self._lines = self._answered = 0
        self._read()
        return True

    def recall(self, action: str) -> Optional[Record]:
        """What is known of an action (the atom's text); None if it was not begun in this run."""
        return self._records.get(action)

    def note_begun(self, action: str, goal: str) -> None:
        """Record that a goal is about to be sent for an action."""
        self._take(action, Record(goal))
        self._write({"action": action, "goal": goal})

    def note_answered(self, action: str, facts: Tuple[str, ...]) -> None:
        """Record an answer that is about to be given."""
        known = self._records.get(action)
        self._take(action, Record(known.goal if known else "", facts))
        self._write({"action": action, "facts": list(facts)})

    def tend(self, wall: float) -> None:
        """Now and then write what could not be written; to be called often, with steady time in seconds."""
        if self._failure and wall >= self._retry_at:
            self._retry_at = wall + RETRY
            self._rewrite()

    def close(self) -> None:
        """Close the file."""
        if self._file is not None:
            os.close(self._file)
        self._file = None

    def _take(self, action: str, record: Record) -> None:
        known = self._records.pop(action, None)
        self._answered += (record.facts is not None) - (known is not None and known.facts is not None)
        self._records[action] = record
        if self._answered > KEPT:
            oldest = next(action for action, record in self._records.items() if record.facts is not None)
            del self._records[oldest]
            self._answered -= 1

    # ---- the file -------------------------------------------------------------------------------------------------

    @property
    def path(self) -> Optional[Path]:
        """The file of the present run; None where there is none."""
        if self._folder is None or self.run is None:
            return None
        return self._folder / f"{self._stem}{_digest(self.run)}.jsonl"

    @property
    def _stem(self) -> str:
        words = re.sub(r"[^A-Za-z0-9]+", "_", self._owner).strip("_")[:80]
        return f"{words}-{_digest(self._owner)[:8]}-"

    def _read(self) -> None:
        path = self.path
        try:
            data = path.read_bytes() if path is not None else b""
        except FileNotFoundError:
            return
        except OSError as error:
            self._damage = f"cannot read {path}: {error.strerror}: what was begun before is not known"
            return
        *lines, unfinished = data.split(b"\n")  # the last is one that was never finished, or empty
        damaged = [number for number, line in enumerate(lines, 1) if not self._take_line(line)]
        if damaged:
            self._damage = f"{path}, line {damaged[0]}: is damaged, and left out"
        if lines and (damaged or unfinished):
            self._rewrite()
        elif lines and path is not None:
            with contextlib.suppress(OSError):  # then the next line finds no file, and writes one anew
                self._file, self._lines = os.open(path, os.O_WRONLY | os.O_APPEND), len(lines)

    def _take_line(self, line: bytes) -> bool:
        value = _decoded(line)
        if value is None:
            return False
        known = self._records.get(value["action"])
        if "goal" in value:
            self._take(value["action"], Record(value["goal"]))
        else:
            self._take(value["action"], Record(known.goal if known else "", tuple(value["facts"])))
        return True

    def _write(self, value: Dict[str, Any]) -> None:
        if self.path is None:
            return
        if self._file is None or self._lines > len(self._records) + _SLACK:
            self._rewrite()  # with all that is known, this too
            return
        try:
            durable.write(self._file, durable.sealed(value))
        except OSError as error:
            self._fail(error)
        else:
            self._lines += 1

    def _rewrite(self) -> None:
        """Write all that is known into a new file, which takes the old one's place at once."""
        self.close()
        path = self.path
        if path is None:
            return
        lines = [line for action, record in self._records.items() for line in _lines(action, record)]
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._forget_runs(path)
            self._file = durable.replace(path, b"".join(lines))
        except OSError as error:
            self._fail(error)
        else:
            self._lines, self._failure = len(lines), ""

    def _fail(self, error: OSError) -> None:
        self.close()
        self._failure = (
            f"cannot write {self.path}: {error.strerror}: goes on, but what is begun now is not known after a crash"
        )

    def _forget_runs(self, path: Path) -> None:
        """Remove the files of this owner's former runs, but for the last ones."""
        former = [one for one in path.parent.glob(f"{self._stem}*.jsonl") if one != path]
        for old in sorted(former, key=_age)[:-RUNS]:
            with contextlib.suppress(OSError):
                old.unlink()


def _lines(action: str, record: Record) -> List[bytes]:
    begun = [durable.sealed({"action": action, "goal": record.goal})] if record.goal else []
    facts = record.facts
    return begun if facts is None else [*begun, durable.sealed({"action": action, "facts": list(facts)})]


def _decoded(line: bytes) -> Optional[Dict[str, Any]]:
    """What a line says; None if it is not as it was written."""
    value = durable.opened(line)
    if value is None:
        return None
    known = isinstance(value.get("action"), str)
    return value if known and (isinstance(value.get("goal"), str) or isinstance(value.get("facts"), list)) else None


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode(errors="surrogateescape")).hexdigest()[:16]


def _age(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0
