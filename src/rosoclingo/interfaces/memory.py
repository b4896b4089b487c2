"""The actions that an interface has begun and answered in a run of the core, in a database that outlives the node.

No ROS. Each change is on the disk before anybody else can see it: before its goal is sent, before its answer goes out.
"""

import contextlib
import hashlib
import json
import os
import re
import sqlite3
from pathlib import Path
from typing import Dict, NamedTuple, Optional, Set, Tuple

KEPT = 1000  # limit of remembered answers, the latest ones; actions under way are always remembered
RUNS = 5  # number of runs that stay in the database beside the present one, the latest ones
RETRY = 2.0  # seconds of wall time between two attempts to write, after a write has failed

_TABLE = "CREATE TABLE IF NOT EXISTS action (run TEXT, action TEXT, goal TEXT, facts TEXT, PRIMARY KEY (run, action))"
_FORGET_RUNS = """
    DELETE FROM action WHERE run != ? AND run NOT IN
        (SELECT run FROM action GROUP BY run ORDER BY max(rowid) DESC LIMIT ?)"""


class Record(NamedTuple):
    """An action that was begun: the id of its last goal, and the facts of its answer, None without one."""

    goal: str
    facts: Optional[Tuple[str, ...]] = None


class ActionMemory:
    """The actions of the present run. ``folder`` has the database, None for none; ``owner`` identifies the interface.

    A disk that cannot be written stops nothing: ``trouble`` reports it, and each later change, and ``tend``, tries to
    write everything that the database lacks.
    """

    def __init__(self, folder: Optional[Path], owner: str) -> None:
        words = re.sub(r"[^A-Za-z0-9]+", "_", owner).strip("_")[:80]
        digest = hashlib.sha256(owner.encode(errors="surrogateescape")).hexdigest()[:8]
        self.path = None if folder is None else folder / f"{words}-{digest}.db"
        self.run: Optional[str] = None
        self._records: Dict[str, Record] = {}  # in the order of their last change
        self._unsaved: Set[str] = set()  # actions whose last change is not in the database
        self._db: Optional[sqlite3.Connection] = None
        self._damage = self._failure = ""
        self._retry_at = 0.0

    @property
    def trouble(self) -> str:
        """What is wrong with the database, for people; empty if nothing is."""
        return self._failure or self._damage

    def begin_run(self, run: str) -> bool:
        """Load the actions of this run in place of another one's; return False if it is the present run already."""
        if run == self.run:
            return False
        self.run, self._damage, self._failure = run, "", ""
        self._records.clear()
        self._unsaved.clear()
        try:
            self._load()
        except (OSError, sqlite3.Error) as error:
            self._damage = f"cannot read {self.path}: {error}: what was begun before is not known"
            self._set_aside(error)
        return True

    def recall(self, action: str) -> Optional[Record]:
        """Return what is known of an action (the atom's text); None if it was not begun in this run."""
        return self._records.get(action)

    def note_begun(self, action: str, goal: str) -> None:
        """Record that a goal is about to be sent for an action."""
        self._note(action, Record(goal))

    def note_answered(self, action: str, facts: Tuple[str, ...]) -> None:
        """Record an answer that is about to be given."""
        known = self._records.get(action)
        self._note(action, Record(known.goal if known else "", facts))

    def tend(self, wall: float) -> None:
        """Retry a failed write now and then; to be called often, with steady time in seconds."""
        if self._failure and wall >= self._retry_at:
            self._retry_at = wall + RETRY
            self._save()

    def close(self) -> None:
        """Close the database."""
        if self._db is not None:
            self._db.close()
        self._db = None

    def _note(self, action: str, record: Record) -> None:
        self._keep(action, record)
        self._save()

    def _keep(self, action: str, record: Record) -> None:
        self._records.pop(action, None)
        self._records[action] = record
        answered = [one for one, known in self._records.items() if known.facts is not None]
        for oldest in answered[:-KEPT]:
            del self._records[oldest]
        self._unsaved.update((action, *answered[:-KEPT]))

    def _load(self) -> None:
        if self.path is None or not self.path.exists():
            return
        query = "SELECT action, goal, facts FROM action WHERE run = ? ORDER BY rowid"
        for action, goal, facts in self._connected(self.path).execute(query, (self.run,)).fetchall():
            self._keep(action, Record(goal, None if facts is None else tuple(json.loads(facts))))
        self._unsaved.clear()

    def _save(self) -> None:
        """Write each change that the database lacks, and wait for the disk."""
        if self.path is None or self.run is None:
            return
        changed = [(one, record) for one, record in self._records.items() if one in self._unsaved]
        rows = [(self.run, one, goal, None if facts is None else json.dumps(facts)) for one, (goal, facts) in changed]
        gone = [(self.run, one) for one in self._unsaved - self._records.keys()]
        try:
            with self._connected(self.path) as db:
                db.executemany("REPLACE INTO action VALUES (?, ?, ?, ?)", rows)
                db.executemany("DELETE FROM action WHERE run = ? AND action = ?", gone)
                db.execute(_FORGET_RUNS, (self.run, RUNS + 1))
        except (OSError, sqlite3.Error) as error:
            mend = "goes on, but what is begun now is not known after a crash"
            self._failure = f"cannot write {self.path}: {error}: {mend}"
            self._set_aside(error)
        else:
            self._unsaved.clear()
            self._failure = ""

    def _connected(self, path: Path) -> sqlite3.Connection:
        """Return the open database; raises OSError, sqlite3.Error."""
        if self._db is None:
            path.parent.mkdir(parents=True, exist_ok=True)
            db = sqlite3.connect(str(path))
            for statement in ("PRAGMA journal_mode = WAL", "PRAGMA synchronous = FULL", _TABLE):
                db.execute(statement)
            self._db = db
        return self._db

    def _set_aside(self, error: Exception) -> None:
        """After an error that means a damaged database, rename it, so that the next write begins a new one."""
        damaged = isinstance(error, sqlite3.DatabaseError) and not isinstance(error, sqlite3.OperationalError)
        if self.path is None or not damaged:
            return
        self.close()
        self._unsaved.update(self._records)
        with contextlib.suppress(OSError):
            os.replace(self.path, f"{self.path}.damaged")
            for rest in ("-wal", "-shm"):
                Path(f"{self.path}{rest}").unlink()
