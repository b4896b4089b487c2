"""Counts and names of failures, from reports as pytest and rostest write them."""

from pathlib import Path

import pytest
from outcome import Outcome, count, judge
from processes import Finished

PYTEST = """<testsuites><testsuite name="pytest" errors="1" failures="2" skipped="1" tests="6">
<testcase classname="test.unit.test_a" name="test_good"/>
<testcase classname="test.unit.test_a" name="test_bad[1-2]"><failure message="x">y</failure></testcase>
<testcase classname="test.unit.deep.test_b.TestAll" name="test_worse"><failure message="x">y</failure></testcase>
<testcase classname="" name="test.unit.test_c"><error message="collection failure">y</error></testcase>
<testcase classname="test.unit.test_a" name="test_left"><skipped message="z"/></testcase>
<testcase classname="test.unit.test_a" name="test_fine"/>
</testsuite></testsuites>"""
ROSUNIT = """<testsuite name="core" tests="2" failures="0" errors="1">
<testcase classname="__main__.CoreTest" name="test_goal"><error type="">y</error></testcase>
<testcase classname="__main__.CoreTest" name="test_cancel"/></testsuite>"""
ROSTEST = """<testsuite name="rostest" tests="1" failures="1" errors="0">
<testcase classname="rostest.runner.RosTest" name="testcore"><failure>time-limit</failure></testcase></testsuite>"""


def reports(folder: Path, **texts: str):
    for name, text in texts.items():
        (folder / (name.replace("_", "-") + ".xml")).write_text(text)
    return sorted(folder.glob("*.xml"))


def test_outcome_names_failures_for_reruns_and_counts_rostests_once(tmp_path):
    outcome = count(reports(tmp_path, unit=PYTEST, rosunit_core=ROSUNIT, rostest_core=ROSTEST))
    assert sorted(outcome.failures) == [
        "CoreTest.test_goal",
        "rostest.runner.RosTest.testcore",
        "test/unit/deep/test_b.py::TestAll::test_worse",
        "test/unit/test_a.py::test_bad[1-2]",
        "test/unit/test_c.py",
    ]
    assert (outcome.passed, outcome.skipped) == (3, 1)


@pytest.mark.parametrize("text", ["<testsuite", '<testsuite name="some" tests="3" failures="1" errors="0"/>'])
def test_outcome_of_incomplete_report_has_a_failure(tmp_path, text):
    assert len(count(reports(tmp_path, unit=text)).failures) == 1


def test_outcome_bad_end_without_failed_test_is_failure():
    assert judge("unit", Finished(1, []), Outcome(2, ("test_x",))).failures == ("unit: test_x",)
    assert judge("a", Finished(0, []), Outcome(1)).failures == ()
    assert judge("a", Finished(7, []), Outcome(1)).failures == ("a: ended with exit code 7",)
    assert judge("a", Finished(None, []), Outcome(1)).failures == ("a: did not end in time",)
    assert judge("a", Finished(0, []), Outcome()).failures == ("a: ran no test",)
    left = judge("a", Finished(0, ["roscore", "core"]), Outcome(1)).failures
    assert left == ("a: left a process behind: roscore", "a: left a process behind: core")
