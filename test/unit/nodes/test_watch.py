"""The command ``watch``: its choice of a core, and the account of a bag."""

import pytest

from rosoclingo.runs.recorded_run import RecordingError

PLAN = "rosoclingo/TaskPlan"


@pytest.mark.parametrize(
    ("cores", "usual", "expected"),
    [
        ([], "/rosoclingo", "/rosoclingo"),
        (["/brain"], "/rosoclingo", "/brain"),
        (["/a/rosoclingo", "/b/rosoclingo"], "/b/rosoclingo", "/b/rosoclingo"),
    ],
)
def test_watch_finds_the_core(messages, cores, usual, expected):
    from rosoclingo.nodes.watch import chosen_core

    published = [[f"{core}/task_plan", PLAN] for core in cores] + [["/x/task_plan", "other/Plan"]]
    assert chosen_core(published, usual) == expected
    with pytest.raises(RecordingError, match=r"/a/brain, /b/brain with --core"):
        chosen_core([["/b/brain/task_plan", PLAN], ["/a/brain/task_plan", PLAN]], "/rosoclingo")


def test_watch_prints_the_account_of_a_bag(messages, write_bag):
    from actionlib_msgs.msg import GoalID
    from std_msgs.msg import String

    from rosoclingo.nodes.watch import watch_bag

    go = ["_action_lib(go,x,2)"]
    goal = messages.GoalState(id=GoalID(id="a"), request="g(1)", status=1)
    said = [
        ("/lab/brain/goals", messages.GoalStates(goals=[goal])),
        ("/lab/brain/state", messages.State(cycle=2, atoms=["at(a,now)"])),
        ("/lab/brain/task_plan", messages.TaskPlan(cycle=2, horizon=2, actions=go)),
        ("/lab/out_rosoclingo", messages.InterfaceIO("go", go)),
        ("/lab/in_rosoclingo", messages.InterfaceIO("go", ["_return(go,x,2)"])),
        ("/lab/brain/updates", String("#step 3.\n_return(go,x,2).\n#end step.\n")),
    ]
    path, lines = write_bag([(100.0 + 0.2 * number, *one) for number, one in enumerate(said)]), []
    watch_bag(path, None, True, lines.append)
    assert [line.split("cycle ")[1].split(None, 2) for line in lines[: lines.index("")]] == [
        ["2", "plan", "go x"],
        ["2", "request", "g(1)"],
        ["2", "goal", "g(1): under way"],
        ["2", "state", "+at(a,now)"],
        ["2", "action", "go x"],
        ["2", "return", "go x: done"],
        ["3", "update", "#step 3. _return(go,x,2). #end step."],
    ]
    assert lines[lines.index("") :] == ["", "g(1): under way", "robot: a", "actions: go x", "time: 1.0 s"]
    with pytest.raises(RecordingError, match="the bag has no core other"):
        watch_bag(path, "other", True, lines.append)
