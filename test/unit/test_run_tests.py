"""The groups of ``./dev test``: files that exist, settings of pytest, and ends that are failures."""

import json

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
