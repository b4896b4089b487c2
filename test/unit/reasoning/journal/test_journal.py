"""The journal on disk: what is read is what was written, whatever is cut off; what was changed is refused."""

import errno
import json
import os
import subprocess
import sys

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.reasoning.journal import folder as module
from rosoclingo.reasoning.journal.folder import Journal, JournalFolder, TakenError, tidy
from rosoclingo.reasoning.journal.lines import Header, JournalError, changes, line_of, lines_of, read

HEADER = Header("run", "program", "launch")
NAMES = st.sampled_from(["core", "goal:1", "goal:2", "goal:3", "fact:a", "fact:b"])
STATES = st.lists(st.tuples(NAMES, st.integers(0, 3)), unique_by=lambda one: one[0]).map(dict)


def in_groups(state):
    """A state in which only the order within groups counts."""
    groups = {}
    for name, value in state.items():
        groups.setdefault(name.partition(":")[0], []).append((name, value))
    return groups


def lines_for(states):
    """The lines of a journal of these states."""
    pairs = zip(states, states[1:])
    records = [HEADER.record, {"set": states[0]}, *filter(None, (changes(*pair) for pair in pairs))]
    return [line_of(number, record) for number, record in enumerate(records)]


def states_in(lines):
    """The state after each record but the header."""
    return [read(b"".join(lines[:end])).state for end in range(2, len(lines) + 1)]


@pytest.fixture
def folder(tmp_path):
    found = JournalFolder(tmp_path / "of" / "core")
    yield found
    found.close()


@given(st.lists(STATES, min_size=1, max_size=6))
def test_what_is_read_is_what_was_written(states):
    lines = lines_for(states)
    kept = read(b"".join(lines))
    assert in_groups(kept.state) == in_groups(states[-1])
    assert (kept.header, kept.records) == (HEADER, len(lines) - 1)


@given(st.lists(STATES, min_size=2, max_size=4))
def test_cut_anywhere_it_is_the_state_after_a_whole_record(states):
    lines = lines_for(states)
    data, known = b"".join(lines), states_in(lines)
    whole = len(lines[0]) + len(lines[1])
    for end in range(len(data)):
        if end < whole:
            with pytest.raises(JournalError, match=r"line [12] is missing"):
                read(data[:end])
        else:
            count = data[:end].count(b"\n")
            assert read(data[:end]).state == known[count - 2]


@given(st.lists(STATES, min_size=2, max_size=4), st.data())
def test_one_changed_byte_is_refused_at_its_line(states, data):
    text = b"".join(lines_for(states))
    place = data.draw(st.integers(0, len(text) - 1))
    byte = data.draw(st.integers(0, 255).filter(lambda one: one != text[place]))
    changed = text[:place] + bytes([byte]) + text[place + 1 :]
    with pytest.raises(JournalError, match=f"^line {text[:place].count(10) + 1} "):
        read(changed)


def test_a_line_that_is_missing_is_refused():
    lines = lines_for([{"core": 1}, {"core": 2}, {"core": 3}])
    with pytest.raises(JournalError, match="line 3 is missing: record 3 stands in its place"):
        read(b"".join(lines[:2] + lines[3:]))


def test_a_last_line_without_its_end_is_cut_off_and_one_with_another_is_refused():
    data = b"".join(lines_for([{"core": 1}, {"core": 2}]))
    assert [read(data).state, read(data[:-1]).state] == [{"core": 2}, {"core": 1}]
    with pytest.raises(JournalError, match="line 3 does not end as it was written"):
        read(data[:-1] + b" ")


@pytest.mark.parametrize(
    ("before", "after", "written"),
    [
        ("goal:1 goal:2", "goal:2 goal:1", "goal:1"),
        ("goal:1 goal:2 goal:3", "goal:3 goal:1 goal:2", "goal:1 goal:2"),
        ("core goal:1 goal:2", "goal:1 goal:2 core", ""),
        ("core fact:1 goal:1 fact:2 goal:2", "goal:1 core goal:2 fact:1 fact:2", ""),
    ],
)
def test_what_stands_elsewhere_in_its_group_is_written_anew(before, after, written):
    old, new = ({name: [name] for name in names.split()} for names in (before, after))
    moved = written.split()
    assert changes(old, new) == ({"drop": moved, "set": {name: [name] for name in moved}} if moved else {})


def test_another_format_is_refused():
    lines = [line_of(0, {**HEADER.record, "format": 99}), line_of(1, {"set": {}})]
    with pytest.raises(JournalError, match="line 1: it is of format 99, this version reads 4"):
        read(b"".join(lines))


