"""What ``./dev test`` runs: every group, and beside each other only what uses different workspaces."""

import threading

import pytest
import run_tests
from outcome import Outcome

HERE, AGAIN, ROSTESTS_AGAIN = "unit", "unit on Python 3.8", "rostests on Python 3.8"


class Notes(run_tests.Tests):
    """Notes what is run and what of it is at work at the same time, and runs nothing; what is in ``bad`` fails."""

    def __init__(self, bad):
        self.bad, self.done, self.at_work, self.met = bad, [], set(), set()
        self.lock = threading.Lock()
        self.beside = {name: threading.Barrier(2) for name in ("set-up", "install", AGAIN)}

    def note(self, name, *meeting):
        """``meeting`` are those of ``beside`` that have to be at work now."""
        with self.lock:
            self.met |= {frozenset((name, other)) for other in self.at_work}
            self.at_work.add(name)
        for other in meeting:
            self.beside[other].wait(60.0)
        with self.lock:
            self.at_work.remove(name)
            self.done.append(name)
        return Outcome(1, (name,) if name in self.bad else ())

    def _run(self, _part, name, command, limit, environment, reports=None):
        return self.note(name, *(["install"] if name == "install" else []))

    def _unit(self, suffix, environment, arguments):
        return self.note("unit" + suffix, *([AGAIN] if suffix else []))

    def _rostests(self, paths, suffix, environment):
        self.rostests = {*getattr(self, "rostests", ()), *(path.stem + suffix for path in paths)}
        return self.note(f"rostests{suffix}", *([AGAIN] if suffix else ["set-up", "install"]))


@pytest.fixture
def whole(monkeypatch):
    """Runs all, with a Python 3.8 or without."""

    def run(bad=(), found=True):
        notes = Notes(bad)
        notes.work = run_tests.ROOT

        def environment():
            notes.note("set-up", "set-up")
            return {"PATH": "there"} if found else {}

        monkeypatch.setattr(run_tests, "_python38_environment", environment)
        monkeypatch.setattr(run_tests, "rostests_within", lambda environment, paths: paths)
        return notes, notes.whole()

    return run


def test_all_groups_are_run(whole):
    notes, outcome = whole()
    every = [*run_tests.LINTERS, HERE, "rostests", "set-up", AGAIN, ROSTESTS_AGAIN, "install", "pip"]
    assert sorted(notes.done) == sorted(every)
    assert {path.stem for path in run_tests.ROSTESTS} <= notes.rostests
    assert not {f"{name} on Python 3.8" for name in run_tests.ONCE} & notes.rostests
    beside = {frozenset((one, "rostests")) for one in ("set-up", "install")}
    beside.add(frozenset((AGAIN, ROSTESTS_AGAIN)))
    may_be = {frozenset((one, two)) for one in ("install", "pip", AGAIN) for two in ("rostests", ROSTESTS_AGAIN)}
    assert beside <= notes.met <= beside | may_be
    assert (outcome.passed, outcome.failures) == (len(every) - 1, ())


@pytest.mark.parametrize("bad", ["mypy", HERE, "rostests", AGAIN, ROSTESTS_AGAIN, "install", "pip"])
def test_each_failure_is_told_and_the_others_are_run(whole, bad):
    notes, outcome = whole(bad=[bad])
    assert outcome.failures == (bad,)
    assert notes.done.count("install") == 1


def test_without_python38_the_rest_is_run(whole, capsys):
    notes, outcome = whole(found=False)
    assert "none   python38" in capsys.readouterr().out
    assert {AGAIN, ROSTESTS_AGAIN}.isdisjoint(notes.done)
    assert outcome.passed == len(run_tests.LINTERS) + 4


def test_what_is_named_is_there():
    named = {*run_tests.WAITING, *run_tests.ONCE, *run_tests.QUICK_ROSTESTS}
    assert named <= {path.stem for path in run_tests.ROSTESTS}
