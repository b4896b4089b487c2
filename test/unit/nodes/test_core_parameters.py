import re

import pytest

from rosoclingo.common.labels import Label
from rosoclingo.common.parameters import ParameterError
from rosoclingo.nodes.core.loading import CoreParameters, core_parameters, load_program
from rosoclingo.oclingo import ProgramError, ReactiveSolver
from rosoclingo.reasoning.settings import CoreSettings


@pytest.fixture
def program(tmp_path):
    path = tmp_path / "program.lp"
    path.write_text("#const n = 1.\n#program cumulative(t).\nat(n,t).\n")
    return str(path)


def test_core_parameters_are_all_read(program):
    values = {
        "program_files": program,
        "constants": {"n": 4},
        "labels": {"office1": {"x": 1.0, "y": 2.0, "title": "Anna's"}},
        "horizon_limit": 7,
        "action_timeout": 5,
        "search_timeout": 0,
        "recovery_timeout": 2,
        "preempt": True,
        "learn_durations": False,
        "goals_at_once": 5,
        "overtaking_limit": 7,
        "interface_timeout": 4,
        "lost_timeout": 30,
        "plan": "shortest",
        "plan_time": 3,
        "journal": "~/kept",
        "resume": "yes",
        "required": True,
        "places": "place(a).",
    }
    found = core_parameters(values)
    assert found == CoreParameters(
        (program,),
        {"n": "4"},
        ("office1",),
        CoreSettings(7, 5.0, True, 5, 7, 0.0, False, 4.0, 30.0),
        2.0,
        "shortest",
        3.0,
        "~/kept",
        "yes",
        True,
        "place(a).",
        (Label("office1", 1.0, 2.0, title="Anna's"),),
    )
    assert found.time_to_shorten is None
    assert found.deciding["titles"] == {"office1": "Anna's"}


def test_core_parameters_resume_accepts_yaml_booleans(program):
    found = [core_parameters({"program_files": program, "resume": one}).resume for one in (True, False)]
    assert found == ["yes", "no"]


@pytest.mark.parametrize(
    ("labels", "reported"),
    [
        ({"a": [1, 2, 0.5], "b": {"x": 0, "y": 1, "frame": "map"}}, {"a": [1.0, 2.0, 0.5], "b": [0.0, 1.0, 0.0]}),
        ({"a": [1, 2], "dock": {"x": 0, "y": 0, "frame": "odom"}}, {"a": [1.0, 2.0, 0.0]}),
        (["a", "b"], {}),
        ({"a": {}, "b": None}, {}),
    ],
    ids=["poses", "another frame", "names", "none"],
)
def test_core_parameters_pass_label_file_to_program(program, labels, reported):
    found = core_parameters({"program_files": program, "labels": labels})
    assert found.deciding["labels"] == reported
    assert len(found.labels) == 2


@pytest.mark.parametrize(
    ("name", "value", "remedy"),
    [
        ("program_files", [], "must be a list of paths of ASP programs"),
        ("program_files", ["/no/such/file.lp"], "there is no file '/no/such/file.lp'"),
        ("constants", [1], "must be a map of names to values"),
        ("constants", {"n": "X"}, "not an ASP term"),
        ("labels", 3, "must be a map whose keys are the labels"),
        ("labels", {"Office One": {}}, "not an ASP term"),
        ("horizon_limit", 0, "must be an integer of at least 1"),
        ("action_timeout", -1, "must be seconds, 0 for no limit"),
        ("interface_timeout", -1, "must be seconds, 0 for never"),
        ("interface_timeout", 2.5, "announce themselves once a second: use at least 3"),
        ("search_timeout", float("inf"), "must be seconds, 0 for no limit"),
        ("goals_at_once", -1, "must be an integer of at least 0"),
        ("plan", "quick", "must be one of soon, shortest"),
        ("plan_time", -1, "must be seconds"),
        ("preempt", 1, "must be true or false"),
        ("resume", "perhaps", "must be one of ask, yes, no"),
    ],
)
def test_core_parameters_faults_name_parameter_and_remedy(program, name, value, remedy):
    with pytest.raises(ParameterError, match=re.escape(remedy)) as error:
        core_parameters({"program_files": [program], name: value})
    assert f"~{name}" in str(error.value)


def test_core_parameters_reach_the_program(program):
    values = {"constants": {"n": 3}, "labels": ["kitchen"], "places": "#program base.\nplace(hall)."}
    loaded, _ = load_program(core_parameters({"program_files": [program], **values}))
    answer = {str(atom) for atom in ReactiveSolver(loaded).solve().answers[0]}
    assert answer == {"at(3,1)", "label(kitchen)", "place(hall)"}


def test_core_parameters_name_places_that_are_no_facts(program):
    with pytest.raises(ProgramError, match="~places:1:12"):
        load_program(core_parameters({"program_files": program, "places": "place(hall)\n#program"}))


def test_core_parameters_reject_constants_unknown_to_program(program):
    with pytest.raises(ParameterError) as error:
        load_program(core_parameters({"program_files": [program], "constants": {"n": "one", "m": 2}}))
    assert str(error.value).splitlines() == [
        f"~constants: n is one, but the program's own value is 1 ({program}:1) (give a number)",
        "~constants: the program has no #const m (its constants are n)",
    ]
    _, odd = load_program(core_parameters({"program_files": [program], "constants": {"n": -1}}))
    (reported,) = [one for one in odd if "negative-constant" in one]
    assert reported.startswith("constant n: n is -1")


def test_core_parameters_report_constant_that_prevents_loading(tmp_path):
    path = tmp_path / "program.lp"
    path.write_text("#const w = 2.\n#volatile t : w.\n:- a(t).\n#program cumulative(t).\n{a(t)}.\n")
    with pytest.raises(ParameterError, match=r"w is soon, but the program's own value is 2 \(.*:1\) \(give a number\)"):
        load_program(core_parameters({"program_files": [str(path)], "constants": {"w": "soon"}}))


def test_core_parameters_lint_findings_are_logged_at_start(tmp_path):
    path = tmp_path / "drive.lp"
    path.write_text(
        "#external _request/2. #external _return/3.\nplace(hall).\n#program cumulative(t).\n"
        "{ _action_lib(move_base,P,t) : place(P) } 1 :- _request(go,t), not _return(move_base,failed,t).\n"
        "low(t) :- brocken(t).\n#program volatile(t).\n"
    )
    labels = {"hall": [1.0, 1.0], "attic": [3.0, 3.0]}
    _, odd = load_program(core_parameters({"program_files": [str(path)], "labels": labels}))
    assert [re.sub(r" \(.*\)", "", one.replace(str(path), "drive.lp")) for one in odd] == [
        "drive.lp:5:11: no rule and no #external defines brocken/1: it is never true [undefined]",
        "~labels: no action uses the label attic [idle-label]",
    ]
