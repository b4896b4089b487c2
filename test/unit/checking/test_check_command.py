"""The command ``check``, and ``oclingo --check``: output, exit codes, unreadable files; see also test_check_page.py."""

import json
import subprocess
import sys

import lint_programs
import pytest

from rosoclingo.checking import check_command, oclingo_command

PROGRAM = """#program cumulative(t).
#external call(F,t) : F = 0..5.
{ up(t) }.
open(F,t) :- cal(F,t).
#program volatile(t).
:- open(F,t), not up(t).
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lift.lp").write_text(PROGRAM)
    (tmp_path / "right.lp").write_text(PROGRAM.replace("cal(", "call("))
    (tmp_path / "calls.str").write_text(
        "#step 1.\ncall(7,1).\n#endstep.\n#step 2.\nup(. #endstep.\n#step 3. #endstep.\n"
    )
    return tmp_path


@pytest.fixture
def run(capsys):
    """Run the command; return exit code, output and errors."""

    def run_command(*arguments, main=check_command.main):
        code = main(arguments)
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return run_command


@pytest.mark.parametrize("arguments", [("lift.lp",), ("right.lp", "--stream", "calls.str"), ("nofile.lp",)])
def test_oclingo_check_prints_the_same(folder, run, arguments):
    assert run("--check", *arguments, main=oclingo_command.main) == run(*arguments)


def test_check_reports_all_files_at_once(folder, run):
    (folder / "more.lp").write_text("a(X) :- not b.\n_request(1).\n#program cumulative(t).\nc :- up(t).\n")
    code, out, _ = run("lift.lp", "more.lp", "-c", "n=3")
    assert code == 1
    assert [line.split(": ")[:2] for line in out.splitlines() if " | " not in line and ": " in line] == [
        ["lift.lp:1:1", "warning"],
        ["lift.lp:1:1", "warning"],
        ["lift.lp:4:14", "warning"],
        ["more.lp:1:1", "error"],
        ["more.lp:1:13", "warning"],
        ["more.lp:2:1", "error"],
        ["more.lp:4:1", "warning"],
        ["constant n", "error"],
    ], out


def test_check_reports_faults_of_a_stream(folder, run):
    code, out, _ = run("right.lp", "--stream", "calls.str")
    printed = [line for line in out.splitlines() if line.startswith("calls.str")]
    assert code == 1
    assert printed[0].startswith(
        "calls.str:2:1: warning: call/2 is never external with 7 as argument 1 (known: 0, 1, 2"
    )
    assert printed[1].startswith("calls.str:5:4: error: ")
    assert len(printed) == 2


def test_check_prints_findings_as_json(folder, run):
    code, out, _ = run("lift.lp", "--json")
    report = json.loads(out)
    (one,) = report.pop("findings")
    assert (code, report) == (1, {"errors": 0, "warnings": 1, "files": ["lift.lp"]})
    assert one == {
        "kind": "undefined",
        "severity": "warning",
        "file": "lift.lp",
        "line": 4,
        "column": 14,
        "message": "no rule and no #external defines cal/2: it is never true",
        "remedy": "did you mean call/2? otherwise write #defined cal/2.",
    }
    code, out, _ = run("right.lp", "--json")
    assert (code, json.loads(out)["findings"]) == (0, [])


@pytest.mark.parametrize(
    "arguments",
    [
        ["nofile.lp", "nor_this.lp"],
        ["lift.lp", "-c", "n"],
        ["lift.lp", "-c", "n=X"],
        ["lift.lp", "--stream", "none.str"],
    ],
)
def test_check_reports_unreadable_files(folder, run, arguments):
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    missing = [one for one in arguments if one in ("nofile.lp", "nor_this.lp", "none.str", "n", "n=X")]
    assert len(err.splitlines()) == len(missing)
    assert all(one in line for one, line in zip(missing, err.splitlines()))


@pytest.mark.slow
def test_check_script_reads_standard_input():
    script = lint_programs.ROOT / "scripts" / "check"
    done = subprocess.run(
        [sys.executable, script, "-"], input=PROGRAM, capture_output=True, text=True, check=False, timeout=300
    )
    assert done.returncode == 1
    assert done.stdout.startswith("<stdin>:4:14: warning: no rule")


@pytest.mark.parametrize("name", ["assert_retract", "back", "bodies", "bound"])
def test_check_accepts_streams_of_the_real_oclingo(folder, run, name):
    (case,) = [one for one in lint_programs.GOLDEN if one["name"] == name]
    (folder / "golden.lp").write_text(case["program"], encoding="utf-8")
    (folder / "golden.str").write_text("".join(one["update"] for one in case["updates"]), encoding="utf-8")
    assert run("golden.lp", "--stream", "golden.str") == (0, "no findings in 2 files\n", "")
