"""The command oclingo: options, streams, prompt, service process, errors and exit codes."""

import json
import re
import signal
import subprocess
import sys

import pytest
from plain_walk import program_text
from service_helpers import Client
from shipped import ROOT

from rosoclingo.checking.oclingo_command import main

SCRIPT = ROOT / "scripts" / "oclingo"
PAGE = ROOT / "doc" / "oclingo_service.md"

PROGRAM = """\
#const n = 2.
#program base.
place(1..n).
#program cumulative(t).
#external go(t).
{ at(X,t) : place(X) } = 1 :- go(t).
#program volatile(t).
:- at(9,t).
#show at/2.
"""
ENDLESS = "#cumulative t.\n#external e(t).\nc(t) :- e(t).\n#volatile t.\n:- not c(t).\n"
EXPLODING = """\
#cumulative t.
#external e(t).
n(0,t) :- t > 1.
n(X+1,t) :- n(X,t), X < 2000000000.
#volatile t.
:- n(-1,t).
"""
STREAM = """\
#step 1.
go(1).
#endstep.
% comment
#step 2. go(2). :- not at(2,1). #end step.
#step 2 : 1. :- at(2,1). #endstep.
"""


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Change to a folder with programs and a stream."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "program.lp").write_text(PROGRAM, encoding="utf-8")
    (tmp_path / "endless.lp").write_text(ENDLESS, encoding="utf-8")
    (tmp_path / "exploding.lp").write_text(EXPLODING, encoding="utf-8")
    (tmp_path / "updates.str").write_text(STREAM, encoding="utf-8")
    before = signal.getsignal(signal.SIGTERM)
    yield tmp_path
    signal.signal(signal.SIGTERM, before)


def play(capsys, *words):
    """Run the command in this process; return exit code, standard output and standard error."""
    code = main(words)
    return (code, *capsys.readouterr())


def start(*words, **options):
    command = [sys.executable, str(SCRIPT), *words]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **options)


def run(*words, text=""):
    """Run the command as a process with ``text`` on standard input; return the same values."""
    with start(*words, stdin=subprocess.PIPE) as process:
        output, error = process.communicate(text)
    return process.returncode, output, error


class Serving:
    """A process of the command that serves clients."""

    def __init__(self, *words):
        self.process = start(*words, "--port", "0")
        line = self.process.stdout.readline()
        assert line.startswith("Listening on 127.0.0.1:"), self.process.stderr.read()
        self.port = int(line.rsplit(":", 1)[1])

    def client(self):
        return Client(self.port)

    def end(self, number=None):
        """Send a signal, if any; return exit code and standard error."""
        if number is not None:
            self.process.send_signal(number)
        error = self.process.communicate(timeout=300)[1]
        return self.process.returncode, error

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.communicate()


def test_stream_prints_updates_with_answers_as_tables(files, capsys):
    code, output, error = play(capsys, "program.lp", "0", "--stream", "updates.str")
    assert (code, error) == (20, "")
    assert output.startswith("#step 1.\ngo(1).\n#end step.\nAnswer 1, horizon 1\n")
    assert output.count("Answer 2, horizon 1") == 1
    assert output.count("at(2,t)  x x") == 1
    assert output.endswith(":- at(2,1).\n#end step.\nUNSAT at step 3, for good\n\n")


def test_stream_prints_one_json_object_per_update(files, capsys):
    code, output, _ = play(capsys, "program.lp", "0", "--stream", "updates.str", "--json")
    first, second, third = map(json.loads, output.splitlines())
    assert code == 20
    assert (first["step"], first["horizon"], first["outcome"]) == (1, 1, "satisfiable")
    assert sorted(first["answers"]) == [["at(1,1)"], ["at(2,1)"]]
    assert first["warnings"] == []
    assert second["update"] == "#step 2.\ngo(2).\n:- not at(2,1).\n#end step.\n"
    assert (third["outcome"], third["answers"], third["permanent"], third["horizon"]) == ("unsatisfiable", [], True, 3)


@pytest.mark.slow
def test_command_passes_options_to_the_solver(files, capsys):
    _, output, _ = play(capsys, "program.lp", "-c", "n=3", "0", "--stream", "updates.str", "--json")
    assert len(json.loads(output.splitlines()[0])["answers"]) == 3
    _, output, _ = play(capsys, "program.lp", "--stream", "updates.str", "--json")
    assert len(json.loads(output.splitlines()[0])["answers"]) == 1, "the default is one answer"
    code, output, _ = play(capsys, "program.lp", "--imax=1", "--stream", "updates.str", "--json")
    assert code == 1
    assert "beyond the horizon limit 1" in json.loads(output.splitlines()[1])["error"]


