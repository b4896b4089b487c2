"""The memory of an interface: begun and answered actions, all of which survive its death."""

import tempfile
from pathlib import Path

import pytest
from full_disk import room_for
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.interfaces.memory import KEPT, RETRY, RUNS, ActionMemory, Record

PICKUP = "_action_lib(pickup,1,3)"
ANSWER = ("_return(pickup,1,3)",)


@pytest.fixture
def tmp_path():
    """A folder in memory: no test needs the data after a crash of the machine, so nothing waits for a disk."""
    with volatile_folder() as folder:
        yield Path(folder)


def volatile_folder():
    return tempfile.TemporaryDirectory(dir="/dev/shm" if Path("/dev/shm").is_dir() else None)


def copy_of(one, folder, wal_size):
    """Return what a crashed machine leaves: a memory's database, with this many bytes of its log."""
    log = Path(f"{one.path}-wal").read_bytes()
    (folder / one.path.name).write_bytes(one.path.read_bytes())
    (folder / f"{one.path.name}-wal").write_bytes(log[:wal_size])
    return memory(folder)


def wal_size(one):
    return Path(f"{one.path}-wal").stat().st_size


def memory(folder, run="first"):
    found = ActionMemory(folder, "/robot/pickup_interface pickup")
    found.begin_run(run)
    return found


def test_memory_without_a_readable_file_is_kept_by_the_process(tmp_path):
    one = ActionMemory(tmp_path, "a b")
    one.path.mkdir()
    one.begin_run("first")
    assert "cannot read" in one.trouble
    for unsaved in (one, memory(None)):
        unsaved.note_begun(PICKUP, "goal-1")
        assert unsaved.recall(PICKUP) == Record("goal-1")


@pytest.mark.parametrize("damage", [b"nonsense " * 1000, b"SQLite format 3\0" + b"\xff" * 4096])
def test_memory_damaged_database_is_reported_and_set_aside(tmp_path, damage):
    dead = memory(tmp_path)
    dead.note_begun(PICKUP, "goal-1")
    dead.close()
    dead.path.write_bytes(damage)
    heir = memory(tmp_path)
    assert heir.recall(PICKUP) is None
    assert "actions begun before are unknown" in heir.trouble
    assert Path(f"{heir.path}.damaged").read_bytes() == damage
    heir.note_begun(PICKUP, "goal-2")
    assert memory(tmp_path).recall(PICKUP) == Record("goal-2")


def test_memory_is_written_once_full_disk_has_room(tmp_path):
    one = memory(tmp_path)
    one.note_begun(PICKUP, "goal-1")
    with room_for(wal_size(one) + 10):
        one.note_answered(PICKUP, ANSWER)
        one.tend(100.0)
        assert "cannot write" in one.trouble
        assert "disk" in one.trouble
        assert memory(tmp_path).recall(PICKUP) == Record("goal-1"), "a partly written entry is not an answer"
    one.tend(100.0 + RETRY - 0.1)
    assert one.trouble
    one.tend(100.0 + RETRY)
    assert not one.trouble
    assert memory(tmp_path).recall(PICKUP) == Record("goal-1", ANSWER)


@pytest.mark.slow
def test_memory_keeps_last_answers_and_all_running_actions(tmp_path):
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


def test_memory_of_other_interfaces_has_separate_files(tmp_path):
    memory(tmp_path).note_begun(PICKUP, "goal-1")
    other = ActionMemory(tmp_path, "/robot_pickup/interface pickup")  # the same letters, divided differently
    other.begin_run("first")
    assert other.recall(PICKUP) is None


def test_memory_forgets_former_runs(tmp_path):
    for number in range(3 * RUNS):
        memory(tmp_path, f"run {number}").note_begun(PICKUP, f"goal-{number}")
    known = [memory(tmp_path, f"run {number}").recall(PICKUP) for number in range(3 * RUNS)]
    assert known == [None] * (2 * RUNS - 1) + [Record(f"goal-{one}") for one in range(2 * RUNS - 1, 3 * RUNS)]


ACTIONS = st.sampled_from([f"_action_lib(arm,{number},1)" for number in range(3)])
FACTS = st.tuples(st.text(max_size=5), st.just("_return(arm,1,1)"))
STEPS = st.one_of(
    st.tuples(st.just("begin"), ACTIONS, st.uuids().map(str)),
    st.tuples(st.just("answer"), ACTIONS, FACTS),
    st.tuples(st.just("run"), st.sampled_from(["r1", "r2"]), st.none()),
    st.tuples(st.just("die"), st.none(), st.none()),
)


def take(model, step):
    """Return the content of an immortal memory: run -> action -> Record."""
    kind, action, value = step
    if kind == "begin":
        model[action] = Record(value)
    elif kind == "answer":
        model[action] = Record(model[action].goal if action in model else "", value)


@given(st.lists(STEPS, max_size=30))
def test_memory_survives_deaths_and_runs_in_any_order(steps):
    with volatile_folder() as name:
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
def test_memory_survives_death_at_every_byte_of_file(steps, data):
    """Completely written entries are known; partially written ones never existed."""
    with volatile_folder() as name:
        dead, ends, models = memory(Path(name)), [0], [{}]
        for step in steps:
            models.append(dict(models[-1]))
            take(models[-1], step)
            dead.note_begun(*step[1:]) if step[0] == "begin" else dead.note_answered(*step[1:])
            ends.append(wal_size(dead))
        cut = data.draw(st.integers(0, ends[-1]))
        with volatile_folder() as other:
            heir = copy_of(dead, Path(other), cut)
        model = models[max(index for index, end in enumerate(ends) if end <= cut)]
        assert {step[1]: heir.recall(step[1]) for step in steps} == {step[1]: model.get(step[1]) for step in steps}
