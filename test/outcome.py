"""Results of tests: the number that passed, and the names of those that failed."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple, Sequence, Tuple

from processes import Finished


class Outcome(NamedTuple):
    """The number of passed and skipped tests, and the failures, each by a name that locates it."""

    passed: int = 0
    failures: Tuple[str, ...] = ()
    skipped: int = 0

    def __add__(self, other: "Outcome") -> "Outcome":  # type: ignore[override]
        return Outcome(self.passed + other.passed, self.failures + other.failures, self.skipped + other.skipped)

    def __str__(self) -> str:
        skipped = f", {self.skipped} skipped" if self.skipped else ""
        return f"{self.passed} passed, {len(self.failures)} failed{skipped}"


def count(reports: Sequence[Path]) -> Outcome:
    """Add up JUnit reports; an unreadable one is a failure."""
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
    """Count one suite; rostest's own report lists test nodes rather than the tests in them."""
    total, skipped = int(suite.get("tests", 0)), int(suite.get("skipped", suite.get("skip", 0)))
    bad = int(suite.get("failures", 0)) + int(suite.get("errors", 0))
    names = [name_of(case) for case in suite.iter("testcase") for kind in ("failure", "error") for _ in case.iter(kind)]
    names = names[:bad] + [f"{suite.get('name', 'a suite')}: a failure without a name"] * (bad - len(names))
    return Outcome(0 if of_nodes else max(total - bad - skipped, 0), tuple(names), skipped)


def name_of(case: ElementTree.Element) -> str:
    """Return a test's name as pytest accepts it, test/unit/test_x.py::test_y; for rostests, as unittest writes it."""
    name = ".".join(part for part in (case.get("classname"), case.get("name")) if part)
    if not name.startswith("test."):
        return name[len("__main__.") :] if name.startswith("__main__.") else name
    path, bracket, parameters = name.partition("[")
    parts = path.split(".")
    length = next((i + 1 for i, part in enumerate(parts) if part.startswith("test_")), len(parts))
    return "::".join(["/".join(parts[:length]) + ".py", *parts[length:]]) + bracket + parameters


def judge(name: str, finished: Finished, counted: Outcome) -> Outcome:
    """Judge a command: a time-out, a bad exit code, no test at all, or a leftover process is a failure too."""
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
    """Return one line for a success; for a failure the log, followed by its failures."""
    took = f"{seconds:.1f} s, {computed:.1f} s of CPU"
    print(f"{'FAILED' if outcome.failures else 'ok':6} {name}: {outcome} ({took})", flush=True)
    if outcome.failures:
        print(log.read_text(errors="replace"))
        print(f"The log is {log}. FAILED {name}:", *outcome.failures, sep="\n    ", flush=True)
