"""The runner of the benches, with small repositories whose benches measure nothing; the options of the real benches."""

import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import run

pytestmark = pytest.mark.once
ROOT = Path(__file__).resolve().parents[3]
NEED_ROS = ("response", "ros_tours")
BENCH = """#!/usr/bin/env python3
import sys
from pathlib import Path
{more}
here = Path(__file__).resolve().parents[1]
value = int((here / "src" / "value").read_text())
figure = '{{"name": "{name}", "value": %d, "unit": "ms", "better": "lower"}}' % value
assert sys.argv[1:3] == ["--short", "--json"]
Path(sys.argv[3]).write_text(figure)
"""
DEV = '#!/bin/sh\n[ "$1" = exec ] && shift && exec "$@"\n'


class Repository:
    """A repository with a value that its bench reads, used instead of this one."""

    def __init__(self, folder, monkeypatch):
        self.folder = folder
        monkeypatch.setattr(run, "ROOT", folder)
        self.git("init", "--quiet")
        self.write("dev", DEV).chmod(0o755)

    def git(self, *words):
        name = ("-c", "user.name=test", "-c", "user.email=test@localhost")
        subprocess.run(["git", *name, *words], cwd=self.folder, check=True, timeout=300)

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        return path

    def bench(self, name, more=""):
        self.write("bench/speed.py", BENCH.format(name=name, more=more))

    def commit(self, value):
        self.write("src/value", str(value))
        self.git("add", "--all")
        self.git("commit", "--quiet", "-m", "a value")
        return run.commit_named("HEAD")


@pytest.fixture
def repository(tmp_path, monkeypatch):
    if not shutil.which("git"):
        pytest.skip("git is not there")
    monkeypatch.setenv("ROSOCLINGO_HOME", str(tmp_path))  # set by the runner
    (tmp_path / "repository").mkdir()
    return Repository(tmp_path / "repository", monkeypatch)


def compare(repository, commit, rounds=3):
    here = run.Checkout("here", repository.folder / "bench", [sys.executable])
    there = run.other_checkouts(commit, repository.folder.parent / "against")
    return [(row.name, row.here, row.there) for row in run.compare("speed", here, there, rounds)]


@pytest.mark.slow
def test_bench_run_uses_own_bench_if_commits_differ(repository, capfd):
    repository.bench("another value")
    commit = repository.commit(3)
    repository.bench("a value")
    repository.write("src/value", "2")  # not committed
    assert compare(repository, commit) == [("a value", (2.0,) * 3, (3.0,) * 3)]
    said = [line for line in capfd.readouterr().err.splitlines() if line.startswith("bench: ")]
    assert said == ["bench: speed: here", f"bench: speed: {commit[:8]}"] * 3


NEEDS_NEW = 'sys.path.append(str(Path(__file__).resolve().parents[1] / "src"))\nimport new'


@pytest.mark.slow
def test_bench_run_reports_bench_that_fails_on_commit(repository, capfd):
    commit = repository.commit(3)
    repository.bench("a value", NEEDS_NEW)
    repository.write("src/new.py", "")
    assert compare(repository, commit) == [("a value", (3.0,) * 3, ())]
    said = capfd.readouterr().err
    assert f"speed: not available in {commit[:8]}" in said
    assert "No module named 'new'" in said
    assert said.count(f"bench: speed: {commit[:8]}") == 2, "both benches are tried once"


def test_bench_run_reports_commit_that_cannot_be_built(repository):
    repository.write("dev", "#!/bin/sh\nexit 1\n").chmod(0o755)
    repository.bench("a value")
    with pytest.raises(run.BenchError, match="cannot be built"):
        compare(repository, repository.commit(3))


@pytest.mark.slow
def test_bench_run_prints_a_table(repository, tmp_path, monkeypatch, capsys):
    repository.bench("a value")
    repository.commit(3)
    monkeypatch.setattr(run, "BENCHES", ["speed"])
    monkeypatch.setattr(sys, "argv", ["run.py", "--work", str(tmp_path)])
    assert run.main() == 0
    head, row, _load = capsys.readouterr().out.splitlines()
    assert head.split() == ["bench", "figure", "unit", "best", "median"]
    assert row.split() == ["speed", "a", "value", "ms", "3", "3"]


@pytest.mark.parametrize("name", [one for one in run.BENCHES if one not in NEED_ROS])
def test_bench_prints_its_options_without_measuring(name, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", [name, "--help"])
    with pytest.raises(SystemExit) as end:
        runpy.run_path(str(ROOT / "bench" / f"{name}.py"), run_name="__main__")
    assert not end.value.code
    assert "--json" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("name", NEED_ROS)
def test_bench_of_nodes_prints_its_options(name):
    """In a process of its own, as here the sources without the built messages come first."""
    command = [sys.executable, str(ROOT / "bench" / f"{name}.py"), "--help"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    if "No module named 'rosoclingo.msg'" in done.stderr:
        pytest.skip("the messages are not built")
    assert done.returncode == 0, done.stderr
    assert "--json" in done.stdout


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["nosuch"], "no such bench: nosuch; the benches are cut_off "),
        (["golog", "--rounds", "0"], "--rounds must be at least 1"),
        (["golog", "--against", "nosuch"], "no such commit: nosuch"),
    ],
)
def test_bench_run_refuses_a_wrong_command_line(arguments, message, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["run.py", "--work", "/none", *arguments])
    with pytest.raises(SystemExit) as end:
        run.command_line()
    assert end.value.code == 2
    assert message in capsys.readouterr().err