@pytest.mark.slow
def test_time_limit_interrupts_an_unbounded_search(files, capsys):
    (files / "updates.str").write_text("#step 1. #endstep. #step 1. e(1). :- not c(1). #endstep.", encoding="utf-8")
    code, output, _ = play(capsys, "endless.lp", "--stream", "updates.str", "--bound", "0", "--time-limit", "0.1")
    assert code == 0
    assert "Interrupted at horizon " in output


@pytest.mark.slow
def test_bound_option_applies_to_unbounded_updates(files, capsys):
    text = "#endstep. #step 1. #endstep. #step 2 : 1. #endstep. #step 3. #endstep. #endstep."
    (files / "updates.str").write_text(text, encoding="utf-8")
    code, output, _ = play(capsys, "endless.lp", "--stream", "updates.str", "--json", "--bound", "5")
    horizons = [json.loads(line)["horizon"] for line in output.splitlines()]
    assert (code, horizons) == (20, [6, 6, 6, 8, 8])
    text = "#step 1. #endstep."
    (files / "updates.str").write_text(text, encoding="utf-8")
    code, output, _ = play(capsys, "endless.lp", "--stream", "updates.str")
    assert code == 20
    assert output == "#step 1.\n#end step.\nUNSAT at step 101\n\n"


def test_stream_errors_are_reported_and_skipped(files, capsys):
    text = "#step 1.\ngo(X).\n#endstep.\n#step 1. go(1). bad(1). at(1,9). #endstep.\n#step 1. #endstep. go"
    (files / "updates.str").write_text(text, encoding="utf-8")
    code, output, _ = play(capsys, "program.lp", "--stream", "updates.str")
    assert code == 1
    assert "updates.str:2:4: X is a variable" in output
    assert "Warning: Head at(1,9) has not been declared external. The entire rule will be ignored." in output
    assert "updates.str:5:22: " in output
    assert output.count("Answer 1, horizon 1") == 2


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["none.lp"], "none.lp: can't be read: No such file"),
        (["program.lp", "-c", "n"], "-c n: value missing (write NAME=VALUE)"),
        (["program.lp", "--stream", "none.str"], "none.str: can't be read: No such file"),
        (["program.lp", "--stream", "bytes.str"], "bytes.str"),
        (["program.lp", "--host", "no.such.host.invalid"], "can't listen on no.such.host.invalid:25277"),
    ],
    ids=lambda words: " ".join(words) if isinstance(words, list) else "",
)
def test_command_reports_invalid_files_and_options(files, capsys, words, message):
    (files / "bad.lp").write_text("a(X).\nb(", encoding="utf-8")
    (files / "bytes.str").write_bytes(b"#step 1. \xff #endstep.")
    code, output, error = play(capsys, *words)
    assert (code, output) == (1, "")
    assert message in error
    assert "Traceback" not in error


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["program.lp", "--json"], "--json needs --stream, --interactive or --check"),
        (["program.lp", "--stream", "a", "--bound", "-1"], "is not an integer from 0"),
        (["program.lp", "--port", "70000"], "'70000' is not an integer from 0 to 65535"),
        (["program.lp", "--imax", "0"], "'0' is not an integer from 1"),
        (["program.lp", "--time-limit", "-1"], "'-1' is not a time in seconds"),
        (["program.lp", "--stream", "a", "--port", "1"], "--host and --port cannot be combined"),
        (["-", "--stream", "-"], "standard input contains the updates"),
        (["-", "-"], "standard input can be read only once"),
        (["program.lp", "--stream", "a", "--plan-time", "1"], "--plan-time needs --shortest"),
        (["--what"], "--what"),
    ],
    ids=lambda words: " ".join(words) if isinstance(words, list) else "",
)
def test_command_rejects_wrong_command_lines(files, capsys, words, message):
    with pytest.raises(SystemExit) as found:
        main(words)
    assert found.value.code == 2
    assert message in capsys.readouterr().err


@pytest.mark.slow
def test_command_reads_program_or_stream_from_standard_input(files):
    assert run("-", "0", "--stream", "updates.str", text=PROGRAM)[1].count("Answer 2") == 2
    assert run("program.lp", "--stream", "-", text=STREAM)[1].count("Answer 1") == 2
    code, output, error = run("--stream", "updates.str", text="a(X).")
    assert (code, output) == (1, "")
    assert error.startswith("<stdin>:1:1: unsafe variable X")


