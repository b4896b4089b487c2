"""The command ``replay`` on bags: recorded runs, and bags without a run."""

from functools import partial
from pathlib import Path

import pytest
from core_driver import Driver, soon
from journal_runs import changed
from shipped import shipped

from rosoclingo.reasoning.events import ActionsDispatched, PlanMade, UpdateSent
from rosoclingo.reasoning.journal.database import NAME
from rosoclingo.reasoning.settings import CoreSettings
from rosoclingo.runs.recorded_run import RunProgram

ENCODINGS = Path(__file__).resolve().parents[3] / "encodings"


@pytest.fixture(scope="module")
def driver():
    """A run of the mailbot with a goal."""
    driver = Driver(settings=CoreSettings(), program=shipped("mailbot.lp", "office.lp"), solver=soon)
    return driver.goal("key", "goal(office3,office2,1)").finish()


@pytest.fixture
def replay(run_command):
    """Run the command."""
    from rosoclingo.nodes.recording.replaying import main

    return partial(run_command, main)


@pytest.fixture
def write(messages, write_bag, driver):
    """Write a bag of the run, without ``left_out`` topics, of cores in some namespaces."""
    from std_msgs.msg import String

    def to_messages(event):
        if isinstance(event, UpdateSent):
            yield "rosoclingo/updates", String(event.stream)
        elif isinstance(event, PlanMade):
            actions = [str(one.atom) for one in event.actions]
            yield "rosoclingo/task_plan", messages.TaskPlan(cycle=event.cycle, horizon=event.horizon, actions=actions)
        elif isinstance(event, ActionsDispatched):
            facts = [str(one.atom) for one in event.actions]
            yield "out_rosoclingo", messages.InterfaceIO("all", facts)

    def write(left_out=(), spaces=("/",), change=lambda topic, message: message):
        program = RunProgram.of("run", driver.program, {"plan": "soon", "plan_time": 1.0})
        said = []
        for space in spaces:
            own = [("rosoclingo/program", String(program.text()))]
            own += [one for event in driver.journal.events for one in to_messages(event)]
            said += [(space + topic, change(topic, message)) for topic, message in own if topic not in left_out]
        return write_bag((0.1 * number, *one) for number, one in enumerate(said, 1))

    return write


@pytest.mark.slow
def test_replay_reports_a_decision_that_is_no_plan(replay, write):
    def change(topic, message):
        if topic == "rosoclingo/task_plan" and message.cycle == 2 and message.actions:
            message.actions = [one.replace("office3", "office1") for one in message.actions]
        return message

    code, text = replay(write(change=change))
    assert code == 1
    assert "cycle 2: UNEXPLAINED: no plan of the program: none has _action_lib(" in text
    assert text.endswith("1 unexplained: cycles 2")
    code, text = replay(write(change=change), "--to", 2)
    assert code == 1
    assert "Answer as recorded: none" in text
    assert "Answer of the replay, horizon" in text


def test_replay_writes_stream_and_program(replay, write, driver, tmp_path):
    code, text = replay(write(), "--stream", "-")
    assert (code, text.split()) == (0, driver.journal.stream.split())
    code, text = replay(write(), "--stream", tmp_path / "stream", "--program-to", tmp_path / "program")
    assert code == 0
    assert (tmp_path / "stream").read_text().split() == driver.journal.stream.split()
    files = f"{tmp_path}/program/mailbot.lp {tmp_path}/program/office.lp"
    assert text == f"rosrun rosoclingo oclingo {files} --shortest --stream {tmp_path}/stream"


