"""The account of ROS messages: where robot and things are, for any package."""

from types import SimpleNamespace

import pytest

from rosoclingo.nodes.run_topics import RunTopics
from rosoclingo.runs.account import Account
from rosoclingo.runs.recorded_run import ProgramFile, RunProgram

LABELS = {"kitchen": [1.0, 2.0], "hall": {"x": 5.0, "y": 0.0}}


@pytest.fixture
def account():
    return Account(lambda _line: None)


@pytest.fixture
def take(account):
    """Pass a message of a topic to the account."""
    topics = RunTopics(account)
    return lambda topic, message, time: topics.takes[topic](time, message)


def program(text="", labels=LABELS):
    files = (ProgramFile("own.lp", f"#program base.\n{text}\n#program cumulative(t).\n#external _request/2.\n", False),)
    return SimpleNamespace(data=RunProgram("run", files, {}, "", {"labels": labels}).text())


def state(*atoms):
    return SimpleNamespace(cycle=1, atoms=list(atoms))


def posed(x, y):
    turn = SimpleNamespace(x=0.0, y=0.0, z=0.0, w=1.0)
    pose = SimpleNamespace(position=SimpleNamespace(x=x, y=y), orientation=turn)
    return SimpleNamespace(pose=SimpleNamespace(pose=pose))


def transforms(*found):
    turn = SimpleNamespace(x=0.0, y=0.0, z=0.0, w=1.0)
    return SimpleNamespace(
        transforms=[
            SimpleNamespace(
                header=SimpleNamespace(frame_id=parent),
                child_frame_id=child,
                transform=SimpleNamespace(translation=SimpleNamespace(x=x, y=y), rotation=turn),
            )
            for parent, child, x, y in found
        ]
    )


@pytest.mark.parametrize(
    ("topic", "message"),
    [
        ("base_pose_ground_truth", posed(1.1, 2.1)),
        ("amcl_pose", posed(1.1, 2.1)),
        ("/tf", transforms(("map", "odom", 1.0, 1.0), ("odom", "base_link", 0.0, 1.0))),
        ("/tf", transforms(("/map", "/base_footprint", 1.0, 2.3))),
    ],
)
def test_account_names_place_by_label_of_program(account, take, topic, message):
    take(topic, message, 1.0)
    take("~program", program(), 1.1)
    assert account.places.robot == "kitchen"
    take("~state", state("at(hall,now)"), 1.2)
    assert account.places.robot == "kitchen", "a measured position has priority"


def test_account_names_no_place_between_labels(account, take):
    take("~program", program(), 1.0)
    take("amcl_pose", posed(3.0, 3.0), 1.1)
    assert account.places.robot == "away from every label"
    take("/tf", transforms(("odom", "base_link", 1.0, 2.0)), 1.2)
    assert account.places.robot == "away from every label", "nothing says where odom is"


def test_account_counts_cycles_from_start_of_scenario(account, take):
    take("~task_plan", SimpleNamespace(cycle=7, horizon=7, actions=[], ground_time=0.0, solve_time=0.0), 1.0)
    take("out_rosoclingo", SimpleNamespace(interface="go", facts=["_action_lib(go,x,7)"]), 1.1)
    expect = {"actions": ["_action_lib(go,x,1)"]}
    assert account.differences(expect, 6) == []
    assert account.differences(expect) != []
