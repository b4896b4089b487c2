"""Decide at the start of a core whether it resumes from an existing journal."""

import errno
import os
import sqlite3

import pytest

from rosoclingo.reasoning.journal import journal_command
from rosoclingo.reasoning.journal.database import Header, JournalError
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.journal.resuming import open_journal

BEFORE = Header("first", "program", "launch 1")
AGAIN = Header("second", "program", "launch 1")
STATE = {"core:step": 7, "goal:a": {"term": "goal(1)"}, "goal:b": {"term": "goal(2)"}}


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "core"


@pytest.fixture
def left(folder):
    """Create a journal that a core has left behind."""
    place = Journal(folder, BEFORE)
    place.write({}, lambda: STATE, 0.0, 0.0)
    place.close()
    return place.path


def opened(folder, resume, header):
    found = open_journal(folder, resume, header)
    if found.journal is not None:
        found.journal.close()
    return found


def test_start_without_journal(folder):
    assert opened(None, "yes", AGAIN)[:3] == (None, "second", None)


@pytest.mark.parametrize(("resume", "launch"), [("ask", "launch 1"), ("yes", "launch 2"), ("yes", "")])
def test_start_resumes_from_journal(folder, left, resume, launch):
    found = opened(folder, resume, AGAIN._replace(launch=launch))
    assert (found.run, found.state, found.odd) == ("first", STATE, False)
    assert found.remarks == [f"resumes from {left}: run first, cycle 7, 2 open goals"]


@pytest.mark.parametrize(("resume", "launch"), [("ask", "launch 2"), ("ask", ""), ("no", "launch 1")])
def test_start_begins_a_new_run_on_request(folder, left, resume, launch):
    found = opened(folder, resume, AGAIN._replace(launch=launch))
    assert (found.run, found.state) == ("second", None)
    assert not left.exists()
    assert (folder / "journal.db.old").exists()
    assert found.odd == (resume == "ask")
    assert ("2 open goals" in "".join(found.remarks)) == (resume == "ask")


def test_start_refuses_journal_of_another_program(folder, left):
    with pytest.raises(JournalError, match=r"belongs to another program .*: start that program, ignore the journal"):
        opened(folder, "ask", AGAIN._replace(program="other"))
    assert left.exists()


def test_start_refuses_damaged_journal(folder, left):
    with sqlite3.connect(str(left)) as db:
        db.execute("UPDATE record SET change = replace(change, 'goal(2)', 'goal(3)')")
    db.close()
    with pytest.raises(JournalError, match="record 1 is corrupt: start"):
        opened(folder, "yes", AGAIN)
    found = opened(folder, "ask", AGAIN._replace(launch="launch 2"))
    assert found.odd, "another launch begins a new run, and warns"


def test_start_fails_if_journal_is_unreadable(folder):
    """Check that the journal is refused and its folder is unlocked."""
    (folder / "journal.db").mkdir(parents=True)
    for _ in range(2):
        with pytest.raises(JournalError, match="it cannot be read as a journal"):
            open_journal(folder, "yes", AGAIN)


def test_start_reports_folder_that_is_not_writable(folder, monkeypatch):
    def refuse(*_, **__):
        raise OSError(errno.EROFS, os.strerror(errno.EROFS))

    monkeypatch.setattr(os, "open", refuse)
    found = opened(folder, "ask", AGAIN)
    assert (found.journal, found.run, found.state) == (None, "second", None)
    assert found.fault.startswith(f"no journal is kept in {folder}: Read-only file system (set ~journal to ")


def test_start_reports_a_stale_journal(folder, left):
    left.rename(f"{left}.stale")
    found = opened(folder, "yes", AGAIN)
    assert found.state is None
    assert "nothing is resumed: the disk failed" in found.remarks[0]


def test_journal_command_shows_and_clears(folder, left, capsys):
    assert journal_command.main("show", str(folder)) == 0
    assert capsys.readouterr().out.splitlines()[0] == "run first, 1 records since the last checkpoint"
    core = Journal(folder, BEFORE)
    assert journal_command.main("clear", str(folder)) == 1
    assert "another core uses the journal" in capsys.readouterr().err
    core.close()
    assert journal_command.main("clear", str(folder)) == 0
    assert capsys.readouterr().out == "removed journal.db\n"
    assert not left.exists()
    assert journal_command.main("show", str(folder)) == 1
    assert "No such file" in capsys.readouterr().err
