"""What came out of tests: how many passed, and the names of those that failed."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple, Sequence, Tuple

from processes import Finished


class Outcome(NamedTuple):
    """How many tests passed and were skipped, and what failed, each by a name that tells where to look."""

    passed: int = 0
    failures: Tuple[str, ...] = ()
    skipped: int = 0

    def __add__(self, other: "Outcome") -> "Outcome":  # type: ignore[override]
        return Outcome(self.passed + other.passed, self.failures + other.failures, self.skipped + other.skipped)

    def __str__(self) -> str:
        skipped = f", {self.skipped} skipped" if self.skipped else ""
        return f"{self.passed} passed, {len(self.failures)} failed{skipped}"


def count(reports: Sequence[Path]) -> Outcome:
    """Adds up JUnit reports; one that can't be read is a failure."""
    outcome = Outcome()
    for report in reports:
        try:
            suites = list(ElementTree.parse(report).getroot().iter("testsuite"))
        except (ElementTree.ParseError, OSError) as error:
            outcome += Outcome(failures=(f"the report {report} cannot be read: {error}",))
            continue
        for suite in suites:
            outcome += _of_suite(suite, of_nodes=report.name.startswith("rostest-"))
    return outcome


def _of_suite(suite: ElementTree.Element, of_nodes: bool) -> Outcome:
    """One suite; rostest's own report tells of each test node whether it ran, not of the tests in it."""
    total, skipped = int(suite.get("tests", 0)), int(suite.get("skipped", suite.get("skip", 0)))
    bad = int(suite.get("failures", 0)) + int(suite.get("errors", 0))
    names = [name_of(case) for case in suite.iter("testcase") for kind in ("failure", "error") for _ in case.iter(kind)]
    names = names[:bad] + [f"{suite.get('name', 'a suite')}: a failure without a name"] * (bad - len(names))
    return Outcome(0 if of_nodes else max(total - bad - skipped, 0), tuple(names), skipped)


def name_of(case: ElementTree.Element) -> str:
    """The name of a test as pytest takes it, test/unit/test_x.py::test_y; that of a rostest as unittest writes it."""
    name = ".".join(part for part in (case.get("classname"), case.get("name")) if part)
    if not name.startswith("test."):
        return name[len("__main__.") :] if name.startswith("__main__.") else name
    path, bracket, parameters = name.partition("[")
    parts = path.split(".")
    length = next((i + 1 for i, part in enumerate(parts) if part.startswith("test_")), len(parts))
    return "::".join(["/".join(parts[:length]) + ".py", *parts[length:]]) + bracket + parameters


def judge(name: str, finished: Finished, counted: Outcome) -> Outcome:
    """A time-out, a bad exit code without a failed test, no test at all or a process left behind is a failure too."""
    more = [f"left a process behind: {line}" for line in finished.leftovers]
    if finished.code is None:
        more.append("did not end in time")
    elif finished.code and not counted.failures:
        more.append(f"ended with exit code {finished.code}")
    elif not counted.passed and not counted.failures:
        more.append("ran no test")
    failures = tuple(f"{name}: {what}" for what in (*counted.failures, *more))
    return counted._replace(failures=failures)


def report(name: str, outcome: Outcome, seconds: float, computed: float, log: Path) -> None:
    """One line for what went well; for what did not the log, and its failures after it."""
    took = f"{seconds:.1f} s, {computed:.1f} s of CPU"
    print(f"{'FAILED' if outcome.failures else 'ok':6} {name}: {outcome} ({took})", flush=True)
    if outcome.failures:
        print(log.read_text(errors="replace"))
        print(f"The log is {log}. FAILED {name}:", *outcome.failures, sep="\n    ", flush=True)
