"""The command ``report`` on bags: recorded runs, and bags without a run."""

import json
import math
import re
from functools import partial
from pathlib import Path

import pytest
from journal_runs import GOALS
from published_runs import GOAL, LABELS, plan_of, program_of

from rosoclingo.reasoning.journal.database import NAME

ROOT = Path(__file__).resolve().parents[3]
PLAN = plan_of("move_base office2", "pickup 1")


@pytest.fixture
def report(monkeypatch, run_command):
    """Run the command."""
    from rosoclingo.nodes.pages import report_command

    monkeypatch.setattr(report_command, "web", lambda: ROOT / "web")
    return partial(run_command, report_command.main)


@pytest.fixture
def run(messages):
    """Return the messages of a robot whose goal is met, all in a namespace."""
    from actionlib_msgs.msg import GoalID
    from nav_msgs.msg import OccupancyGrid
    from rosgraph_msgs.msg import Log
    from std_msgs.msg import String

    def say(space="/", core="rosoclingo"):
        grid = OccupancyGrid(data=[0, 100, -1, 0])
        grid.info.width = grid.info.height = 2
        grid.info.resolution = 1.0
        program = program_of("", LABELS).text()
        state = {"id": GoalID(id="a"), "request": GOAL}
        goals = [messages.GoalStates(goals=[messages.GoalState(**state, status=number)]) for number in (0, 1, 1, 3)]
        lying = [messages.PackageStates(packages=[messages.PackageState("1", place, not place)]) for place in ("x", "")]
        own = [
            (1.0, f"{core}/program", String(program)),
            (1.0, "out_rosoclingo", messages.InterfaceIO("rosoclingo", ['_run("r")'])),
            (1.0, "map", grid),
            (2.0, f"{core}/goals", goals[0]),
            (2.5, f"{core}/updates", String(f"#step 1.\n_request({GOAL},2).\n#end step.\n")),
            (2.5, f"{core}/task_plan", messages.TaskPlan(cycle=1, horizon=2, actions=PLAN, ground_time=0.5)),
            (2.5, "out_rosoclingo", messages.InterfaceIO("move_base", PLAN[:1])),
            *((3.0 + number, f"{core}/goals", one) for number, one in enumerate(goals[1:])),
            *((4.0 + number, "packages", one) for number, one in enumerate(lying)),
            (4.5, "in_rosoclingo", messages.InterfaceIO("move_base", ["_return(move_base,office2,1)"])),
        ]
        log = Log(name=space + core, msg="cycle 1: something is odd")
        other = Log(name="/other", msg="cycle 1: it is not of the core")
        return [
            *((time, space + topic, one) for time, topic, one in own),
            (4.0, "/rosout", log),
            (4.0, "/rosout", other),
        ]

    return say


def shown(path):
    text = path.read_text(encoding="utf-8")
    return json.loads(re.search(r'<script type="application/json" id="run">(.*?)</script>', text, re.DOTALL).group(1))


def odometry(x, yaw):
    from nav_msgs.msg import Odometry

    found = Odometry()
    found.pose.pose.position.x = x
    found.pose.pose.orientation.z, found.pose.pose.orientation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return found


def transform(parent, child, x):
    from geometry_msgs.msg import TransformStamped
    from tf2_msgs.msg import TFMessage

    one = TransformStamped(child_frame_id=child)
    one.header.frame_id = parent
    one.transform.translation.x, one.transform.rotation.w = x, 1.0
    return TFMessage([one])


def test_report_of_a_bag_is_written_next_to_it(report, write_bag, run, tmp_path):
    """The action server has the usual name, independent of the core's name."""
    path = write_bag(run(core="brain"))
    assert report(path) == (0, f"report: {tmp_path / 'run.html'}")
    found = shown(tmp_path / "run.html")
    assert (found["about"]["title"], found["about"]["source"]) == ("run", "run.bag")
    assert found["about"]["labels"] == LABELS
    assert found["about"]["map"]["width"] == 2.0
    ((_, goal),) = found["goals"]
    assert [state[:2] for state in goal["states"]] == [[0.0, "pending"], [1.0, "active"], [3.0, "succeeded"]]
    ((_, cycle),) = found["cycles"]
    assert (cycle["plans"][0]["ground"], cycle["problems"]) == (0.5, [[2.0, "something is odd", ""]])
    assert [one["places"] for _, one in found["packages"]] == [[["1", "x"]], [["1", ""]]]
    assert found["actions"][0][1]["value"] == "office2"


