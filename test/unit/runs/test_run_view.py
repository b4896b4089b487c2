"""The view of a run for pages, assembled from messages of topics."""

import json
import math

import pytest
from published_runs import GOAL, delivery, program_of

from rosoclingo.runs import run_view
from rosoclingo.runs.events import GoalReport
from rosoclingo.runs.recorded_run import FORMAT
from rosoclingo.runs.run_tables import POSES, Track
from rosoclingo.runs.run_view import RunView


def records(changes, name):
    return [record for _, record in changes[name]]


def names(changes, numbers):
    words = [records(changes, "words")[number] for number in numbers]
    return [f"{word['interface']} {word['parameter']}" for word in words]


def test_view_has_the_published_run():
    found = json.loads(json.dumps(delivery().changes(), allow_nan=False))
    assert found["seconds"] == 32.5
    (goal,) = records(found, "goals")
    assert (goal["request"], goal["sent"], goal["ended"]) == (GOAL, 0.0, 32.5), "since the first request"
    cycles = records(found, "cycles")
    assert [one["cycle"] for one in cycles] == [1, 2, 3, 4, 5, 6]
    assert cycles[0]["updates"] == [f"#step 1.\n_request({GOAL},2).\n#end step."]
    early, plan = cycles[0]["plans"]
    assert (early["time"], early["actions"], early["ground"]) == (0.0, [], 0.1)
    assert names(found, plan["actions"]) == ["move_base office2", "pickup 1", "move_base office1", "deliver 1"]
    actions = records(found, "actions")
    assert [(one["begun"], one["ended"], one["value"], one["failed"]) for one in actions][1:3] == [
        (10.0, 12.0, "1", False),
        (12.0, 20.0, "blocked", True),
    ]
    assert [one["time"] for one in records(found, "packages")] == [0.0, 12.0, 32.0], "changes"


def test_view_sends_only_changes():
    view = delivery()
    first = view.changes()
    view.goal(140.0, "b", "goal(office1,office2,2)")
    view.pose(140.0, 4.0, 1.0, 0.0)
    more = view.changes(first["revision"])
    assert [number for number, _ in more["goals"]] == [1]
    assert (more["about"], more["cycles"], more["words"], more["terms"]) == (None, [], [], [])
    pose = {"time": 40.0, "robot": "", "pose": [4.0, 1.0, 0.0], "metres": 5.0}
    assert more["poses"] == [(len(first["poses"]), pose)]
    view.status(141.0, "b", 1, "")
    ((number, goal),) = view.changes(more["revision"])["goals"]
    assert (number, goal["states"][-1]) == (1, [41.0, "active", "", ""])


@pytest.mark.parametrize(
    ("reported", "states"),
    [
        # a goal waits, for a reason, until the core begins with it
        (
            [(1.0, "a", 0, "much to do"), (2.0, "a", 0, "much to do"), (4.0, "a", 0, ""), (5.0, "a", 1, "")],
            [(1.0, "waiting", "much to do"), (4.0, "pending", ""), (5.0, "active", "")],
        ),
        # the status of no goal, and after the end
        (
            [
                (1.0, "a", 99, "odd"),
                (1.0, "b", 3, "of another run"),
                (2.0, "a", 5, "g(1) is refused"),
                (3.0, "a", 1, ""),
            ],
            [(2.0, "rejected", "is refused")],
        ),
    ],
)
def test_view_goal_has_its_states(reported, states):
    view = RunView()
    view.goal(0.0, "a", "g(1)")
    for one in reported:
        view.status(*one)
    (goal,) = records(view.changes(), "goals")
    assert [tuple(state) for state in goal["states"]] == [(0.0, "pending", "", ""), *((*one, "") for one in states)]


