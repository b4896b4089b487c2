"""Persistent record of the actions that an interface has begun and answered in a run of the core.

No ROS. Each change is synced to disk before it becomes visible: before the goal or the answer is sent.
"""

import hashlib
import json
import re
import sqlite3
from pathlib import Path
from typing import Dict, NamedTuple, Optional, Set, Tuple

from rosoclingo.common.database import Database

KEPT = 1000  # limit of remembered answers, the latest; running actions are always remembered
RUNS = 5  # limit of previous runs in the database, the latest
RETRY = 2.0  # seconds of wall time between a failed write and the next attempt

_TABLE = "CREATE TABLE IF NOT EXISTS action (run TEXT, action TEXT, goal TEXT, facts TEXT, PRIMARY KEY (run, action))"
_FORGET_RUNS = """
    DELETE FROM action WHERE run != ? AND run NOT IN
        (SELECT run FROM action GROUP BY run ORDER BY max(rowid) DESC LIMIT ?)"""


class Record(NamedTuple):
    """A begun action: the id of its last goal, and the facts of its answer (None before the answer)."""

    goal: str
    facts: Optional[Tuple[str, ...]] = None


class ActionMemory:
    """Actions of the present run; the database is in ``folder`` (None: no database), ``owner`` names the interface.

    A failed write raises nothing: ``trouble`` reports it. Each later change, and ``tend``, writes the missing changes.
    """

    def __init__(self, folder: Optional[Path], owner: str) -> None:
        words = re.sub(r"[^A-Za-z0-9]+", "_", owner).strip("_")[:80]
        digest = hashlib.sha256(owner.encode(errors="surrogateescape")).hexdigest()[:8]
        self._db = None if folder is None else Database(folder / f"{words}-{digest}.db", [_TABLE], RETRY)
        self.run: Optional[str] = None
        self._records: Dict[str, Record] = {}  # in the order of their last change
        self._unsaved: Set[str] = set()  # actions whose last change is not in the database
        self._damage = ""

    @property
    def path(self) -> Optional[Path]:
        """The file of the database, None without a database."""
        return None if self._db is None else self._db.path

    @property
    def trouble(self) -> str:
        """The problem with the database, for people; empty if there is none."""
        if self._db is None or not self._db.fault:
            return self._damage
        consequence = "continuing, but after a crash, actions begun now will be unknown"
        return f"cannot write {self.path}: {self._db.fault}: {consequence}"

    def begin_run(self, run: str) -> bool:
        """Load the actions of a run and forget the present run; return False if it is the present run."""
        if run == self.run:
            return False
        self.run, self._damage = run, ""
        self._records.clear()
        if self._db is not None and self._db.path.exists():
            self._load(self._db)
        self._unsaved.clear()
        return True

    def recall(self, action: str) -> Optional[Record]:
        """Return the record of an action (the atom's text), None if the action was not begun in this run."""
        return self._records.get(action)

    def note_begun(self, action: str, goal: str) -> None:
        """Record an action and the id of its goal; call this before sending the goal."""
        self._keep(action, Record(goal))
        self._save()

    def note_answered(self, action: str, facts: Tuple[str, ...]) -> None:
        """Record the facts of an answer; call this before sending them."""
        known = self._records.get(action)
        self._keep(action, Record(known.goal if known else "", facts))
        self._save()

    def tend(self, wall: float) -> None:
        """Retry a failed write every RETRY seconds; call this often, with steady time in seconds."""
        if self._db is not None and self._db.is_due(wall):
            self._save(wall)

    def close(self) -> None:
        """Close the database."""
        if self._db is not None:
            self._db.close()

    def _keep(self, action: str, record: Record) -> None:
        self._records.pop(action, None)
        self._records[action] = record
        answered = [one for one, known in self._records.items() if known.facts is not None]
        for oldest in answered[:-KEPT]:
            del self._records[oldest]
        self._unsaved.update((action, *answered[:-KEPT]))

    def _load(self, database: Database) -> None:
        query = "SELECT action, goal, facts FROM action WHERE run = ? ORDER BY rowid"
        rows = database.run(lambda db: db.execute(query, (self.run,)).fetchall())
        if rows is None:
            self._damage = f"cannot read {database.path}: {database.fault}: actions begun before are unknown"
            database.fault = ""
        for action, goal, facts in rows or ():
            self._keep(action, Record(goal, None if facts is None else tuple(json.loads(facts))))

    def _save(self, wall: float = 0.0) -> None:
        """Write the missing changes to the database, and sync it."""
        if self._db is None or self.run is None:
            return
        changed = [(one, record) for one, record in self._records.items() if one in self._unsaved]
        rows = [(self.run, one, goal, None if facts is None else json.dumps(facts)) for one, (goal, facts) in changed]
        gone = [(self.run, one) for one in self._unsaved - self._records.keys()]

        def write(db: sqlite3.Connection) -> bool:
            """Write the changes, and delete the oldest runs."""
            db.executemany("REPLACE INTO action VALUES (?, ?, ?, ?)", rows)
            db.executemany("DELETE FROM action WHERE run = ? AND action = ?", gone)
            db.execute(_FORGET_RUNS, (self.run, RUNS + 1))
            return True

        if self._db.run(write, wall):
            self._unsaved.clear()
        else:  # a damaged database is replaced by an empty one, which needs all records
            self._unsaved.update(self._records)
