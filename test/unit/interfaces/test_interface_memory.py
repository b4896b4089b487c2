"""What an interface has begun and answered, and that its death costs none of it."""

import os
import resource
import tempfile
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.durable import sealed
from rosoclingo.interfaces.memory import KEPT, RETRY, RUNS, ActionMemory, Record

PICKUP = "_action_lib(pickup,1,3)"
ANSWER = ("_return(pickup,1,3)",)


@pytest.fixture(autouse=True, scope="module")
def _no_power_cut():
    """Nothing here outlives the machine: no disk is waited for."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("rosoclingo.interfaces.memory.os.fdatasync", lambda descriptor: None)
        yield


def memory(folder, run="first"):
    found = ActionMemory(folder, "/robot/pickup_interface pickup")
    found.begin_run(run)
    return found


def test_a_successor_knows_what_was_begun_and_answered(tmp_path):
    dead = memory(tmp_path)
    dead.note_begun(PICKUP, "goal-1")
    assert memory(tmp_path).recall(PICKUP) == Record("goal-1")
    dead.note_answered(PICKUP, ANSWER)
    assert memory(tmp_path).recall(PICKUP) == Record("goal-1", ANSWER)
    assert memory(tmp_path).recall("_action_lib(pickup,1,4)") is None


def test_the_last_goal_of_an_action_counts(tmp_path):
    dead = memory(tmp_path)
    dead.note_begun(PICKUP, "goal-1")
    dead.note_begun(PICKUP, "goal-2")
    assert memory(tmp_path).recall(PICKUP) == Record("goal-2")


def test_another_run_is_another_story(tmp_path):
    one = memory(tmp_path)
    one.note_answered(PICKUP, ANSWER)
    assert not one.begin_run("first")
    assert one.begin_run("second")
    assert one.recall(PICKUP) is None
    one.note_begun(PICKUP, "goal-2")
    assert memory(tmp_path, "second").recall(PICKUP) == Record("goal-2")
    assert memory(tmp_path).recall(PICKUP) == Record("", ANSWER)


def test_other_interfaces_have_files_of_their_own(tmp_path):
    memory(tmp_path).note_begun(PICKUP, "goal-1")
    other = ActionMemory(tmp_path, "/robot_pickup/interface pickup")  # the same letters, cut in another way
    other.begin_run("first")
    assert other.recall(PICKUP) is None


def test_without_a_folder_there_is_no_file():
    one = memory(None)
    one.note_begun(PICKUP, "goal-1")
    assert one.path is None
    assert one.recall(PICKUP) == Record("goal-1")


def test_a_line_that_was_not_finished_is_cut_off_and_the_next_is_whole(tmp_path):
    dead = memory(tmp_path)
    dead.note_begun(PICKUP, "goal-1")
    whole = dead.path.read_bytes()
    dead.note_answered(PICKUP, ANSWER)
    dead.path.write_bytes(dead.path.read_bytes()[:-1])
    heir = memory(tmp_path)
    assert heir.recall(PICKUP) == Record("goal-1")
    assert not heir.trouble
    assert heir.path.read_bytes() == whole
    heir.note_answered(PICKUP, ANSWER)
    assert memory(tmp_path).recall(PICKUP) == Record("goal-1", ANSWER)


@pytest.mark.parametrize(
    "line",
    [b"nonsense", b'{"crc":"00000000","action":"a","goal":"b"}', sealed({"action": 3})[:-1], b"\xff\xfe", b"", b"{"],
)
def test_a_damaged_line_is_told_and_left_out(tmp_path, line):
    dead = memory(tmp_path)
    dead.note_begun(PICKUP, "goal-1")
    dead.path.write_bytes(line + b"\n" + dead.path.read_bytes())
    heir = memory(tmp_path)
    assert heir.recall(PICKUP) == Record("goal-1")
    assert "line 1" in heir.trouble


def test_a_disk_that_cannot_be_written_is_told_and_stops_nothing(tmp_path):
    folder = tmp_path / "folder"
    one = memory(folder)
    folder.write_text("in the way")
    one.note_begun(PICKUP, "goal-1")
    assert "cannot write" in one.trouble
    assert one.recall(PICKUP) == Record("goal-1")
    folder.unlink()
    one.note_answered("_action_lib(pickup,2,3)", ANSWER)
    assert not one.trouble
    assert memory(folder).recall(PICKUP) == Record("goal-1")  # with what could not be written before


def test_a_full_disk_that_has_room_again_is_written_without_anything_new(tmp_path):
    one = memory(tmp_path)
    one.note_begun(PICKUP, "goal-1")
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (one.path.stat().st_size + 10, limit[1]))  # EFBIG in place of ENOSPC
    try:
        one.note_answered(PICKUP, ANSWER)
        one.tend(100.0)
        assert "cannot write" in one.trouble
        assert "File too large" in one.trouble
        assert memory(tmp_path).recall(PICKUP) == Record("goal-1"), "what is half written is not taken for an answer"
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    one.tend(100.0 + RETRY - 0.1)
    assert one.trouble
    one.tend(100.0 + RETRY)
    assert not one.trouble
    assert memory(tmp_path).recall(PICKUP) == Record("goal-1", ANSWER)


def test_a_file_that_cannot_be_read_is_told(tmp_path):
    one = ActionMemory(tmp_path, "a b")
    one.run = "first"
    one.path.mkdir()
    one.run = None
    one.begin_run("first")
    assert "cannot read" in one.trouble


def test_each_line_is_on_the_disk_before_the_action_goes_on(tmp_path, monkeypatch):
    one, synced = memory(tmp_path), []
    monkeypatch.setattr("rosoclingo.interfaces.memory.os.fdatasync", lambda file: synced.append(os.fstat(file).st_size))
    for number in range(3):
        one.note_begun(PICKUP, f"goal-{number}")
        assert one.path.stat().st_size in synced


def test_the_last_answers_are_kept_and_all_that_is_under_way(tmp_path):
    one = memory(tmp_path)
    one.note_begun(PICKUP, "goal-1")
    largest = 0
    for cycle in range(6 * KEPT):
        one.note_answered(f"_action_lib(pickup,2,{cycle})", (f"_return(pickup,2,{cycle})",))
        if cycle % KEPT == 0:
            largest = max(largest, one.path.stat().st_size)
    for known in (one, memory(tmp_path)):
        assert known.recall(PICKUP) == Record("goal-1")
        assert known.recall(f"_action_lib(pickup,2,{5 * KEPT - 1})") is None
        assert known.recall(f"_action_lib(pickup,2,{5 * KEPT})") is not None
    assert largest < 1_000_000


def test_files_of_former_runs_go(tmp_path):
    for number in range(3 * RUNS):
        memory(tmp_path, f"run {number}").note_begun(PICKUP, f"goal-{number}")
    assert len(list(tmp_path.iterdir())) == RUNS + 1
    assert memory(tmp_path, f"run {3 * RUNS - 1}").recall(PICKUP) == Record(f"goal-{3 * RUNS - 1}")


ACTIONS = st.sampled_from([f"_action_lib(arm,{number},1)" for number in range(3)])
FACTS = st.tuples(st.text(max_size=5), st.just("_return(arm,1,1)"))
STEPS = st.one_of(
    st.tuples(st.just("begin"), ACTIONS, st.uuids().map(str)),
    st.tuples(st.just("answer"), ACTIONS, FACTS),
    st.tuples(st.just("run"), st.sampled_from(["r1", "r2"]), st.none()),
    st.tuples(st.just("die"), st.none(), st.none()),
)


def take(model, step):
    """What a memory that never dies would know: run -> action -> Record."""
    kind, action, value = step
    if kind == "begin":
        model[action] = Record(value)
    elif kind == "answer":
        model[action] = Record(model[action].goal if action in model else "", value)


@given(st.lists(STEPS, max_size=30))
def test_deaths_and_runs_in_any_order(steps):
    with tempfile.TemporaryDirectory() as name:
        one, models, run = memory(Path(name), "r1"), {"r1": {}, "r2": {}}, "r1"
        for step in steps:
            take(models[run], step)
            kind, action, value = step
            if kind == "begin":
                one.note_begun(action, value)
            elif kind == "answer":
                one.note_answered(action, value)
            elif kind == "run":
                run = action
                one.begin_run(run)
            else:
                one = memory(Path(name), run)
            assert {key: one.recall(key) for key in models[run]} == models[run]


@given(st.lists(STEPS.filter(lambda step: step[0] in ("begin", "answer")), min_size=1, max_size=8), st.data())
def test_a_death_at_every_byte_of_the_file(steps, data):
    """What was written whole is known, what was not is as if it had never been."""
    with tempfile.TemporaryDirectory() as name:
        dead, ends, models = memory(Path(name)), [0], [{}]
        for step in steps:
            models.append(dict(models[-1]))
            take(models[-1], step)
            dead.note_begun(*step[1:]) if step[0] == "begin" else dead.note_answered(*step[1:])
            ends.append(dead.path.stat().st_size)
        cut = data.draw(st.integers(0, ends[-1]))
        dead.path.write_bytes(dead.path.read_bytes()[:cut])
        heir = memory(Path(name))
        model = models[max(index for index, end in enumerate(ends) if end <= cut)]
        assert {step[1]: heir.recall(step[1]) for step in steps} == {step[1]: model.get(step[1]) for step in steps}
