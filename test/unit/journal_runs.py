"""Journals of runs for tests: a driven core receives goals, and each action returns as soon as it is sent."""

import shutil
import sqlite3
from contextlib import closing

from core_driver import soon
from kept_node import KeptCore

from rosoclingo.reasoning.journal.database import Header
from rosoclingo.reasoning.journal.folder import Journal
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.runs.journal_run import read_journal
from rosoclingo.runs.recorded_run import RunCollector, RunProgram
from rosoclingo.runs.run_view import RunView

GOALS = [("a", "goal(office3,office2,1)"), ("b", "goal(office2,office4,2)"), ("c", "goal(office1,office3,3)")]

#: Duration of an action in seconds, and the time at the start of the run.
LASTS, BEGIN = 5.0, 1000.0


def play(path, program, goals, fail_at=2, cancel_at=4, kept=None, settings=None, ends=tuple):
    """Play goals in turn, with a failure and a cancel; return the journal's path and all events.

    ``kept`` are settings that the journal has, ``settings`` those of the core; an action that fails is ``blocked``.
    ``ends`` selects the running actions that return.
    """
    published, clock = [], [BEGIN]
    description = RunProgram.of("first start", program, {"plan": "soon", **(kept or {})}).text()
    journal = Journal(path, Header("run", program.fingerprint, "", description))
    node = KeptCore(published.append, journal, program, settings or CoreSettings(), soon, lambda: clock[0])
    core = node.core
    core.start()
    node.keeper.send()
    for number in range(200):
        if number < len(goals):
            node.goal(*goals[number], stamp=(int(clock[0]), 0))
        if number == cancel_at:
            node.cancel(goals[1][0])
        node.run()
        clock[0] += LASTS
        for one in ends(core.awaited):
            value = "blocked" if number == fail_at else one.parameter
            core.receive("hand", [f"_return({one.interface},{value},{one.cycle})"])
            node.keeper.send()
        if not core.live_goals:
            break
    assert not core.live_goals
    node.keeper.close()
    return journal.path, published


def changed(file, to, statement):
    """Return a copy of a journal after a statement of SQL."""
    shutil.copy(file, to)
    with closing(sqlite3.connect(str(to))) as db, db:
        db.execute(statement)
    return to


def journal_run(file):
    """Return the run in a journal."""
    collector = RunCollector()
    read_journal(file, collector)
    (run,) = collector.runs()
    return run


def journal_view(file):
    """Return the view of the run in a journal."""
    view = RunView()
    read_journal(file, view)
    view.finish()
    return view
