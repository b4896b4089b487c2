"""``check --labels --interfaces``: right files give no finding, and each seeded fault is found at its line."""

import json
import re
import sys

import lint_programs
import pytest
from hypothesis import given
from hypothesis import strategies as st
from workloads import sized

from rosoclingo.checking import check_command
from rosoclingo.interfaces.checking.robot_files import RobotFiles

pytestmark = pytest.mark.usefixtures("messages")
TEMPLATE = lint_programs.ROOT / "templates" / "package" / "config"
CONFIG = lint_programs.ROOT / "config"


def texts(name):
    """Return the files of a system by name: its program's, labels.yaml and interfaces.yaml."""
    files = {one.name: one.text for one in lint_programs.program(name)}
    if name == "garden":
        labels, interfaces = (
            lint_programs.block("tutorial.md", "labels.yaml"),
            lint_programs.block("tutorial.md", "interfaces.yaml"),
        )
    elif name == "template":
        labels, interfaces = ((TEMPLATE / f"{one}.yaml").read_text() for one in ("labels", "interfaces"))
    else:
        world = "house" if name == "house" else "office"
        if name != "paper":  # its program takes no facts from people
            files["orders.yaml"] = (CONFIG / f"{world}_orders.yaml").read_text()
        labels = (CONFIG / f"{world}_labels.yaml").read_text()
        interfaces = (CONFIG / "interfaces.yaml").read_text()
    return {**files, "labels.yaml": labels, "interfaces.yaml": interfaces}


def check_files(folder, files, capsys, *options):
    """Write the files into a folder and return their findings."""
    programs = [name for name in files if name.endswith(".lp")]
    for name, text in files.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    # the file that includes the others comes first, and is enough
    named = [one for one in programs if "/" not in one and one != "delivery.lp"]
    places = options or [
        word
        for kind in ("labels", "interfaces", "orders")
        if f"{kind}.yaml" in files
        for word in (f"--{kind}", str(folder / f"{kind}.yaml"))
    ]
    code = check_command.main([*(str(folder / one) for one in named), *places, "--json"], RobotFiles())
    found = json.loads(capsys.readouterr().out)["findings"]
    assert code == bool(found)
    return found


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mailbot", "house", "paper", "garden", "template"])
def test_robot_files_of_correct_systems_have_no_finding(name, tmp_path, capsys):
    files = texts(name)
    assert check_files(tmp_path, files, capsys) == []


#: System, file, its text, the replacement (@ marks the place of the finding), kind, words of the message.
SEEDS = [
    ("house", "labels.yaml", "study: [6.0, 9.0]\n", "@garage: [6.0, 9.0]\n", "idle-label", "places are bathroom"),
    ("garden", "garden.lp", "plant(palm).", "plant(@plam).", "no-label", "did you mean palm?"),
    ("garden", "labels.yaml", "tap: [2.5", "tap: ]@[2.5", "configuration", "invalid YAML"),
    ("mailbot", "interfaces.yaml", "timeout: 300.0", "@timeot: 300.0", "configuration", "did you mean timeout?"),
    ("mailbot", "interfaces.yaml", "retry_on: [server", "@retry_on: [serv", "idle-reason", "did you mean server_lost"),
    ("garden", "interfaces.yaml", "fill:", "@fil:", "idle-interface", "did you mean fill?"),
    ("garden", "interfaces.yaml", "fill:", "fil:", "no-interface", "did you mean fil?"),
    ("garden", "interfaces.yaml", "{a: 1, b: 200}", "{a: 1, @c: 200}", "message-type", "no such field; it has a, b"),
    ("garden", "interfaces.yaml", "/MoveBaseAction", "/MovebaseAction", "message-type", "no"),
    ("mailbot", "interfaces.yaml", "outcome: NOT_HERE", "@outcome: NOTHERE", "message-type", "no constant NOTHERE"),
    ("mailbot", "interfaces.yaml", "return: unreachable}", 'return: unreachable, @facts: ["_blockd(a,b,now)"]}',
     "unheard-fact", "did you mean _blocked/3?"),
    ("garden", "interfaces.yaml", "{target_pose: $parameter.pose}", "{target_pose: {header: {@frame_id: /map}}}",
     "label-value", "goals are sent with map"),
    ("garden", "labels.yaml", "[2.5, 2.5]", "@[2.5, 2.5, 90]", "label-value", "did you mean degrees? write 1.571"),
    ("garden", "garden.lp", "plant(palm).", "plant(@rejected).", "like-reason", "both a parameter and a failure"),
    ("garden", "labels.yaml", "palm:", "@preempted:", "like-reason", "the name of a failure reason"),
    ("house", "house.lp", "_draws(door,way)", "@_draws(D,way) :- door(D,E)", "idle-drawing", "from ground facts"),
    ("mailbot", "mailbot.lp", "_draws(corridor,way)", "@_draws(coridor,way)", "idle-drawing", "did you mean corridor?"),
]  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "file", "old", "new", "kind", "words"),
    lint_programs.marked(sized(list({seed[4]: seed for seed in SEEDS}.values()), SEEDS)),
)
def test_robot_files_seeded_fault_is_found(name, file, old, new, kind, words, tmp_path, capsys):
    files = texts(name)
    files[file], (line, _) = lint_programs.seeded(files[file], old, new)
    found = check_files(tmp_path, files, capsys)
    mine = [one for one in found if one["kind"] == kind and words in f"{one['message']} ({one['remedy']})"]
    assert mine, found
    if "@" in new:
        assert (str(tmp_path / file), line) in [(one["file"], one["line"]) for one in mine], found