def test_report_options_name_file_title_and_core(report, write_bag, run, tmp_path, capsys):
    path = write_bag([*run("/red/"), *run("/blue/")])
    to = tmp_path / "other.html"
    assert report(path, "-o", to, "--core", "/red/rosoclingo", "--title", "Red <b>")[0] == 0
    assert shown(to)["about"]["title"] == "Red <b>"
    assert "Red <b>" not in to.read_text()
    assert len(shown(to)["goals"]) == 1
    assert report(path, "--core", "/red/rosoclingo", "-o", tmp_path / "no" / "folder.html")[0] == 2
    assert "No such file or directory" in capsys.readouterr().err


def test_report_shows_path_and_prefers_pose_of_the_simulator(report, write_bag, run, tmp_path):
    from geometry_msgs.msg import PoseStamped
    from nav_msgs.msg import Path as Way

    way = Way(poses=[PoseStamped() for _ in range(3)])
    way.poses[2].pose.position.x = 2.0
    truth = [(3.0 + 0.01 * tick, "/base_pose_ground_truth", odometry(0.05 * tick, 0.5)) for tick in range(100)]
    tf = [(3.0, "/tf", transform("map", "odom", 7.0)), (3.5, "/tf", transform("odom", "base_link", 7.0))]
    amcl = [(2.5, "/amcl_pose", odometry(0.0, 0.5)), (4.2, "/amcl_pose", odometry(90.0, 0.5))]
    report(write_bag([*run(), *amcl, *truth, *tf, (3.0, "/move_base/NavfnROS/plan", way)]))
    assert shown(tmp_path / "run.html")["paths"] == [[0, {"time": 1.0, "points": [[0.0, 0.0], [2.0, 0.0]]}]]
    poses = [one for _, one in shown(tmp_path / "run.html")["poses"]]
    assert poses[0] == {"time": 0.5, "robot": "", "pose": [0.0, 0.0, 0.5], "metres": 0.0}
    assert 5 <= len(poses) <= 11, "ten a second"
    assert max(one["pose"][0] for one in poses) < 6.0


@pytest.mark.parametrize(
    ("frame", "robot"),
    [
        ("/lab/r1/base_footprint", "lab/r1"),
        ("r1_base_link", "r1"),
        ("planned", "planned"),
        ("base_links", None),
    ],
)
def test_report_finds_robots_by_their_frames(report, write_bag, run, messages, tmp_path, frame, robot):
    plan = messages.TaskPlan(cycle=1, horizon=1, actions=["_action_lib(go(planned),x,1)"])
    tf = [(2.0, "/tf", transform("map", "odom", 7.0)), (3.0, "/tf", transform("odom", frame, 1.0))]
    report(write_bag([*run(), (1.5, "/rosoclingo/task_plan", plan), *tf]))
    found = [(one["robot"], one["pose"]) for _, one in shown(tmp_path / "run.html")["poses"]]
    assert found == ([] if robot is None else [(robot, [8.0, 0.0, 0.0])])


def test_report_shows_the_pace_and_no_map_without_cells(report, write_bag, run, tmp_path):
    from nav_msgs.msg import OccupancyGrid
    from std_msgs.msg import Float64

    walls = [(2.0 + 2.0 * second, "/record/wall_time", Float64(100.0 + second)) for second in range(4)]
    report(write_bag([*run(), *walls, (9.0, "/map", OccupancyGrid())]))
    about = shown(tmp_path / "run.html")["about"]
    assert (about["pace"], about["map"]) == (2.0, None)


@pytest.mark.slow
def test_report_of_a_journal(report, journal, tmp_path):
    assert report(journal, "-o", tmp_path / "out.html") == (0, f"report: {tmp_path / 'out.html'}")
    page = shown(tmp_path / "out.html")
    assert [goal["request"] for _, goal in page["goals"]] == [GOALS[0][1]]
    assert page["about"]["source"] == journal.name
    assert "no poses" in page["about"]["lacks"]
    assert report(journal) == (0, f"report: {journal / 'journal.html'}")
    assert report(journal / NAME)[0] == 0
