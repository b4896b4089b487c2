"""Journals of two runs, which several files read."""

import pytest
from core_driver import FORGETFUL
from journal_runs import GOALS, play
from shipped import shipped

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning.journal import folder

LABELS = {"office1": {"x": 1.0, "y": 2.0}, "office2": {"x": 5.0, "y": 2.0, "yaw": 1.5}}


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """A journal that goes back to the start, and the messages of its core."""
    program = shipped("mailbot.lp", "office.lp")
    return play(tmp_path_factory.mktemp("whole"), program, GOALS, kept={"labels": LABELS})


@pytest.fixture(scope="session")
def late(tmp_path_factory):
    """A journal that was rewritten during the run, after a compaction; and the messages of its core."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(folder, "RECORDS", 40)
        goals = [(str(number), f"do({number})") for number in range(1, 25)]
        return play(tmp_path_factory.mktemp("late"), ReactiveProgram.from_text(FORGETFUL), goals, None, None)
