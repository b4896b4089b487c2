"""Durations of a test run: of each part, and of the longest tests."""

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Iterator, List, NamedTuple, Optional, Sequence, Tuple

from outcome import name_of


class Duration(NamedTuple):
    """When a command of a part began, its duration and its CPU time, all in seconds; pytest's report of it."""

    part: str
    name: str
    begin: float
    seconds: float
    computed: float
    tests: Optional[Path] = None


def summary(durations: Sequence[Duration], number: int = 10) -> List[str]:
    """Return lines with all parts, their time and CPU time, and the ``longest`` tests with their time."""
    lines = ["Durations:"]
    for part in dict.fromkeys(one.part for one in durations):
        ours = [one for one in durations if one.part == part]
        took = max(one.begin + one.seconds for one in ours) - min(one.begin for one in ours)
        lines.append(f"    {took:6.1f} s, {sum(one.computed for one in ours):6.1f} s of CPU: {part}")
    longest = sorted((test for one in durations for test in _tests(one)), reverse=True)[:number]
    return [*lines, "The longest:", *(f"    {seconds:6.1f} s: {name}" for seconds, name in longest)]


def _tests(duration: Duration) -> Iterator[Tuple[float, str]]:
    """Yield each test of pytest's report with its seconds; an unreadable report counts as one."""
    if not duration.tests or not duration.tests.exists():
        yield duration.seconds, duration.name
        return
    try:
        cases = ElementTree.parse(duration.tests).getroot().iter("testcase")
        yield from [(float(case.get("time", 0)), f"{name_of(case)} ({duration.part})") for case in cases]
    except ElementTree.ParseError:  # already reported as a failure
        yield duration.seconds, duration.name
