"""ROS messages in the model of a run."""

from types import SimpleNamespace

from rosoclingo.nodes.run_topics import RunTopics
from rosoclingo.runs.recorded_run import ProgramFile, RunProgram
from rosoclingo.runs.run_view import RunView

LABELS = {"kitchen": [1.0, 2.0], "hall": {"x": 5.0, "y": 0.0}}


def program(text="", labels=LABELS):
    files = (ProgramFile("own.lp", f"#program base.\n{text}\n#program cumulative(t).\n#external _request/2.\n", False),)
    return SimpleNamespace(data=RunProgram("run", files, {}, "", {"labels": labels}).text())


def state(*atoms):
    return SimpleNamespace(cycle=1, atoms=list(atoms))


def plan(cycle, *actions):
    return SimpleNamespace(cycle=cycle, horizon=cycle, actions=list(actions), ground_time=0.0, solve_time=0.0)


def reported(*found):
    """Return the states of goals, each its id, its status, and its reason."""
    came = SimpleNamespace(to_sec=lambda: 9.5)
    return SimpleNamespace(
        goals=[
            SimpleNamespace(id=SimpleNamespace(id=key), request=f"g({key})", status=number, reason=reason, came=came)
            for key, number, reason in found
        ]
    )


def test_topics_pass_present_state_to_another_view():
    text = '_says("g(Goal)","Goal {Goal}"). _draws(shut,mark,"shut").'
    topics = RunTopics(RunView())
    for topic, message in (
        ("~program", program(text)),
        ("~goals", reported(("a", 3, ""), ("b", 1, ""))),
        ("~goals", reported(("a", 3, ""), ("b", 0, "much to do"))),
        ("~task_plan", plan(7, "_action_lib(go,x,7)")),
        ("~state", state("shut(hall)")),
        ("~mode", SimpleNamespace(data="paused")),
        ("packages", SimpleNamespace(packages=[SimpleNamespace(id="1", location="hall")])),
        ("in_rosoclingo", SimpleNamespace(interface="go", facts=["_return(go,y,6)"])),
    ):
        topics.pass_on(topic, 10.0, message)
    fresh = RunView()
    topics.restart(fresh)
    fresh.finish()
    found = {name: list(table) for name, table in fresh.tables.items()}
    (goal,) = found["goals"]
    assert (goal["words"], goal["sent"], goal["states"][-1]) == ("Goal b", 0.0, [0.5, "waiting", "much to do", ""])
    assert [(one["cycle"], len(one["plans"])) for one in found["cycles"]] == [(7, 1)]
    assert (fresh.mode_word, list(fresh.about["labels"])) == ("paused", ["kitchen", "hall"])
    assert (found["packages"][-1]["places"], found["shapes"][0]["text"]) == ([("1", "hall")], "shut")
    assert not [line for line in found["log"] if line["kind"] == "return"], "what is over"
    topics.pass_on("~goals", 12.0, reported(("a", 3, ""), ("b", 3, "")))
    assert [(one["id"], one["ended"]) for one in fresh.tables["goals"]] == [("b", 2.5)]
    assert fresh.has_ended("a")
