"""The option --verify of check: exit codes, what is printed, and that it is ready for oclingo."""

import json
import re

import pytest
from verified_programs import VISITS, edited, more

from rosoclingo.checking.check_command import main
from rosoclingo.checking.oclingo_command import main as oclingo

LATE = more(VISITS, ":- _action_lib(go,P,t), _closed(P,t).")


@pytest.fixture
def ask(tmp_path, capsys):
    """Run check on a program, and return its exit code and output."""

    def run(text, *options):
        (tmp_path / "program.lp").write_text(text)
        code = main([str(tmp_path / "program.lp"), "--steps", "8", *options])
        return code, capsys.readouterr()

    return run


@pytest.mark.slow
def test_what_is_clean(ask):
    code, told = ask(VISITS, "--verify", "1")
    assert code == 0
    assert re.search(r"^clean to depth 1: \d+ states, [\d.]+ s$", told.out, re.MULTILINE)
    assert "facts: _closed(den,1) _closed(hall,1); up to 2 cycles late, 1 early" in told.out


@pytest.mark.slow
def test_what_is_found_is_ready_for_oclingo(ask, tmp_path, capsys):
    code, told = ask(LATE, "--verify")
    assert code == 1
    assert "no-answer: the program has no answer after this" in told.out
    assert "program.lp:" in told.out, "the rule that forbids it"
    stream = tmp_path / "stream.txt"
    stream.write_text(told.out[told.out.index("\n%") : told.out.index("\n1 found")])
    assert oclingo([str(tmp_path / "program.lp"), "--shortest", "--stream", str(stream)]) == 20
    assert "Answer 1, horizon 1" in capsys.readouterr().out, "the first update had one"


@pytest.mark.slow
def test_json(ask):
    code, told = ask(LATE, "--verify", "--json")
    found = json.loads(told.out)["verify"]
    assert code == 1
    assert (found["clean"], found["proven"], found["depth"]) == (False, 1, 2)
    (fault,) = found["faults"]
    assert (fault["kind"], fault["events"]) == ("no-answer", 2)
    assert fault["stream"].startswith("#step 1 : 8.\n_request(")


def test_what_must_never_be_from_the_command_line(ask):
    code, told = ask(VISITS, "--verify", "1", "--fact", "none", "--never", "_action_lib(go,den,t), at(home,t-1).")
    assert code == 1
    assert "forbidden: what must never be: _action_lib(go,den,t), at(home,t-1)" in told.out


@pytest.mark.slow
def test_goals_facts_and_kinds_are_chosen(ask):
    code, told = ask(LATE, "--verify", "--goal", "visit(den)", "--fact", "none")
    assert code == 0
    assert "goals: visit(den)\n  facts: none\n" in told.out
    assert ask(LATE, "--verify", "--skip", "no-answer")[0] == 0
    assert ask(LATE, "--verify", "--late", "0", "--early", "0", "--one-plan", "--together", "1", "--each", "1")[0] == 0


@pytest.mark.slow
def test_oclingo_s_check_verifies_as_well(ask, tmp_path, capsys):
    code, told = ask(LATE, "--verify", "--json")
    assert oclingo(["--check", str(tmp_path / "program.lp"), "--steps", "8", "--verify", "--json"]) == code
    again, first = (json.loads(out)["verify"] for out in (capsys.readouterr().out, told.out))
    assert again["faults"] == first["faults"]


@pytest.mark.slow
def test_it_ends_with_what_is_true_when_time_is_over(ask):
    code, told = ask(VISITS, "--verify", "5", "--verify-seconds", "0.3")
    assert code == 1
    assert re.search(r"^stopped in depth \d after \d+ states, [\d.]+ s: (clean to depth \d|nothing is proven)$",
                     told.out, re.MULTILINE)  # fmt: skip


@pytest.mark.parametrize(
    ("options", "text"),
    [
        (["--goal", "visit("], "cannot be a goal"),
        (["--fact", "_opened"], "_opened is no external of the program"),
    ],
)
def test_what_cannot_be_asked(ask, options, text):
    code, told = ask(VISITS, "--verify", *options)
    assert code == 2
    assert text in told.err


def test_a_program_that_takes_no_goals(ask):
    code, told = ask(edited(VISITS, ("#external _request/2. ", "#defined _request/2. ")), "--verify")
    assert code == 2
    assert "takes no goals" in told.err
