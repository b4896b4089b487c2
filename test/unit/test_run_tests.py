"""The groups of ``./dev test``: files that exist, settings of pytest, and ends that are failures."""

import json
import subprocess
import sys

import pytest
import run_tests
from outcome import Outcome, judge
from processes import Finished


def test_run_tests_names_only_existing_files():
    named = {*run_tests.WAITING, *run_tests.ON_BOTH, *run_tests.QUICK_ROSTESTS}
    assert named <= {path.stem for path in run_tests.ROSTESTS}


def test_run_tests_imports_modules_as_pytest_alone_does():
    settings = (run_tests.ROOT / "pyproject.toml").read_text()
    assert f"pythonpath = {json.dumps(['src', *run_tests.MODULES])}\n" in settings


@pytest.mark.parametrize(
    ("finished", "counted", "failures"),
    [
        (Finished(0, []), Outcome(1), ()),
        (Finished(1, []), Outcome(2, ("test_x",)), ("a: test_x",)),
        (Finished(7, []), Outcome(1), ("a: ended with exit code 7",)),
        (Finished(None, []), Outcome(1), ("a: did not end in time",)),
        (Finished(0, []), Outcome(), ("a: ran no test",)),
        (Finished(0, ["roscore"]), Outcome(1), ("a: left a process behind: roscore",)),
    ],
)
def test_run_tests_counts_each_bad_end_as_a_failure(finished, counted, failures):
    assert judge("a", finished, counted).failures == failures


INTERRUPT = """
import os, pathlib, signal, sys, time
from concurrent.futures import ThreadPoolExecutor
from processes import end_on_interrupt, run

end_on_interrupt()
log = pathlib.Path(sys.argv[1])
with ThreadPoolExecutor(1) as pool:
    running, queued = (pool.submit(run, ["sh", "-c", "echo begun; exec sleep 900"], log, 900, {}) for _ in range(2))
    while not log.exists() or not log.read_text():
        time.sleep(0.01)
    os.kill(os.getpid(), signal.SIGINT)
    print(repr(running.exception()), repr(queued.exception()))
"""


@pytest.mark.slow
def test_run_tests_interrupt_ends_running_and_queued_commands(tmp_path):
    folder = str(run_tests.ROOT / "test")
    command = [sys.executable, "-c", INTERRUPT, str(tmp_path / "log")]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300)
    assert done.stdout.split() == ["KeyboardInterrupt()"] * 2, done.stderr
