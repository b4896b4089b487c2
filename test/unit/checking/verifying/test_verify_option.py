"""The option --verify of check: exit codes, output, and its stream as input of oclingo."""

import json
import re

import pytest
from verified_programs import VISITS, more

from rosoclingo.checking.check_command import main
from rosoclingo.checking.oclingo_command import main as oclingo

LATE = more(VISITS, ":- _action_lib(go,P,t), _closed(P,t).")


@pytest.fixture
def ask(tmp_path, capsys):
    """Return a function that checks a program and returns exit code and output."""

    def run(text, *options):
        (tmp_path / "program.lp").write_text(text)
        code = main([str(tmp_path / "program.lp"), "--steps", "8", *options])
        return code, capsys.readouterr()

    return run


@pytest.mark.slow
def test_verify_option_prints_a_stream_for_oclingo(ask, tmp_path, capsys):
    code, printed = ask(LATE, "--verify")
    assert code == 1
    assert "no-answer: the program has no answer after this" in printed.out
    assert "program.lp:" in printed.out, "the rule that excludes an answer is missing"
    stream = tmp_path / "stream.txt"
    stream.write_text(printed.out[printed.out.index("\n%") : printed.out.index("\n1 found")])
    assert oclingo([str(tmp_path / "program.lp"), "--shortest", "--stream", str(stream)]) == 20
    assert "Answer 1, horizon 1" in capsys.readouterr().out, "the first update has an answer"


@pytest.mark.slow
def test_verify_option_prints_json_as_oclingo_check_does(ask, tmp_path, capsys):
    code, printed = ask(LATE, "--verify", "--json")
    found = json.loads(printed.out)["verify"]
    assert code == 1
    assert (found["clean"], found["proven"], found["depth"]) == (False, 1, 2)
    (fault,) = found["faults"]
    assert (fault["kind"], fault["events"]) == ("no-answer", 2)
    assert fault["stream"].startswith("#step 1 : 8.\n_request(")
    assert oclingo(["--check", str(tmp_path / "program.lp"), "--steps", "8", "--verify", "--json"]) == code
    assert json.loads(capsys.readouterr().out)["verify"]["faults"] == found["faults"]


def test_verify_option_finds_forbidden_states(ask):
    code, printed = ask(VISITS, "--verify", "1", "--fact", "none", "--never", "_action_lib(go,den,t), at(home,t-1).")
    assert code == 1
    assert "forbidden: a forbidden state occurs: _action_lib(go,den,t), at(home,t-1)" in printed.out


@pytest.mark.slow
def test_verify_option_selects_goals_facts_and_kinds(ask):
    code, printed = ask(LATE, "--verify", "--goal", "visit(den)", "--fact", "none")
    assert code == 0
    assert "goals: visit(den)\n  facts: none\n" in printed.out
    assert ask(LATE, "--verify", "--skip", "no-answer")[0] == 0
    assert ask(LATE, "--verify", "--late", "0", "--early", "0", "--one-plan", "--together", "1", "--each", "1")[0] == 0


@pytest.mark.slow
def test_verify_option_states_the_proven_depth_at_timeout(ask):
    code, printed = ask(VISITS, "--verify", "5", "--verify-seconds", "0.3")
    assert code == 1
    assert re.search(r"^stopped in depth \d after \d+ states, [\d.]+ s: (clean to depth \d|nothing is proven)$",
                     printed.out, re.MULTILINE)  # fmt: skip


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--goal", "visit("], "cannot be a goal"),
        (["--fact", "_opened"], "_opened is not an external of the program"),
    ],
)
def test_verify_option_rejects_wrong_events(ask, options, text):
    code, printed = ask(VISITS, "--verify", *options)
    assert code == 2
    assert text in printed.err