def test_each_line_is_json_of_its_own(folder):
    folder.begin(HEADER, {"core": "\n\u00e4"})
    folder.append({"set": {"core": 2}})
    values = [json.loads(line) for line in folder.path.read_text().splitlines()]
    assert [value["n"] for value in values] == [0, 1, 2]
    assert values[0]["run"] == "run"


def test_only_what_has_changed_is_written(folder):
    journal = Journal(folder, HEADER)
    journal.write({"core": 1, "goal:1": "x" * 1000}, 0.0)
    size = folder.path.stat().st_size
    journal.write({"core": 1, "goal:1": "x" * 1000}, 0.0)
    assert folder.path.stat().st_size == size
    journal.write({"core": 2, "goal:1": "x" * 1000}, 0.0)
    assert size < folder.path.stat().st_size < size + 100
    assert folder.read().state == {"core": 2, "goal:1": "x" * 1000}


@pytest.mark.slow
def test_it_does_not_grow_without_end(folder, monkeypatch):
    monkeypatch.setattr(module, "LONG", 2000)
    journal, sizes = Journal(folder, HEADER), []
    for number in range(500):
        journal.write({"core": number, "goal:1": "x" * 100}, 0.0)
        sizes.append(folder.path.stat().st_size)
    assert max(sizes) < 2200
    assert folder.read().state == {"core": 499, "goal:1": "x" * 100}
    large = {f"goal:{number}": "x" * 100 for number in range(100)}
    inodes = set()
    for number in range(200):
        journal.write({"core": number, **large}, 0.0)
        inodes.add(folder.path.stat().st_ino)
    assert len(inodes) <= 3, "what is large is not written anew all the time"


def test_no_journal_yet(folder):
    assert folder.read() is None
    assert folder.set_aside("old") is None


def test_what_is_set_aside_is_no_journal_any_more(folder):
    folder.begin(HEADER, {"core": 1})
    aside = folder.set_aside("old")
    assert aside.name == "journal.jsonl.old"
    assert folder.read() is None
    assert read(aside.read_bytes()).state == {"core": 1}


def test_two_cores_on_one_journal(folder):
    with pytest.raises(JournalError, match=r"another core has the journal in .*: end it, or"):
        JournalFolder(folder.path.parent)
    folder.close()
    JournalFolder(folder.path.parent).close()


