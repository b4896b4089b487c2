"""The groups that ``./dev test`` runs: all of them, in parallel up to the number of cores."""

import json
import threading

import pytest
import run_tests
from outcome import Outcome

HERE, AGAIN = "unit", "unit on Python 3.8"
FIRST, BURST = "rostest core", "rostest fleet"
ON_BOTH = ("rostest core_words on Python 3.8", AGAIN)


class RecordedTests(run_tests.Tests):
    """Records the commands and their concurrency instead of running them; commands in ``bad`` fail."""

    def __init__(self, bad):
        self.bad, self.done, self.at_work = bad, [], set()
        self.addresses = run_tests.loopback_addresses(1)
        self.most = {"computing": 0, "waiting": 0}
        self.lock = threading.Lock()
        self.concurrent = {name: threading.Barrier(2) for name in (FIRST, BURST)}

    def note(self, name, meeting=None):
        """Record a command; ``meeting`` is the one of ``concurrent`` that has to run at the same time."""
        with self.lock:
            self.at_work.add(name)
            for lane in self.most:
                self.most[lane] = max(self.most[lane], sum(self.lane(other) == lane for other in self.at_work))
        if meeting:
            self.concurrent[meeting].wait(60.0)
        with self.lock:
            self.at_work.remove(name)
            self.done.append(name)
        return Outcome(1, (name,) if name in self.bad else ())

    @staticmethod
    def lane(name):
        """Return the lane of a command."""
        kind, _, rest = name.partition(" ")
        if kind != "rostest":
            return "concurrent"
        return "waiting" if rest.partition(" ")[0] in run_tests.WAITING else "computing"

    def _run(self, _part, name, command, limit, environment, reports=None):
        return self.note(name, {"install": BURST, FIRST: FIRST, BURST: BURST, HERE: FIRST}.get(name))


@pytest.fixture
def whole(monkeypatch, tmp_path):
    """Return a run of all groups, with a Python 3.8 or without."""

    def run(bad=(), found=True):
        notes = RecordedTests(bad)
        notes.work = notes.results = tmp_path

        def environment():
            notes.note("set-up")
            return {"PATH": "there"} if found else {}

        monkeypatch.setattr(run_tests, "_python38_environment", environment)
        return notes, notes.whole()

    return run


def test_run_tests_runs_all_groups(whole):
    notes, outcome = whole()
    names = [path.stem for path in run_tests.ROSTESTS]
    every = [*run_tests.LINTERS, HERE, "set-up", AGAIN, "install", "pip", *(f"rostest {name}" for name in names)]
    every += [f"rostest {name} on Python 3.8" for name in run_tests.ON_BOTH]
    assert sorted(notes.done) == sorted(every)
    assert notes.done[: len(run_tests.LINTERS)] == list(run_tests.LINTERS)
    assert all(notes.done.index("set-up") < notes.done.index(name) for name in ON_BOTH)
    assert notes.most["computing"] <= run_tests.CORES
    assert notes.most["waiting"] <= 2
    assert (outcome.passed, outcome.failures) == (len(every) - 1, ())


@pytest.mark.parametrize("bad", ["mypy", HERE, BURST, ON_BOTH[1], "install"])
def test_run_tests_reports_failures_and_continues(whole, bad):
    notes, outcome = whole(bad=[bad])
    assert outcome.failures == (bad,)
    assert notes.done.count("install") == 1


def test_run_tests_without_python38_runs_the_rest(whole, capsys):
    notes, outcome = whole(found=False)
    assert "none   python38" in capsys.readouterr().out
    assert set(ON_BOTH).isdisjoint(notes.done)
    assert outcome.passed == len(run_tests.LINTERS) + len(run_tests.ROSTESTS) + 3


def test_run_tests_names_only_existing_files():
    named = {*run_tests.WAITING, *run_tests.ON_BOTH, *run_tests.QUICK_ROSTESTS}
    assert named <= {path.stem for path in run_tests.ROSTESTS}


def test_run_tests_imports_modules_as_pytest_alone_does():
    settings = (run_tests.ROOT / "pyproject.toml").read_text()
    assert f"pythonpath = {json.dumps(['src', *run_tests.MODULES])}\n" in settings
