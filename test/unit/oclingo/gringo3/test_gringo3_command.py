"""The command gringo3to5."""

import subprocess
import sys

import pytest
from shipped import ROOT

from rosoclingo.oclingo.gringo3.translate_command import main

MARK = "% dialect: clingo 5\n"
SCRIPT = ROOT / "scripts" / "gringo3to5"


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Change to a folder with two programs."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "one.lp").write_text("#domain f(X).\n{ p(X), q }.\n", encoding="utf-8")
    (tmp_path / "two.lp").write_text("r(X) :- not s, t : u, v.", encoding="utf-8")
    return tmp_path


@pytest.fixture
def run(files, capsys):
    """Run the command; return exit code, output and errors."""
    return lambda *arguments: (main(arguments), *capsys.readouterr())


def test_gringo3to5_prints_translated_files_in_order(run):
    code, out, err = run("one.lp", "two.lp")
    assert (code, err) == (0, "")
    assert out == f"\n{{ p(X); q }} :- f(X).\n{MARK}r(X) :- not s, t : u; v, f(X).\n{MARK}"


def test_gringo3to5_writes_files_into_a_folder(run, files):
    (files / "new").mkdir()
    assert run("one.lp", "two.lp", "-o", "new") == (0, "", "")
    assert (files / "new" / "one.lp").read_text() == f"\n{{ p(X); q }} :- f(X).\n{MARK}"
    code, _, err = run("one.lp", "-o", "two.lp")
    assert (code, "cannot be written" in err) == (1, True)


def test_gringo3to5_reports_faults_without_any_output(run, files):
    (files / "bad.lp").write_text("#hide.\np(@f(1)).\nq :- r", encoding="utf-8")
    code, out, err = run("one.lp", "bad.lp")
    assert (code, out) == (1, "")
    assert [line.split(": ")[0] for line in err.splitlines()] == ["bad.lp:2:3", "bad.lp:3:6"]


def test_gringo3to5_reports_missing_and_undecodable_files(run, files):
    assert run("no.lp") == (1, "", "no.lp: cannot be read: No such file or directory\n")
    (files / "bytes.lp").write_bytes(b"p.\xff")
    code, _, err = run("bytes.lp")
    assert (code, "bytes.lp: not UTF-8 text" in err, "save the file as UTF-8" in err) == (1, True, True)


def test_gringo3to5_warns_about_untranslated_included_files(run, files):
    (files / "main.lp").write_text('#include "one.lp".\n#include "more/other.lp".', encoding="utf-8")
    code, _, err = run("main.lp", "one.lp")
    message = "main.lp:2:1: the included file more/other.lp is not translated (also name it on the command line)"
    assert (code, err) == (0, f"warning: {message}\n")


@pytest.mark.slow
def test_gringo3to5_works_without_a_parser_cache(files, monkeypatch):
    def translate():
        """Run the command as a process; return its output."""
        return subprocess.run(
            [sys.executable, SCRIPT, "one.lp"], stdout=subprocess.PIPE, timeout=300, check=True
        ).stdout

    monkeypatch.setenv("PYTHONPATH", str(ROOT / "src"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(files / "cache"))
    expected = translate()
    (kept,) = (files / "cache").rglob("grammars/*")
    kept.write_bytes(b"no parser")
    assert translate() == expected
    monkeypatch.setenv("XDG_CACHE_HOME", str(files / "one.lp"))
    assert translate() == expected