def test_a_core_that_was_killed_leaves_the_journal_to_others(tmp_path):
    code = (
        "import sys; from pathlib import Path;"
        "from rosoclingo.reasoning.journal.folder import *; from rosoclingo.reasoning.journal.lines import *;"
        "folder = JournalFolder(Path(sys.argv[1])); folder.begin(Header('a', 'b'), {'core': 1});"
        "print('ready', flush=True); input()"
    )
    command = [sys.executable, "-c", code, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as child:
        assert child.stdout.readline() == b"ready\n"
        with pytest.raises(JournalError):
            JournalFolder(tmp_path)
        child.kill()
        child.wait(30)
    folder = JournalFolder(tmp_path)
    assert folder.read().state == {"core": 1}
    folder.close()


def test_a_damaged_journal_tells_its_place_and_what_to_do(folder):
    folder.begin(HEADER, {"core": 1})
    folder.append({"set": {"core": 2}})
    data = folder.path.read_bytes()
    folder.path.write_bytes(data.replace(b'"core":2', b'"core":3'))
    with pytest.raises(JournalError) as caught:
        folder.read()
    text = str(caught.value)
    assert text.startswith(f"{folder.path}: line 3 is not as it was written: start without it")
    assert f"rosrun rosoclingo journal clear {folder.path.parent}" in text


class Disk:
    """Stands for os.write and os.fdatasync of a disk that fails from some time on."""

    def __init__(self, monkeypatch, call, number, partly=0):
        self.broken, self._number, self._partly, self._real = False, number, partly, getattr(os, call)
        monkeypatch.setattr(os, call, self)

    def __call__(self, file, *rest):
        if self.broken:
            if self._partly and rest:
                part, self._partly = self._partly, 0
                return self._real(file, bytes(rest[0])[:part])
            raise OSError(self._number, os.strerror(self._number))
        return self._real(file, *rest)


@pytest.mark.parametrize(
    ("call", "number", "partly"),
    [("write", errno.ENOSPC, 0), ("write", errno.ENOSPC, 9), ("write", errno.EIO, 0), ("fdatasync", errno.EIO, 0)],
)
def test_a_disk_that_fails_is_told_and_tried_again(folder, monkeypatch, call, number, partly):
    disk, journal = Disk(monkeypatch, call, number, partly), Journal(folder, HEADER, retry=10.0)
    journal.write({"core": 1}, 0.0)
    assert journal.fault == ""
    disk.broken = True
    journal.write({"core": 2}, 1.0)
    assert journal.fault == f"the journal {folder.path} cannot be written: {os.strerror(number)}"
    assert folder.read() is None, "what is out of date is no journal any more"
    disk.broken = False
    journal.write({"core": 3}, 10.9)
    assert journal.fault
    assert folder.read() is None
    journal.write({"core": 4}, 11.0)
    assert journal.fault == ""
    assert folder.read().state == {"core": 4}
    journal.write({"core": 5}, 11.1)
    assert folder.read().state == {"core": 5}


def test_a_disk_that_fails_later_is_told_as_well(folder, monkeypatch):
    disk, journal = Disk(monkeypatch, "fdatasync", errno.EIO), Journal(folder, HEADER, retry=10.0)
    journal.write({"core": 1}, 0.0)
    journal.settle(0.5)
    disk.broken = True
    journal.write({"core": 2}, 1.0, wait=False)
    assert journal.fault == ""
    journal.settle(1.5)
    assert journal.fault == f"the journal {folder.path} cannot be written: {os.strerror(errno.EIO)}"
    assert folder.read() is None
    disk.broken = False
    journal.settle(20.0)
    assert journal.fault, "there is nothing that is not on the disk; the next state is tried"
    journal.write({"core": 3}, 20.0)
    assert journal.fault == ""
    assert folder.read().state == {"core": 3}


def test_to_wait_for_the_disk_writes_nothing_anew(folder, monkeypatch):
    monkeypatch.setattr("rosoclingo.reasoning.journal.folder.LONG", 0)
    journal = Journal(folder, HEADER)
    journal.write({"core": 1}, 0.0, 5.0)
    journal.write({"core": 2, "more": "x" * 1000}, 1.0, 6.0, wait=False)
    written = folder.path.read_bytes()
    assert folder.is_long
    journal.settle(2.0)
    assert folder.path.read_bytes() == written


def test_a_disk_that_cannot_even_forget(folder, monkeypatch):
    journal = Journal(folder, HEADER)
    journal.write({"core": 1}, 0.0)

    def refuse(*_):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(os, "write", refuse)
    monkeypatch.setattr(os, "replace", refuse)
    journal.write({"core": 2}, 1.0)
    assert "Read-only file system" in journal.fault


def shelf_of(path, ages):
    """A shelf with a journal of each age, in seconds before its time 1e9; the names are the ages."""
    for age in ages:
        folder = JournalFolder(path / str(age))
        folder.begin(HEADER, {"core": 1})
        folder.close()
        for file in (path / str(age)).iterdir():
            os.utime(file, (1e9 - age, 1e9 - age))
    return path


def test_of_a_shelf_old_journals_go_but_for_the_latest(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "STAY", 2)
    week = int(module.YOUNG)
    shelf = shelf_of(tmp_path, [0, 10, week - 1, week + 1, week + 2])
    tidy(shelf, 1e9)
    assert {one.name for one in shelf.iterdir()} == {"0", "10", str(week - 1)}
    tidy(shelf, 1e9 + week)
    assert {one.name for one in shelf.iterdir()} == {"0", "10"}


def test_of_a_shelf_what_a_core_has_and_what_is_no_journal_stays(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "STAY", 0)
    shelf = shelf_of(tmp_path, [1, 2, 3])
    (shelf / "2" / "notes.txt").touch()
    (shelf / "mine").mkdir()
    (shelf / "word").touch()
    held = JournalFolder(shelf / "1")
    tidy(shelf, 1e9 + 2 * module.YOUNG)
    held.close()
    assert {one.name for one in shelf.iterdir()} == {"1", "2", "mine", "word"}
    assert (shelf / "1" / "journal.jsonl").exists()


def test_no_shelf_yet(tmp_path):
    tidy(tmp_path / "none", 1e9)
    assert not list(tmp_path.iterdir())


def test_a_folder_that_is_removed_while_it_is_taken_is_not_had(tmp_path, monkeypatch):
    lock = module.fcntl.flock

    def remove_first(file, how):
        (tmp_path / "lock").unlink()
        lock(file, how)

    monkeypatch.setattr(module.fcntl, "flock", remove_first)
    with pytest.raises(TakenError):
        JournalFolder(tmp_path)
    monkeypatch.undo()
    JournalFolder(tmp_path).close()


def test_a_journal_in_words(folder):
    folder.begin(HEADER, {"core": [1, 2], "goal:a": "x"})
    assert list(lines_of(folder.read())) == [
        "run run, 1 records since all was written",
        "core [1, 2]",
        'goal:a "x"',
    ]
