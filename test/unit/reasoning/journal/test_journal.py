"""The journal on disk: every state that was written is read back, truncated or not; damaged bytes are refused."""

import os
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from contextlib import suppress
from pathlib import Path
from typing import ClassVar

import pytest
from full_disk import room_for
from hypothesis import given
from hypothesis import strategies as st
from killed_core import files_of, put_files

from rosoclingo.common import database
from rosoclingo.reasoning.journal import folder as module
from rosoclingo.reasoning.journal.database import NAME, Header, JournalError, history, read
from rosoclingo.reasoning.journal.folder import Journal, tidy

HEADER = Header("run", "program", "launch")
NAMES = st.sampled_from(["core:step", "goal:1", "goal:2", "goal:3", "fact:a", "fact:b"])
STATES = st.lists(st.tuples(NAMES, st.integers(0, 3)), unique_by=lambda one: one[0]).map(dict)


class StateJournal(Journal):
    """A journal to which whole states are written."""

    state: ClassVar = {}

    def put(self, state, now=0.0, time=0.0):
        """Write the changes of a state."""
        gone = [name for name in self.state if name not in state]
        new = {name: value for name, value in state.items() if self.state.get(name) != value}
        self.state = state
        self.write({"drop": gone, "set": new} if gone or new else {}, lambda: state, now, time)


def state_or_none(file):
    """Return the state in a journal, None if the journal is refused."""
    with suppress(JournalError):
        return read(file).state
    return None


@pytest.fixture
def folder(tmp_path):
    found = StateJournal(tmp_path / "of" / "core", HEADER)
    yield found
    found.close()


@pytest.fixture(scope="module")
def scratch(tmp_path_factory):
    """A folder for files that are assembled again and again."""
    return tmp_path_factory.mktemp("scratch")


@pytest.fixture(scope="module")
def killed(tmp_path_factory):
    """Return the files that a killed core leaves, the state after each record, and the log's length after each."""
    path, states, lengths = tmp_path_factory.mktemp("killed"), [], []
    folder = StateJournal(path, HEADER)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(database, "LOG_PAGES", 10**6)
        for number in range(12):
            states.append({"core": number, f"goal:{number}": "x" * 300, "goal:0": number // 3})
            folder.put(states[-1], time=float(number))
            lengths.append((path / f"{NAME}-wal").stat().st_size)
    files = files_of(path)
    folder.close()
    return files, states, lengths


@pytest.mark.slow
@given(st.lists(STATES, min_size=1, max_size=6))
def test_journal_reads_back_the_written_state(states):
    with tempfile.TemporaryDirectory() as name, pytest.MonkeyPatch.context() as patch:
        patch.setattr(database, "SYNCED", "OFF")
        folder = StateJournal(Path(name), HEADER)
        for number, state in enumerate(states):
            folder.put(state, time=float(number))
            assert folder.read().state == state
        header, moments = history(folder.path)
        new = [number for number in range(len(states)) if number == 0 or states[number - 1] != states[number]]
        assert [(dict(state), time) for state, time in moments] == [(states[number], float(number)) for number in new]
        assert (header, folder.read().records) == (HEADER, len(new))
        folder.close()


def test_journal_cut_anywhere_has_state_of_a_whole_record(killed, scratch):
    files, states, lengths = killed
    log = files[f"{NAME}-wal"]
    for end in sorted({*range(0, len(log), 997), *lengths, *(length - 1 for length in lengths)}):
        put_files(scratch, {**files, f"{NAME}-wal": log[:end]})
        folder, whole = Journal(scratch, HEADER), sum(length <= end for length in lengths)
        kept = folder.read()
        assert (kept.state if kept else None) == (states[whole - 1] if whole else None)
        folder.close()


@pytest.mark.slow
@given(st.data(), st.booleans())
def test_journal_with_one_changed_byte_is_refused_or_has_a_written_state(killed, scratch, data, in_log):
    """A change in the log can also lose the states after it."""
    files, states, _ = killed
    put_files(scratch, files)
    file = scratch / f"{NAME}-wal"
    if not in_log:
        folder = Journal(scratch, HEADER)
        file = folder.set_aside("old")
        folder.close()
    text = bytearray(file.read_bytes())
    text[data.draw(st.integers(0, len(text) - 1))] ^= data.draw(st.integers(1, 255))
    file.write_bytes(text)
    assert state_or_none(scratch / NAME if in_log else file) in (*(states if in_log else states[-1:]), None)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ("UPDATE record SET change = replace(change, '2', '3') WHERE number = 2", "record 2 is corrupt"),
        ("DELETE FROM record WHERE number = 2", "record 2 is missing"),
        ("DELETE FROM record", "record 1 is missing"),
        ("UPDATE header SET program = 'other'", "the header is missing or corrupt"),
        ("PRAGMA user_version = 99", "it is of format 99, this version reads 8"),
    ],
)
def test_journal_refuses_a_change_at_its_record(folder, change, words):
    folder.write({}, lambda: {"core": 1}, 0.0, 0.0)
    for number in (2, 3):
        folder.write({"set": {"core": number}}, None, 0.0, 1.0)
    folder.close()
    with sqlite3.connect(str(folder.path)) as db:
        db.execute(change)
    db.close()
    with pytest.raises(JournalError) as caught:
        folder.read()
    text = str(caught.value)
    assert text.startswith(f"{folder.path}: {words}: start without it")
    assert f"rosrun rosoclingo journal clear {folder.path.parent}" in text


