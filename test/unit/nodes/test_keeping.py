"""A core's node takes its journal."""

import pytest

from rosoclingo.nodes.core import keeping
from rosoclingo.reasoning.journal.database import Header
from rosoclingo.reasoning.journal.folder import Journal, LockedError

FRESH = Header("second", "program")


def test_it_waits_for_the_end_of_the_core_before(tmp_path, monkeypatch):
    before, waits = Journal(tmp_path), []

    def wait(seconds):
        waits.append(seconds)
        if len(waits) == 3:
            before.close()

    monkeypatch.setattr(keeping.time, "sleep", wait)
    monkeypatch.setattr(keeping.rospy, "is_shutdown", lambda: False)  # other tests may have ended this process's node
    found = keeping.take_journal(tmp_path, "ask", FRESH, patience=600.0)
    found.journal.close()
    assert (found.run, len(waits)) == ("second", 3)


def test_it_does_not_wait_for_ever(tmp_path):
    before = Journal(tmp_path)
    with pytest.raises(LockedError, match="another core uses the journal"):
        keeping.take_journal(tmp_path, "ask", FRESH, patience=0.0)
    before.close()
