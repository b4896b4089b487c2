"""Durations of a run: by part, the longest first, and the CPU time of commands with all their children."""

import os
import sys

import pytest
from durations import Duration, summary
from processes import run

REPORT = """<testsuites><testsuite name="pytest" tests="2">
<testcase classname="test.unit.test_a" name="test_slow[1]" time="7.5"/>
<testcase classname="test.unit.test_a" name="test_fast" time="0.1"/>
</testsuite></testsuites>"""
BUSY = "import time\nwhile time.process_time() < 0.6: pass"


def test_durations_list_parts_in_order_and_longest_tests(tmp_path):
    report = tmp_path / "unit.xml"
    report.write_text(REPORT)
    durations = [
        Duration("unit", "unit", 100.0, 9.0, 16.0, report),
        Duration("rostest", "rostest core", 109.0, 6.0, 2.0, tmp_path / "none.xml"),
        Duration("rostest", "rostest crowd", 110.0, 8.0, 3.5),
    ]
    assert summary(durations, 3) == [
        "Durations:",
        "       9.0 s,   16.0 s of CPU: unit",
        "       9.0 s,    5.5 s of CPU: rostest",
        "The longest:",
        "       8.0 s: rostest crowd",
        "       7.5 s: test/unit/test_a.py::test_slow[1] (unit)",
        "       6.0 s: rostest core",
    ]


def test_durations_truncated_report_counts_as_one_test(tmp_path):
    (tmp_path / "unit.xml").write_text(REPORT[:100])
    assert summary([Duration("unit", "unit", 0.0, 9.0, 1.0, tmp_path / "unit.xml")])[-1] == "       9.0 s: unit"


@pytest.mark.slow
def test_durations_cpu_time_includes_all_children(tmp_path):
    code = f"import subprocess, sys\nsubprocess.run([sys.executable, '-c', {BUSY!r}])"
    finished = run([sys.executable, "-c", code], tmp_path / "log", 60.0, os.environ)
    assert finished.code == 0, (tmp_path / "log").read_text()
    assert finished.computed >= 0.5  # counted in ticks


def test_durations_end_command_after_its_limit(tmp_path):
    finished = run([sys.executable, "-c", "import time; time.sleep(600)"], tmp_path / "log", 0.1, os.environ)
    assert finished == (None, [], 0.0)
