"""The command gringo3to5, run as a program."""

import os
import subprocess
import sys

import pytest
from shipped import ROOT

MARK = "% dialect: clingo 5\n"
SCRIPT = ROOT / "scripts" / "gringo3to5"


def run(*arguments, stdin=b"", folder=None):
    environment = {**os.environ, "PYTHONPATH": str(ROOT / "src"), "PYTHONIOENCODING": "utf-8"}
    command = [sys.executable, str(SCRIPT), *map(str, arguments)]
    done = subprocess.run(command, input=stdin, capture_output=True, cwd=folder, env=environment, timeout=300)
    return done.returncode, done.stdout.decode(), done.stderr.decode()


@pytest.fixture
def files(tmp_path):
    (tmp_path / "one.lp").write_text("#domain f(X).\n{ p(X), q }.\n", encoding="utf-8")
    (tmp_path / "two.lp").write_text("r(X) :- not s, t : u, v.", encoding="utf-8")
    return tmp_path


@pytest.mark.slow
def test_gringo3to5_prints_translated_files_in_order(files):
    code, out, err = run("one.lp", "two.lp", folder=files)
    assert (code, err) == (0, "")
    assert out == f"\n{{ p(X); q }} :- f(X).\n{MARK}r(X) :- not s, t : u; v, f(X).\n{MARK}"


@pytest.mark.slow
def test_gringo3to5_writes_files_into_a_folder(files):
    (files / "new").mkdir()
    assert run("one.lp", "two.lp", "-o", "new", folder=files) == (0, "", "")
    assert (files / "new" / "one.lp").read_text() == f"\n{{ p(X); q }} :- f(X).\n{MARK}"
    code, _, err = run("one.lp", "-o", "two.lp", folder=files)
    assert (code, "cannot be written" in err) == (1, True)


def test_gringo3to5_reports_faults_without_any_output(files):
    (files / "bad.lp").write_text("#hide.\np(@f(1)).\nq :- r", encoding="utf-8")
    code, out, err = run("one.lp", "bad.lp", folder=files)
    assert (code, out) == (1, "")
    assert [line.split(": ")[0] for line in err.splitlines()] == ["bad.lp:2:3", "bad.lp:3:6"]


@pytest.mark.slow
def test_gringo3to5_reports_missing_and_undecodable_files(files):
    code, out, err = run("no.lp", folder=files)
    assert (code, out, err) == (1, "", "no.lp: cannot be read: No such file or directory\n")
    (files / "bytes.lp").write_bytes(b"p.\xff")
    code, _, err = run("bytes.lp", folder=files)
    assert (code, "bytes.lp: not UTF-8 text" in err, "save the file as UTF-8" in err) == (1, True, True)


@pytest.mark.slow
def test_gringo3to5_warns_about_untranslated_included_files(files):
    (files / "main.lp").write_text('#include "one.lp".\n#include "more/other.lp".', encoding="utf-8")
    code, _, err = run("main.lp", "one.lp", folder=files)
    message = (
        "warning: main.lp:2:1: the included file more/other.lp is not translated (also name it on the command line)\n"
    )
    assert (code, err) == (0, message)


@pytest.mark.slow
def test_gringo3to5_works_without_a_parser_cache(files, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(files / "cache"))
    expected = run("one.lp", folder=files)
    kept = list((files / "cache").rglob("grammars/*"))
    assert (expected[0], len(kept)) == (0, 1)
    kept[0].write_bytes(b"no parser")
    assert run("one.lp", folder=files) == expected
    monkeypatch.setenv("XDG_CACHE_HOME", str(files / "one.lp"))
    assert run("one.lp", folder=files) == expected