def test_view_reports_earlier_goals_at_once():
    view = RunView()
    published = [
        GoalReport("old", "g(0)", 3, "is met", 10.0),
        GoalReport("a", "g(1)", 1, "g(1) is accepted", 90.0),
        GoalReport("b", "g(2)", 0, "at most 8 goals are planned for at a time", 95.0),
    ]
    view.goals(100.0, published)
    refused = GoalReport("c", "g(3)", 5, "g(3) there is no g", 101.5)
    view.goals(102.0, [*published[:2], GoalReport("b", "g(2)", 0, "", 95.0), refused])
    found = {goal["id"]: goal for goal in records(view.changes(), "goals")}
    assert {key: (goal["sent"], goal["ended"]) for key, goal in found.items()} == {
        "a": (0.0, None),
        "b": (5.0, None),
        "c": (11.5, 12.0),
    }
    assert found["a"]["states"] == [[0.0, "pending", "", ""], [10.0, "active", "is accepted", ""]]
    words = [(word, why) for _, word, why, _ in found["b"]["states"]]
    assert words == [("pending", ""), ("waiting", "at most 8 goals are planned for at a time"), ("pending", "")]
    assert found["c"]["states"][-1][1:3] == ["rejected", "there is no g"]
    view.finish()
    lines = [line["text"] for line in records(view.changes(), "log")]
    assert lines.count("g(1)") == 1
    assert not any("g(0)" in line for line in lines)


@pytest.mark.parametrize(
    ("messages", "ends"),
    [
        # concurrent actions: their parameter, or else the first one
        ([("go", "a"), ("go", "b"), "b", "stuck"], [("stuck", "failed"), ("b", "")]),
        # a preempted action ended early, unless it was not cancelled
        ([("go", "a"), ("cancel", "a"), "preempted"], [("preempted", "preempted")]),
        ([("go", "a"), ("cancel", "a"), "a"], [("a", "")]),
        ([("go", "a"), ("cancel", "a"), "blocked"], [("blocked", "failed")]),
        ([("go", "a"), ("cancel", "b"), "preempted"], [("preempted", "failed")]),
        ([("go", "a"), ("text", "_cancel(go,a,2)"), "preempted"], [("preempted", "failed")]),
        ([("go", "a"), ("go", "b"), ("cancel", "b"), "preempted"], [(None, ""), ("preempted", "preempted")]),
        # a return before its action
        (["a", ("text", "_return(go,late,0)"), ("go", "a"), ("text", "_action_lib(go,a,2)")], [("a", ""), (None, "")]),
    ],
)
def test_view_gives_each_return_to_its_action(messages, ends):
    forms = {"go": "_action_lib(go,{},1)", "cancel": "_cancel(go,{},1)", "text": "{}"}
    view = RunView()
    view.goal(0.0, "a", "g(1)")
    for time, message in enumerate(messages, 1):
        kind, word = message if isinstance(message, tuple) else ("text", f"_return(go,{message},1)")
        text = forms[kind].format(word)
        if text.startswith("_return"):
            view.returned(float(time), "go", [text])
        else:
            view.dispatched(float(time), [text])
    found = records(view.changes(), "actions")
    outcomes = ("failed" * one["failed"] + "preempted" * one["preempted"] for one in found)
    assert [(one["value"], outcome) for one, outcome in zip(found, outcomes)] == ends
    for one in found:
        assert (one["ended"] is None) == (one["value"] is None)
        assert one["ended"] is None or one["begun"] <= one["ended"]


def drawn(view):
    """Return the changes of the drawings: the time of each, and the drawings from then on."""
    found, changes = view.changes(), []
    for record in records(found, "beliefs"):
        shapes = [tuple(found["shapes"][shape][1].values()) for shape in record["shapes"]]
        if not changes or changes[-1][1] != shapes:
            changes.append((record["time"], shapes))
    return changes


def floor():
    """Return a program as the core publishes it, with drawings of a way, marks and a blocked way."""
    text = '_draws(path,way). _draws(shut,blocked,"shut"). _draws(dirty,mark). path(a,b). _says(go,"goes to {}").'
    return program_of(text, {"a": [0.0, 0.0, 0.0], "b": [1.0, 0.0, 0.0]}).text()