@pytest.mark.slow
def test_interactive_prompt_answers_until_stop(files):
    text = "#step 1.\ngo(1). go(X).\n#endstep.\n#step 1. go(1).\n#endstep.\n#stop.\n#step 2. #endstep.\n"
    code, output, error = run("program.lp", "0", "--interactive", text=text)
    assert (code, error) == (0, "")
    assert "<input>:2:11: X is a variable" in output
    assert output.count("Answer") == 2, "text after #stop. is ignored"
    assert run("program.lp", "--interactive", "--json", text="#step 1. go(1). #endstep. #step 2.")[1].count("\n") == 2


@pytest.mark.slow
def test_service_loads_two_files_and_stops(files):
    (files / "more.lp").write_text("#program base.\nplace(7).\n", encoding="utf-8")
    with Serving("program.lp", "more.lp", "0") as serving:
        client = serving.client()
        assert client.ask("#step 1. go(1). #endstep.").sets == [["at(1,1)"], ["at(2,1)"], ["at(7,1)"]]
        client.send("#stop.")
        assert client.item() is None
        assert serving.end() == (0, "")


@pytest.mark.sampled(2)
@pytest.mark.slow
@pytest.mark.parametrize(("number", "message"), [(signal.SIGINT, "stopped\n"), (signal.SIGTERM, "")])
@pytest.mark.parametrize("program", ["endless.lp", "exploding.lp", "program.lp"])
def test_signal_ends_the_service_in_any_state(files, program, number, message):
    with Serving(program) as serving:
        client = serving.client()
        client.send("#step 2. #endstep.")
        assert client.item() == "Input:\n"
        code, error = serving.end(number)
        assert (code, error) == (0, message)
    assert client.socket.recv(4096) == b"" or program == "program.lp"


@pytest.mark.slow
def test_ctrl_c_interrupts_only_the_search(files):
    with start("endless.lp", "--interactive", stdin=subprocess.PIPE) as process:
        process.stdin.write("#step 1. #endstep.\n")
        process.stdin.flush()
        while process.stdout.readline() not in ("#end step.\n", ""):
            pass
        process.send_signal(signal.SIGINT)
        assert process.stdout.readline().startswith("Interrupted at horizon ")
        output, error = process.communicate("#step 1 : 0. #endstep.\n#stop.\n", timeout=300)
    assert "UNSAT at step " in output
    assert (process.returncode, error) == (0, "")


@pytest.mark.slow
def test_plan_time_limits_the_proof_of_shortness(files, capsys):
    (files / "walk.lp").write_text(program_text(), encoding="utf-8")
    (files / "walk.str").write_text("#step 1. _request(3,1). _request(-2,1). #endstep.\n", encoding="utf-8")
    words = ["walk.lp", "--stream", "walk.str", "--json", "--shortest"]
    found = []
    for more in ([], ["--plan-time", "0"], ["--plan-time", "1e6"]):
        assert main([*words, *more]) == 0
        found.append(json.loads(capsys.readouterr().out))
    assert [one["outcome"] for one in found] == 3 * ["satisfiable"]
    assert [one["shortest"] for one in found] == [True, False, True]
    assert found[0]["horizon"] == found[2]["horizon"] <= found[1]["horizon"]


@pytest.mark.slow
def test_shortest_answers_end_with_the_horizon(files, capsys):
    blocks = PAGE.read_text(encoding="utf-8").split("```\n")
    (files / "lift.lp").write_text(blocks[1], encoding="utf-8")
    (files / "calls.str").write_text(blocks[3], encoding="utf-8")
    words = ["lift.lp", "--stream", "calls.str"]
    assert play(capsys, *words, "--shortest") == play(capsys, *words)


def test_service_page_documents_all_command_options(capsys):
    with pytest.raises(SystemExit):
        main(["--help"])
    options = set(re.findall(r"--[a-z-]+", capsys.readouterr().out)) - {"--help", "--const"}  # -c is the short form
    usage, _, table = PAGE.read_text(encoding="utf-8").partition("## Options")[2].partition("\n|")
    assert set(re.findall(r"--[a-z-]+", usage)) == options
    assert set(re.findall(r"^\| `(--[a-z-]+)", table, re.MULTILINE)) == options
