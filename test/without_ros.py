#!/usr/bin/env python3
"""Checks the pip installation of a clone in a bare virtual environment: ``test/without_ros.py PYTHON...``.

For each Python the commands exist and give the answers of the real oClingo, and no library outside pyproject.toml is
needed. The clone stays unchanged.
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
NEEDED = ("src", "setup.py", "pyproject.toml", "package.xml", "LICENSE", "README.md")
CASES = json.loads((ROOT / "test" / "data" / "oclingo_golden.json").read_text(encoding="utf-8"))
OLD = "#domain f(X).\n{ p(X), q }.\n"
ALL = (
    "import importlib, pkgutil, rosoclingo.oclingo as room\n"
    "names = [one.name for one in pkgutil.walk_packages(room.__path__, room.__name__ + '.')]\n"
    "names = [name for name in names if not name.endswith('worker')]\n"
    "[importlib.import_module(name) for name in names]\n"
    "print(len(names))"
)


def copied(folder):
    """Copy the files of a clone that pip reads, since pip builds in place."""
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for name in NEEDED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, folder / name, ignore=ignored)
        else:
            shutil.copy(ROOT / name, folder / name)
    return folder


def output_of(*command, **options):
    """Return the output of a command, run in a temporary folder."""
    done = subprocess.run([str(word) for word in command], check=False, capture_output=True, text=True, **options)
    assert done.returncode == 0, f"{command}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout


def words_of(update):
    """Return its answers as sorted words, like the recorded ones of oClingo, since strings can contain spaces."""
    return sorted(sorted(" ".join(answer).split()) for answer in update["answers"])


def check_answers(oclingo, folder):
    """Play golden streams; return how many could be compared to their ends."""
    compared = 0
    for case in CASES:
        if any(one["end"] not in ("ok", "unsat") for one in case["updates"]):
            continue
        (folder / "program.lp").write_text(case["program"], encoding="utf-8")
        (folder / "updates.str").write_text("".join(one["update"] for one in case["updates"]), encoding="utf-8")
        command = [oclingo, "program.lp", "0", "--stream", "updates.str", "--json"]
        done = subprocess.run(list(map(str, command)), cwd=folder, check=False, capture_output=True, text=True)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        if len(lines) != len(case["updates"]):
            continue  # like the stream's updates after the first permanently unsatisfiable one
        for line, wanted in zip(lines, case["updates"]):
            assert words_of(line) == words_of(wanted), (case["name"], line, wanted)
            assert line["horizon"] == wanted["horizon"], (case["name"], line, wanted)
        compared += 1
    assert compared > len(CASES) // 2, f"only {compared} of {len(CASES)} could be compared"
    return compared


def check(python, source, folder):
    """Install for one Python, and try the installation."""
    output_of(python, "-m", "venv", folder / "venv")
    programs = folder / "venv" / "bin"
    output_of(programs / "python3", "-m", "pip", "install", "--disable-pip-version-check", "--no-input", source)
    own = {"env": {"PATH": f"{programs}:/usr/bin:/bin"}, "cwd": folder}
    version = output_of(programs / "python3", "-V").strip()
    print(f"{version}: {output_of(programs / 'python3', '-c', ALL, **own).strip()} modules imported")
    streams = check_answers(programs / "oclingo", folder)
    print(f"{version}: {streams} streams answered as the real oClingo does", flush=True)
    (folder / "odd.lp").write_text("place(home). here(X) :- plcae(X). #show here/1.\n", encoding="utf-8")
    odd = subprocess.run(
        [programs / "oclingo", "--check", "odd.lp"], check=False, capture_output=True, text=True, **own
    )
    assert odd.returncode == 1, odd
    assert "odd.lp:1:" in odd.stdout, odd
    assert "place/1" in odd.stdout, odd
    (folder / "right.lp").write_text(CASES[0]["program"], encoding="utf-8")
    assert output_of(programs / "check", "right.lp", **own) == "no findings in 1 file\n"
    (folder / "old.lp").write_text(OLD, encoding="utf-8")
    assert output_of(programs / "gringo3to5", "old.lp", **own) == "\n{ p(X); q } :- f(X).\n% dialect: clingo 5\n"
    check_golog(programs, folder, own)


def check_golog(programs, folder, own):
    """Translate a control program, and run the shipped one."""
    (folder / "wait.golog").write_text("proc wait { await ready; }\n", encoding="utf-8")
    assert "golog_body(wait,await(" in output_of(programs / "golog", "wait.golog", **own)
    (folder / "calls.lp").write_text("#program base. calls(3).\n", encoding="utf-8")
    (folder / "run.txt").write_text("#step 1. _request(run(control,1),2). #endstep.\n", encoding="utf-8")
    files = [ROOT / "encodings" / "golog" / "elevator.golog", "calls.lp"]
    assert output_of(programs / "check", *files, **own) == "no findings in 7 files\n"
    done = output_of(programs / "oclingo", *files, "--shortest", "--stream", "run.txt", **own)
    assert "_action_lib(turnoff,3,t)" in done, done


def main():
    """Run the checks for each Python of the command line, by default this one."""
    with tempfile.TemporaryDirectory() as name:
        source = copied(Path(name))
        for number, python in enumerate(sys.argv[1:] or [sys.executable]):
            folder = source / f"python{number}"
            folder.mkdir()
            check(python, source, folder)


if __name__ == "__main__":
    main()