WAY, SHUT = ("way", ["a", "b"], ""), ("blocked", ["a", "b"], "shut")


def test_view_keeps_drawings_when_they_change():
    view = RunView()
    view.program(0.0, floor())
    view.goal(10.0, "a", "g(1)")
    for time, atoms in ((11.0, ["odd"]), (12.0, ["shut(a,b,now)"]), (13.0, ["odd", "shut(a,b,now)"]), (14.0, [])):
        view.beliefs(time, 1, atoms)
    assert drawn(view) == [(0.0, [WAY]), (2.0, [WAY, SHUT]), (4.0, [WAY])]
    view = RunView()
    view.goal(10.0, "a", "g(1)")
    view.beliefs(11.0, 1, ["shut(a,b,now)"])
    view.program(0.0, floor())  # after the beliefs
    assert drawn(view) == [(1.0, [WAY, SHUT])]


def test_view_of_restarted_core_begins_with_cycle_1():
    view = RunView()
    view.begin("one")
    view.update(0.0, "#step 1.\n#end step.\n")
    view.begin("one")
    view.update(1.0, "#step 2.\n#end step.\n")
    view.begin("two")
    view.update(2.0, "#step 1.\n#end step.\n")
    found = view.changes()
    assert [(one["run"], one["cycle"]) for one in records(found, "cycles")] == [(1, 1), (1, 2), (2, 1)]
    assert found["about"]["run"] == 2


def test_view_goals_of_vanished_core_are_lost_unless_reported():
    view = RunView()
    view.begin("one")
    for key in "ab":
        view.goal(5.0, key, f"g({key})")
        view.status(6.0, key, 1, "")
    view.begin("two")
    first, second = records(view.changes(), "goals")
    assert first["states"][-1] == second["states"][-1] == [1.0, "lost", "the core was restarted", ""]
    known = view.revision
    view.status(8.0, "a", 1, "")
    assert (first["ended"], second["ended"]) == (None, 1.0)
    assert view.changes(known)["goals"] == [(0, first)], "also of an earlier record"


def test_view_has_a_limited_size(monkeypatch):
    monkeypatch.setattr(run_view, "MOST", 200)
    view = RunView()
    for number in range(1000):
        if view.full:
            break
        view.goal(float(number), str(number), f"g({number})")
        view.status(float(number), str(number), 3, "")
    assert view.full


def test_view_labels_come_with_the_program():
    view = RunView()
    program = program_of("", {"kitchen": [1.0, 2.0, 0.5]})
    view.program(0.0, program.text())
    assert view.changes()["about"]["labels"] == {"kitchen": [1.0, 2.0, 0.5]}
    for damaged in ("no JSON", program.text().replace(f'"format": {FORMAT}', '"format": 99'), '{"format": 1}'):
        view.program(0.0, damaged)
    view.program(0.0, program_of("", {"Kitchen Sink": "here"}).text())
    assert view.changes()["about"]["labels"] == {"kitchen": [1.0, 2.0, 0.5]}


def test_view_shortens_long_texts():
    view = RunView()
    view.goal(0.0, "a", "g(" + "x" * 200_000 + ")")
    view.status(1.0, "a", 5, "y" * 200_000)
    view.returned(2.0, "z", ['_seen("' + "x" * 200_000 + '")'])
    view.problem(2.0, 1, "p" * 200_000)
    assert len(json.dumps(view.changes())) < 100_000


def test_view_replaces_numbers_that_are_not_finite():
    view = RunView()
    view.goal(0.0, "a", "g(1)")
    view.pose(1.0, math.nan, 0.0, 0.0)
    view.pose(1.0, 0.0, 0.0, math.inf)
    view.path(1.0, [(math.nan, 0.0), (1.0, 2.0)])
    view.plan(1.0, 1, 1, [], (math.nan, math.inf))
    found = view.changes()
    json.dumps(found, allow_nan=False)
    assert found["poses"] == []
    assert records(found, "paths") == [{"time": 1.0, "points": [[1.0, 2.0]]}]