DOCK = """#program base.
room(kitchen). room(hall).
RELATION
#program cumulative(t).
#external _request/2. #external _return/3.
want(X,t) :- _request(do(X),t+1), room(X).
{ _action_lib(A,P,t) : possible(A,P) } 1 :- want(X,t).
bad(t) :- _action_lib(A,P,t), _return(A,V,t), V != P.
#program volatile(t).
:- want(X,t), bad(t).
"""


@pytest.mark.parametrize(
    "relation",
    [
        "act(move_base,drives). act(cool,lamps). what(drives,R) :- room(R). what(lamps,lamp). "
        "possible(A,P) :- act(A,K), what(K,P).",
        "possible((move_base;stay),R) :- room(R). possible(cool,(lamp;fridge)).",
    ],
)
def test_robot_files_separate_places_of_different_actions(relation, tmp_path, capsys):
    labels = {"labels.yaml": "kitchen: [1, 2]\nhall: [3, 4]\n"}
    program = {"dock.lp": DOCK.replace("RELATION", relation)}
    interfaces = {
        "interfaces.yaml": "move_base:\n  type: move_base_msgs/MoveBaseAction\n  goal: {target_pose: $parameter.pose}\n"
        "cool: {type: actionlib/TwoIntsAction, goal: {a: 1}}\n"
        + ("stay: {type: actionlib/TwoIntsAction, goal: {a: 1}}\n" if "stay" in relation else "")
    }
    assert check_files(tmp_path, {**program, **labels, **interfaces}, capsys) == []
    (tmp_path / "labels.yaml").write_text("kitchen: [1, 2]\n")
    options = ["--labels", str(tmp_path / "labels.yaml"), "--interfaces", str(tmp_path / "interfaces.yaml")]
    found = check_files(tmp_path, program, capsys, *options)
    assert [one["kind"] for one in found] == ["no-label"]
    assert "no label hall" in found[0]["message"]


def test_robot_files_findings_can_be_silenced_in_yaml(tmp_path, capsys):
    files = texts("garden")
    files["labels.yaml"] += (
        "porch: [1.0, 1.0]   # check: ok idle-label (for later)\n# check: ok idle-label\nroof: [1.0, 2.0]\n"
    )
    assert check_files(tmp_path, files, capsys) == []
    assert check_files(tmp_path, files, capsys, "--labels", str(tmp_path / "labels.yaml")) == [], "labels alone"


def test_robot_files_that_are_unreadable_are_reported(tmp_path, capsys):
    (tmp_path / "p.lp").write_text("#cumulative t.\n#volatile t.\n")
    code = check_command.main([str(tmp_path / "p.lp"), "--labels", str(tmp_path / "none.yaml")], RobotFiles())
    assert code == 2
    assert "none.yaml: can't be read" in capsys.readouterr().err


def test_robot_files_are_checked_despite_syntax_errors(tmp_path, capsys):
    files = texts("garden")
    files["garden.lp"] = files["garden.lp"].replace("at(home,0).", "at(home,0)")
    files["labels.yaml"] = files["labels.yaml"].replace("[2.5, 2.5]", "2.5")
    assert sorted(one["kind"] for one in check_files(tmp_path, files, capsys)) == ["configuration", "syntax"]


def test_robot_files_without_ros_are_checked_except_types(tmp_path, capsys, monkeypatch):
    for name in [one for one in sys.modules if re.match(r"genpy|rosoclingo\.interfaces\.type_faults", one)]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "genpy", None)
    files = texts("garden")
    files["interfaces.yaml"] = files["interfaces.yaml"].replace("b: 200", "c: 200").replace("fill:", "fil:")
    programs = [
        tmp_path / "garden.lp",
        "--labels",
        tmp_path / "labels.yaml",
        "--interfaces",
        tmp_path / "interfaces.yaml",
    ]
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    assert check_command.main([*map(str, programs), "--json"], RobotFiles()) == 1
    printed = capsys.readouterr()
    assert sorted(one["kind"] for one in json.loads(printed.out)["findings"]) == ["idle-interface", "no-interface"]
    assert printed.err.startswith("check: message types are not checked: there is no module genpy")


YAML = st.recursive(
    st.none() | st.booleans() | st.integers(-5, 5) | st.text("ab$.{}[]/_1", max_size=6),
    lambda inside: (
        st.lists(inside, max_size=3)
        | st.dictionaries(
            st.sampled_from(["goal", "type", "returns", "facts", "when", "a", "$1.pose", "done", "x"]), inside
        )
    ),
    max_leaves=12,
)


@pytest.mark.slow
@given(YAML, YAML, st.text(max_size=30))
def test_robot_files_of_any_content_are_handled(tmp_path_factory, labels, interfaces, text):
    folder = tmp_path_factory.mktemp("files")
    (folder / "p.lp").write_text("#cumulative t.\n{ _action_lib(a,x,t) }.\n#volatile t.\n")
    for held in (json.dumps(labels), text):
        (folder / "labels.yaml").write_text(held, encoding="utf-8")
        (folder / "interfaces.yaml").write_text(json.dumps(interfaces), encoding="utf-8")
        command = [folder / "p.lp", "--labels", folder / "labels.yaml", "--interfaces", folder / "interfaces.yaml"]
        assert check_command.main(list(map(str, command)), RobotFiles()) in (0, 1)
