"""``check --plan``: samples, wrong requests, streams, JSON; test_check_page.py has tables and explanations."""

import json

import pytest

from rosoclingo.checking import check_command

PROGRAM = """\
#program base.
way(a,b). way(b,c).
at(a,0).
#program cumulative(t).
#external _request/2.
#external _return/3.
#external shut/2.
wanted(P,t) :- _request(go(P),t+1).
wanted(P,t) :- wanted(P,t-1), not at(P,t-1), not _request(cancel(P),t).
busy(t) :- wanted(P,t).
{ _action_lib(go,B,t) : way(A,B), at(A,t-1) } 1 :- busy(t).
failed(t) :- _action_lib(go,B,t), _return(go,V,t), V != B.
moved(t) :- _action_lib(go,B,t), not failed(t).
at(B,t) :- _action_lib(go,B,t), not failed(t).
at(A,t) :- at(A,t-1), not moved(t).
closed(B,t) :- shut(B,t).
closed(B,t) :- closed(B,t-1).
%! {B} is shut
:- _action_lib(go,B,t), closed(B,t).
#program volatile(t).
:- wanted(P,t), not at(P,t).
#show _action_lib/3.
"""


@pytest.fixture
def run(tmp_path, monkeypatch, capsys):
    """Run the command on the program; return exit code, output and errors."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "walk.lp").write_text(PROGRAM)
    (tmp_path / "walked.str").write_text(
        "#step 1. _request(go(b),2). #end step.\n#step 2. :- not _action_lib(go,b,1). #end step.\n"
    )

    def run_command(*arguments):
        code = check_command.main(["walk.lp", *arguments])
        return (code, *capsys.readouterr())

    return run_command


@pytest.mark.slow
def test_trial_plans_sample_each_kind_of_request(run, tmp_path):
    code, out, _ = run("--plan")
    assert code == 0
    assert "\ngo(b): a plan up to step 1\n" in out
    code, out, _ = run("--plan", "--plan", "go(c)", "--stream", "walked.str")
    assert "\ngo(c): a plan up to step 3\n" in out
    (tmp_path / "walk.lp").write_text("#program cumulative(t).\n#external _request/2.\np(t) :- _request(go(X),t).\n")
    assert "a sample: no request can be formed from the names in the facts" in run("--plan")[1]


@pytest.mark.slow
def test_trial_plans_explain_updates_without_an_answer(run, tmp_path):
    (tmp_path / "wrong.str").write_text("#step 1. _request(go(d),2). #end step.\n")
    code, out, _ = run("--stream", "wrong.str", "--plan", "go(b)")
    assert code == 1
    assert "update of step 1: No plan of at most 30 steps" in out


@pytest.mark.parametrize("text", ["go(X)", "", "go(c) :- go(d)"])
def test_trial_plan_rejects_a_wrong_request(run, text):
    code, _, error = run("--plan", text)
    assert code == 2
    assert f"--plan {text!r}" in error
    assert "write a term such as goal(office1,office2,1)" in error


def test_trial_plan_without_requests_accepts_facts(run, tmp_path):
    text = "#program cumulative(t).\n#external go(t).\n{ gone(t) } :- go(t).\n#program volatile(t).\n:- go(9).\n"
    (tmp_path / "walk.lp").write_text(text)
    assert run("--plan", "go(1)")[0] == 0
    code, _, error = run("--plan", "walk(1)")
    assert code == 2
    assert "the program takes no requests" in error


@pytest.mark.slow
def test_trial_plans_are_printed_as_json(run):
    code, out, _ = run("--plan", "go(c)", "--plan", "go(d)", "--json")
    first, second = json.loads(out)["plans"]
    assert code == 1
    assert first == {
        "name": "go(c)",
        "plan": ["_action_lib(go,b,1)", "_action_lib(go,c,2)"],
        "horizon": 2,
        "why": None,
        "fault": "",
    }
    assert second["why"]["rules"][0]["rule"]["line"] == 21


def test_trial_plan_reports_its_time_limit(run):
    code, out, _ = run("--plan", "go(c)", "--seconds", "0.000000001")
    assert code == 1
    assert out.endswith("go(c): no plan was found in 1e-09 s\n")
