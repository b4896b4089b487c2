"""What the plan on disk says goes out before the disk has that it does; should that be lost, it goes out again."""

import os
import shutil

import pytest
from core_driver import ERRANDS, shortest
from test_keeper import Node

from rosoclingo.common import durable
from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.reasoning import ActionsDispatched, CoreSettings, GoalChanged, Problem
from rosoclingo.reasoning.journal.folder import JournalFolder
from rosoclingo.reasoning.journal.keeper import Client
from rosoclingo.reasoning.journal.kept_core import KeptCore
from rosoclingo.reasoning.journal.lines import Header
from rosoclingo.reasoning.journal.resuming import open_journal

SETTINGS = CoreSettings(horizon_limit=8, search_timeout=0.0)
#: For a solver that takes errands in this order, or in the other.
FORWARDS = ERRANDS + "#program cumulative(t). #heuristic _action_lib(W,I,t) : asked(W,I,C). [10-I,true]"
BACKWARDS = FORWARDS.replace("10-I", "I")


class Disk:
    """Stands for a disk: how much of the file it has, and who else went out before it had all."""

    def __init__(self, node, monkeypatch):
        self.has, self.before = 0, []
        monkeypatch.setattr(os, "fdatasync", self._sync)
        node.at_event = lambda event: self.has == node.folder.path.stat().st_size or self.before.append(type(event))

    def _sync(self, file):
        self.has = os.fstat(file).st_size


@pytest.fixture
def node(tmp_path):
    """Its plan is to walk for 1, 2 and 3."""
    node = Node(tmp_path / "journal", ReactiveProgram.from_text(FORWARDS))
    for key in "123":
        ask(node, key)
    yield node.run()
    node.folder.close()


def ask(node, key):
    node.keeper.add(key, Client(f"do(walk,{key})", (1, 2)))
    node.keeper.keep()
    node.core.add_goal(key, f"do(walk,{key})")


def gone_out(events):
    return [str(action.atom) for event in events if isinstance(event, ActionsDispatched) for action in event.actions]


def test_what_the_plan_says_goes_out_at_once_and_what_else_is_told_once_the_disk_has_it(node, monkeypatch):
    disk = Disk(node, monkeypatch)
    assert gone_out(node.told) == ["_action_lib(walk,1,1)"]
    for number in (2, 3):
        node.told.clear()
        node.succeed()
        assert gone_out(node.told) == [f"_action_lib(walk,{number},{number})"]
        assert ActionsDispatched in disk.before
    node.succeed()
    assert any(isinstance(event, GoalChanged) for event in node.told)
    assert GoalChanged not in disk.before


@pytest.mark.parametrize("facts", [["_return(walk,failed,1)"], ["_seen(ball)", "_return(walk,1,1)"]])
def test_where_something_else_has_come_the_disk_is_waited_for(node, monkeypatch, facts):
    disk = Disk(node, monkeypatch)
    node.told.clear()
    node.core.receive("hand", facts)
    node.run()
    assert len(gone_out(node.told)) == 1
    assert ActionsDispatched not in disk.before


def gone_on(folder, text=BACKWARDS, doubtful=True, said="_return(walk,1,1)", new=None):
    """What another core tells that goes on with the journal in a folder when it hears of the first errand."""
    told, place = [], JournalFolder(folder)
    program = ReactiveProgram.from_text(text)
    record = place.read().state
    core = KeptCore(program, lambda: shortest(program), told.append, SETTINGS, record=record, doubtful=doubtful)
    place.close()
    core.start()
    if new is not None:
        core.add_goal("new", new)
    core.receive("hand", [said])
    while core.advance(1.0):
        pass
    return told


@pytest.fixture
def lost(node, tmp_path):
    """The journal as the disk has it after the next action went out."""
    before = tmp_path / "before"
    shutil.copytree(tmp_path / "journal", before)
    node.succeed()
    assert gone_out(node.told)[1:] == ["_action_lib(walk,2,2)"]
    return before


@pytest.mark.parametrize(("doubtful", "number"), [(True, 2), (False, 0)])
def test_what_may_have_been_begun_goes_out_again_whatever_else_could(lost, doubtful, number):
    told = gone_on(lost, doubtful=doubtful, new="do(walk,0)")
    assert gone_out(told) == [f"_action_lib(walk,{number},2)"]


def test_the_doubt_outlives_a_core(lost):
    place = JournalFolder(lost)
    state = place.read().state
    place.close()
    program, told = ReactiveProgram.from_text(BACKWARDS), []
    for doubtful in (True, False, False):
        told.clear()
        core = KeptCore(program, lambda: shortest(program), told.append, SETTINGS, record=state, doubtful=doubtful)
        state = core.record()
    core.add_goal("new", "do(walk,0)")
    core.receive("hand", ["_return(walk,1,1)"])
    assert core.advance(1.0)
    assert gone_out(told) == ["_action_lib(walk,2,2)"]


def test_what_comes_after_a_failure_is_open(lost):
    failed = "_return(walk,failed,1)"
    assert gone_out(gone_on(lost, said=failed)) == gone_out(gone_on(lost, doubtful=False, said=failed))


def test_what_cannot_be_begun_any_more_is_told(lost):
    told = gone_on(lost, BACKWARDS + "#program cumulative(t). :- _action_lib(walk,2,2), t = 2.")
    assert gone_out(told) == ["_action_lib(walk,3,2)"]
    (problem,) = (event.message for event in told if isinstance(event, Problem))
    assert "_action_lib(walk,2,2) may have been begun before the machine went down" in problem


def test_it_is_in_doubt_once_the_machine_was_started_anew(tmp_path, monkeypatch):
    first = Node(tmp_path)
    first.folder.close()
    header = Header("run", "program")

    def doubtful():
        found = open_journal(tmp_path, "yes", header)
        found.journal.close()
        return found.doubtful

    assert not doubtful()
    for boot in ("another", None):
        monkeypatch.setattr(durable, "machine", lambda boot=boot: boot)
        assert doubtful()


def test_the_machine_says_which_start_this_is(monkeypatch, tmp_path):
    durable.machine.cache_clear()
    monkeypatch.setattr(durable, "BOOT", tmp_path / "boot")
    assert durable.machine() is None
    durable.machine.cache_clear()
    (tmp_path / "boot").write_text("a-b\n")
    assert durable.machine() == "a-b"
    durable.machine.cache_clear()