def test_view_keeps_paths_to_one_place_occasionally():
    view = RunView()
    view.goal(0.0, "a", "g(1)")
    for tick in range(100):
        view.path(0.1 * tick, [(0.01 * tick, 0.0), (2.0, 0.0)])
    view.path(10.0, [(1.0, 0.0), (9.0, 0.0)])
    assert [one["time"] for one in records(view.changes(), "paths")] == [0.0, 5.0, 10.0]


def test_view_keeps_the_latest_scan_of_each_laser():
    view = RunView()
    view.goal(10.0, "a", "g(1)")
    for time, topic in ((11.0, "/scan"), (12.0, "/r1/scan"), (13.0, "/scan")):
        view.scan(time, topic, [(time, 0.123)])
    known = view.revision
    assert [(one["topic"], one["time"], one["points"]) for one in records(view.changes(), "scans")] == [
        ("/scan", 3.0, [[13.0, 0.12]]),
        ("/r1/scan", 2.0, [[12.0, 0.12]]),
    ]
    view.scan(15.0, "/r1/scan", [])
    assert [number for number, _ in view.changes(known)["scans"]] == [1]


def test_view_rewords_goals_and_actions_with_the_program():
    view = RunView()
    view.goal(10.0, "a", "g(room)")
    view.dispatched(11.0, ["_action_lib(go(r1),room,1)"])
    known = view.revision
    text = '_says(go,"goes to {}"). _says("g(Place)","Clean the {Place}").'
    program = program_of(text, titles={"room": "hall", "odd": 7})
    view.program(12.0, program.text())
    more = view.changes(known)
    assert [one["words"] for one in records(more, "goals")] == ["Clean the hall"]
    (action,) = records(more, "words")
    assert (action["words"], action["deed"], action["kind"]) == ("r1 goes to hall", "goes to hall", "goes to …")
    assert (action["term"], action["robots"]) == ("_action_lib(go(r1),room,1)", ["r1"])
    assert more["about"]["titles"] == {"room": "hall"}
    view.program(13.0, program.text())
    assert [records(view.changes(more["revision"]), name) for name in ("goals", "words")] == [[], []]


# ---- tables ---------------------------------------------------------------------------------------------------------


def test_long_path_has_few_poses_and_its_length():
    track = Track()
    recorded = [tick for tick in range(7 * POSES) if track.add(0.06 * tick, 0.0, 0.0)]
    assert recorded[:POSES] == list(range(POSES))
    assert len(recorded) == 3 * POSES
    assert track.metres == pytest.approx(0.06 * (7 * POSES - 1))


@pytest.mark.parametrize(
    ("sent", "earlier", "fed", "answer"),
    [
        (["saw,1,1"], [], "saw,1,1", "saw,1,1"),
        (["saw,1,1"], [], "saw,1,2", "saw,1,1"),
        (["saw,1,1"], [], "saw,worn,3", "saw,worn,1"),
        (["saw,1,1", "saw,2,2"], [], "saw,1,3", "saw,1,1"),
        (["saw,1,1", "saw,2,2"], ["saw,2,2"], "saw,worn,3", "saw,worn,1"),
        (["saw,1,1", "saw,1,2"], ["saw,worn,1"], "saw,worn,2", "saw,worn,2"),
        (["saw,1,1", "drill,1,2"], [], "drill,1,3", "drill,1,2"),
    ],
)
def test_view_update_waits_for_returns_of_actions_that_went_on(sent, earlier, fed, answer):
    view = RunView()
    view.dispatched(0.0, [f"_action_lib({one})" for one in sent])
    view.returned(0.0, "shop", [f"_return({one})" for one in earlier])
    view.update(0.0, f"#step 4. _return({fed}). #endstep.")
    view.returned(0.0, "shop", [f"_return({answer})"])
    kinds = [line["kind"] for line in records(view.changes(), "log")]
    assert kinds == ["return"] * (len(earlier) + 1) + ["update"]