def test_journal_refuses_files_of_another_kind(folder):
    folder.path.write_text("nothing of the kind\n" * 100)
    with pytest.raises(JournalError, match=r"it cannot be read as a journal \(file is not a database\): copy it again"):
        folder.read()


@pytest.mark.slow
def test_journal_size_stays_bounded(folder, monkeypatch):
    monkeypatch.setattr(module, "RECORDS", 20)
    monkeypatch.setattr(database, "SYNCED", "OFF")
    sizes, records = [], []
    for number in range(500):
        folder.put({"core": number, "goal:1": "x" * 100})
        records.append(folder.read().records)
        if number % 100 == 99:
            folder.close()
            sizes.append(folder.path.stat().st_size)
    assert records == [*range(1, 21)] * 25
    assert len(set(sizes)) == 1
    assert folder.read().state == {"core": 499, "goal:1": "x" * 100}


@pytest.mark.slow
def test_journal_of_a_killed_core_is_unlocked(tmp_path):
    code = (
        "import sys; from pathlib import Path;"
        "from rosoclingo.reasoning.journal.folder import *; from rosoclingo.reasoning.journal.database import *;"
        "folder = Journal(Path(sys.argv[1]), Header('a', 'b')); folder.write({}, lambda: {'core': 1}, 0.0, 0.0);"
        "print('ready', flush=True); input()"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdout.readline() == b"ready\n"
        with pytest.raises(JournalError):
            Journal(tmp_path, HEADER)
        child.kill()
        child.wait(30)
    folder = Journal(tmp_path, HEADER)
    assert folder.read().state == {"core": 1}
    folder.close()


def test_journal_reports_failing_disk_and_retries(folder):
    stale = Path(f"{folder.path}.stale")
    folder.put({"core": 1}, 0.0)
    assert folder.fault == ""
    with room_for(0):
        folder.put({"core": 2}, 1.0)
        assert folder.fault == f"the journal {folder.path} cannot be written: disk I/O error"
        assert folder.read() is None, "an outdated journal is set aside"
        folder.put({"core": 3}, 11.0)
        assert folder.fault, "the retry fails as well"
        assert not folder.path.exists()
    assert read(stale).state == {"core": 1}
    folder.put({"core": 4}, 20.9)
    assert folder.fault
    assert folder.read() is None
    folder.put({"core": 5}, 21.0)
    assert folder.fault == ""
    assert folder.read().state == {"core": 5}
    folder.put({"core": 6}, 21.1)
    assert folder.read().state == {"core": 6}


def test_journal_can_be_read_live_and_from_a_copy(folder, tmp_path):
    for number in range(3):
        folder.put({"core": number})
        shutil.copytree(folder.path.parent, tmp_path / str(number))
    assert [read(tmp_path / str(number) / NAME).state["core"] for number in range(3)] == [0, 1, 2]
    folder.close()
    assert [one.name for one in sorted(folder.path.parent.iterdir())] == [NAME, "lock"], "no log, for read-only folders"


def shelf_of(path, ages):
    """A shelf with a journal of each age, in seconds before its time 1e9; the names are the ages."""
    for age in ages:
        folder = Journal(path / str(age), HEADER)
        folder.write({}, lambda: {"core": 1}, 0.0, 0.0)
        folder.close()
        for file in (path / str(age)).iterdir():
            os.utime(file, (1e9 - age, 1e9 - age))
    return path


@pytest.mark.slow
def test_shelf_removes_old_journals_except_the_latest(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "STAY", 2)
    week = int(module.YOUNG)
    shelf = shelf_of(tmp_path, [0, 10, week - 1, week + 1, week + 2])
    tidy(shelf, 1e9)
    assert {one.name for one in shelf.iterdir()} == {"0", "10", str(week - 1)}
    tidy(shelf, 1e9 + week)
    assert {one.name for one in shelf.iterdir()} == {"0", "10"}


def test_shelf_keeps_locked_journals_and_other_files(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "STAY", 0)
    shelf = shelf_of(tmp_path, [1, 2, 3])
    (shelf / "2" / "notes.txt").touch()
    (shelf / "mine").mkdir()
    (shelf / "word").touch()
    held = Journal(shelf / "1", HEADER)
    tidy(shelf, 1e9 + 2 * module.YOUNG)
    held.close()
    assert {one.name for one in shelf.iterdir()} == {"1", "2", "mine", "word"}
    assert (shelf / "1" / "journal.db").exists()
