"""A core's node locks its journal."""

import pytest

from rosoclingo.nodes.core import keeping
from rosoclingo.reasoning.journal.database import Header
from rosoclingo.reasoning.journal.folder import Journal, LockedError

FRESH = Header("second", "program")


def test_journal_lock_waits_for_end_of_previous_core(tmp_path, monkeypatch):
    before, waits = Journal(tmp_path), []

    def wait(seconds):
        waits.append(seconds)
        if len(waits) == 3:
            before.close()

    monkeypatch.setattr(keeping.time, "sleep", wait)
    monkeypatch.setattr(keeping.rospy, "is_shutdown", lambda: False)  # other tests can have ended this process's node
    found = keeping.take_journal(tmp_path, "ask", FRESH, patience=600.0)
    found.journal.close()
    assert (found.run, len(waits)) == ("second", 3)


def test_journal_lock_waits_for_a_limited_time(tmp_path):
    before = Journal(tmp_path)
    with pytest.raises(LockedError, match="another core uses the journal"):
        keeping.take_journal(tmp_path, "ask", FRESH, patience=0.0)
    before.close()
