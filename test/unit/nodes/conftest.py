"""Recordings for the commands that read them: bags, and the journal of a core."""

import pytest
from journal_runs import GOALS, play
from shipped import shipped


@pytest.fixture(scope="session")
def journal(tmp_path_factory):
    """The folder of a core's journal with a goal of the mailbot."""
    path = tmp_path_factory.mktemp("journal")
    play(path, shipped("mailbot.lp", "office.lp"), GOALS[:1], None, None)
    return path


@pytest.fixture
def run_command():
    """Run a command's main function; return its exit code and its output."""
    pytest.importorskip("rosbag")

    def run(main, *words):
        lines = []
        return main([str(word) for word in words], lines.append), "\n".join(lines)

    return run


@pytest.fixture
def write_bag(messages, tmp_path):
    """Write a bag of messages, each with seconds and topic; return its path."""
    import genpy
    import rosbag

    def write(said):
        path = tmp_path / "run.bag"
        with rosbag.Bag(str(path), "w") as bag:
            for time, topic, message in said:
                bag.write(topic, message, genpy.Time.from_sec(time))
        return path

    return write