@pytest.mark.slow
def test_replay_selects_program_core_and_run(replay, write, capsys):
    path = write(spaces=("/a/", "/a/", "/b/"), left_out=["rosoclingo/program"])
    files = ("--program", ENCODINGS / "mailbot.lp", ENCODINGS / "office.lp")
    assert replay(path, "--core", "b/rosoclingo")[0] == 2
    assert "lacks the program (topic rosoclingo/program)" in capsys.readouterr().err
    code, text = replay(path, "--core", "a/rosoclingo", *files)
    assert (code, text.count("no unexplained difference")) == (0, 2)
    assert replay(path, "--core", "a/rosoclingo", *files, "--run", 2)[1].count("no unexplained difference") == 1
    assert replay(path, "--core", "a/rosoclingo", *files, "--to", 2)[0] == 2
    assert "has 2 runs of the core: choose one with --run N" in capsys.readouterr().err
    assert replay(path, "--core", "a/rosoclingo", *files, "--run", 3)[0] == 2
    assert "no run 3" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        replay(path, "-c", "capacity=0")
    assert "--const needs --program" in capsys.readouterr().err
    code, text = replay(write(), *files, "-c", "capacity=0", "--to", 2)
    assert (code, "this is not the program of the run" in text) == (1, True)


def begun_late(topic, message):
    """Turn the update of the first cycle into one of the second cycle."""
    if topic == "rosoclingo/updates" and message.data.startswith("#step 1 "):
        message.data = message.data.replace("#step 1 ", "#step 2 ", 1)
    return message


@pytest.mark.parametrize(
    ("options", "words", "why"),
    [
        ({"left_out": ["rosoclingo/updates"]}, [], "the bag has no stream updates of a core"),
        ({"left_out": ["rosoclingo/task_plan"]}, [], "lacks the decisions"),
        (
            {"spaces": ("/a/", "/b/")},
            [],
            "the bag has runs of 2 cores: choose one of /a/rosoclingo, /b/rosoclingo with --core",
        ),
        (
            {"spaces": ("/a/", "/b/")},
            ["--core", "c"],
            "the bag has no core c; its cores: /a/rosoclingo, /b/rosoclingo",
        ),
        ({"spaces": ()}, [], "the bag is empty"),
        ({"change": begun_late}, [], "the updates of cycle 1 are missing"),
        ({}, ["--to", "999"], "--to 999 is after the last cycle"),
    ],
)
def test_replay_refuses_bags_without_the_run(replay, write, capsys, options, words, why):
    assert replay(write(**options), *words)[0] == 2
    assert why in capsys.readouterr().err


@pytest.mark.parametrize("size", [5, -1])
def test_replay_accepts_a_truncated_bag(replay, write, capsys, size):
    path = write()
    path.write_bytes(path.read_bytes()[:size])
    assert replay(path)[0] == 2
    assert "rosbag reindex" in capsys.readouterr().err
    path.write_text("something else")
    assert replay(path)[0] == 2
    assert "is not a bag, or is damaged" in capsys.readouterr().err
    assert replay(path.with_name("none.bag"))[0] == 2
    assert "none.bag cannot be read: No such file" in capsys.readouterr().err
    assert replay(path.parent)[0] == 2
    assert f"{NAME}: No such file" in capsys.readouterr().err


@pytest.mark.slow
def test_replay_accepts_a_journal(replay, journal, tmp_path):
    code, text = replay(journal)
    assert code == 0
    assert text.endswith("no unexplained difference")
    assert "\ncycle 2: " in replay(journal / NAME, "--all")[1]
    code, text = replay(journal, "--stream", "-", "--program-to", tmp_path)
    assert code == 0
    assert "_request(goal(office3,office2,1),2)." in text
    assert (tmp_path / "mailbot.lp").exists()


def test_replay_refuses_a_changed_journal_at_its_record(replay, journal, tmp_path, capsys):
    change = "UPDATE record SET change = replace(change, 'office3,office2', 'office3,office1')"
    assert replay(changed(journal / NAME, tmp_path / "changed.db", change))[0] == 2
    error = capsys.readouterr().err
    assert error.startswith(f"replay: {tmp_path}/changed.db: record 3 is corrupt; take another copy")
