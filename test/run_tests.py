#!/usr/bin/env python3
"""Runs what ``./dev test`` was asked for, on all cores, and closes with "N passed, N failed"."""

import argparse
import fnmatch
import os
import signal
import subprocess
import sys
import time
import uuid
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Dict, Iterator, List, NamedTuple, Optional, Sequence

ROOT = Path(__file__).resolve().parent.parent
PYTHON_FOLDERS = ("src", "scripts", "test", "bench", "doc", "setup.py")
MARK = "ROSOCLINGO_TEST_RUN"  # an environment variable: by it a test's processes are known
UNIT_LIMIT, INSTALL_LIMIT, LINT_LIMIT = 900.0, 300.0, 180.0  # seconds
CORES = min(os.cpu_count() or 1, 4)  # so many tests run at a time
ROSTEST_MARGIN = 60.0  # seconds for master and nodes to start and stop, besides the tests' own time limits

LINTERS: Dict[str, List[str]] = {
    "ruff check": ["ruff", "check", "--quiet", "--output-format=concise", "."],
    "ruff format": ["ruff", "format", "--quiet", "--check", "--diff", "."],
    "mypy": ["mypy"],
    "vermin": ["vermin", "--quiet", "--violations", "--no-tips", "--target=3.8-"],
    "catkin_lint": ["catkin_lint", "-W2", "--strict", "--offline", "--quiet"],  # with the folder of the package
    "shellcheck": ["shellcheck", "dev", ".ci/run"],
}


class Outcome(NamedTuple):
    """How many tests passed and failed."""

    passed: int
    failed: int
    skipped: int = 0

    def __add__(self, other: "Outcome") -> "Outcome":  # type: ignore[override]
        return Outcome(self.passed + other.passed, self.failed + other.failed, self.skipped + other.skipped)

    def __str__(self) -> str:
        skipped = f", {self.skipped} skipped" if self.skipped else ""
        return f"{self.passed} passed, {self.failed} failed{skipped}"


class Finished(NamedTuple):
    """A command that ended: its exit code (None if it had to be ended) and the processes it left behind."""

    code: Optional[int]
    leftovers: List[str]


def processes_with(mark: str) -> Iterator[int]:
    """The processes that were started with the mark in their environment."""
    needle = f"{MARK}={mark}".encode()
    for entry in Path("/proc").iterdir():
        if entry.name.isdigit() and int(entry.name) != os.getpid():
            try:
                if needle in (entry / "environ").read_bytes().split(b"\0"):
                    yield int(entry.name)
            except OSError:  # ended meanwhile, or another user's
                continue


def command_line(pid: int) -> str:
    """The command line of a process, empty for one that is a zombie or gone."""
    try:
        return Path(f"/proc/{pid}/cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace").strip()
    except OSError:
        return ""


def end_leftovers(mark: str, grace: float = 5.0) -> List[str]:
    """Ends what is still there of a run after a grace time, in seconds; returns the command lines."""
    deadline = time.monotonic() + grace
    while time.monotonic() < deadline and any(command_line(pid) for pid in processes_with(mark)):
        time.sleep(0.1)
    names = []
    for pid in processes_with(mark):
        if command_line(pid):
            names.append(command_line(pid))
            os.kill(pid, signal.SIGKILL)
    return names


def run(command: Sequence[str], log: Path, limit: float, **variables: str) -> Finished:
    """Runs a command with a time limit in seconds and its output in a log, and sees that nothing is left of it."""
    mark = uuid.uuid4().hex
    environment = {**os.environ, **variables, MARK: mark}
    with log.open("wb") as output:
        process = subprocess.Popen(
            command, cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT
        )
        try:
            code: Optional[int] = process.wait(limit)
        except subprocess.TimeoutExpired:
            code = None
            process.send_signal(signal.SIGINT)
            try:
                process.wait(20)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        finally:
            if process.poll() is None:
                process.kill()
            leftovers = end_leftovers(mark)
    return Finished(code, leftovers)


def count(reports: Sequence[Path]) -> Outcome:
    """Adds up JUnit reports; one that can't be read is a failure."""
    outcome = Outcome(0, 0)
    for report in reports:
        try:
            suites = list(ElementTree.parse(report).getroot().iter("testsuite"))
        except (ElementTree.ParseError, OSError):
            outcome += Outcome(0, 1)
            continue
        for suite in suites:
            total, bad = int(suite.get("tests", 0)), int(suite.get("failures", 0)) + int(suite.get("errors", 0))
            skipped = int(suite.get("skipped", suite.get("skip", 0)))
            # rostest's own report tells of each test node whether it ran, not of the tests in it
            passed = 0 if report.name.startswith("rostest-") else max(total - bad - skipped, 0)
            outcome += Outcome(passed, bad, skipped)
    return outcome


def judge(finished: Finished, counted: Outcome) -> Outcome:
    """A time-out, a bad exit code without a failed test, no test at all or a process left behind is a failure too."""
    unaccounted = finished.code != 0 and not counted.failed
    nothing = not counted.passed and not counted.failed and not unaccounted
    return counted + Outcome(0, int(unaccounted) + int(nothing) + int(bool(finished.leftovers)))


def report(name: str, outcome: Outcome, seconds: float, finished: Finished, log: Path) -> None:
    """One line for what went well, the log for what did not."""
    print(f"{'FAILED' if outcome.failed else 'ok':6} {name}: {outcome} ({seconds:.1f} s)", flush=True)
    if not outcome.failed:
        return
    print(log.read_text(errors="replace"))
    if finished.code is None:
        print("It did not end in time and was ended.")
    for line in finished.leftovers:
        print(f"It left a process behind, which was ended: {line}")
    print(f"The log is {log}", flush=True)


class Tests:
    """The groups of tests; results go to a work folder."""

    def __init__(self, work: Path) -> None:
        self.work = work
        self.results = work / "results" / uuid.uuid4().hex[:8]
        self.results.mkdir(parents=True)

    def _run(self, name: str, command: Sequence[str], limit: float, reports: Optional[Path], **env: str) -> Outcome:
        log = self.results / (name.replace(" ", "-").replace("/", "-") + ".log")
        begin = time.monotonic()
        finished = run(command, log, limit, **env)
        files = sorted(reports.rglob("*.xml")) if reports else []
        counted = count(files) if reports else Outcome(int(finished.code == 0), int(finished.code != 0))
        outcome = judge(finished, counted)
        report(name, outcome, time.monotonic() - begin, finished, log)
        return outcome

    def lint(self, _names: Sequence[str]) -> Outcome:
        """The static checks."""
        sources = [str(path) for folder in PYTHON_FOLDERS for path in _python_files(ROOT / folder)]
        outcome = Outcome(0, 0)
        arguments = {"vermin": sources, "catkin_lint": [str(self.work / "ws" / "src" / "rosoclingo")]}
        for name, command in LINTERS.items():
            outcome += self._run(name, command + arguments.get(name, []), LINT_LIMIT, None)
        return outcome

    def unit(self, arguments: Sequence[str]) -> Outcome:
        """The tests of the pure packages."""
        reports = self.results / "unit"
        command = [sys.executable, "-m", "pytest", "-q", f"--junitxml={reports}/unit.xml"]
        command += arguments or [f"--numprocesses={CORES}", "--dist=worksteal"]
        return self._run("unit", command, UNIT_LIMIT, reports)

    def rostest(self, names: Sequence[str]) -> Outcome:
        """The tests of the nodes, each file with a master of its own."""
        paths = _chosen(sorted((ROOT / "test" / "rostest").glob("*.test")), names)
        with ThreadPoolExecutor(CORES) as pool:
            return sum(pool.map(self._rostest, paths), Outcome(0, 0))

    def _rostest(self, path: Path) -> Outcome:
        reports = self.results / path.stem
        limit = ROSTEST_MARGIN + sum(_time_limits(path))
        command = ["rostest", "--pkgdir", str(ROOT), "--package", "rosoclingo"]
        command += ["--results-filename", path.stem + ".xml", "--results-base-dir", str(reports), str(path)]
        return self._run(f"rostest {path.stem}", command, limit, reports)

    def install(self, _names: Sequence[str]) -> Outcome:
        """The install space, on its own."""
        command = [str(ROOT / "dev"), "exec-install", str(ROOT / "test" / "install_space.py")]
        return self._run("install", command, INSTALL_LIMIT, None)


def _python_files(path: Path) -> Iterator[Path]:
    if path.is_file():
        yield path
    elif path.is_dir():
        for file in sorted(path.rglob("*")):
            if file.is_file() and (file.suffix == ".py" or _has_python_shebang(file)):
                yield file


def _has_python_shebang(path: Path) -> bool:
    with path.open("rb") as file:
        return not path.suffix and file.readline(80).rstrip().endswith(b"python3")


def _chosen(paths: Sequence[Path], patterns: Sequence[str]) -> List[Path]:
    unknown = [pattern for pattern in patterns if not any(fnmatch.fnmatch(path.stem, pattern) for path in paths)]
    if unknown:
        sys.exit(f"no such rostest: {', '.join(unknown)}; there are: {', '.join(path.stem for path in paths)}")
    return [path for path in paths if not patterns or any(fnmatch.fnmatch(path.stem, name) for name in patterns)]


def _time_limits(path: Path) -> List[float]:
    """The time limits of a rostest file's tests, in seconds; rostest's own default is a minute."""
    return [float(test.get("time-limit", 60)) for test in ElementTree.parse(path).getroot().iter("test")]


def main() -> int:
    """Runs the groups that the command line names, or all of them."""
    groups = ("lint", "unit", "rostest", "install")
    parser = argparse.ArgumentParser(prog="./dev test")
    parser.add_argument("--work", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("group", nargs="?", choices=groups, help="the group to run, all without one")
    parser.add_argument("names", nargs=argparse.REMAINDER, help="rostests, or arguments for pytest")
    arguments = parser.parse_args()
    # a shell that runs this in the background has it ignored, and every process of the tests would do so too
    signal.signal(signal.SIGINT, signal.default_int_handler)
    tests, begin = Tests(arguments.work), time.monotonic()
    outcome = Outcome(0, 0)
    for group in [arguments.group] if arguments.group else groups:
        outcome += getattr(tests, group)(arguments.names)
    print(f"took {time.monotonic() - begin:.0f} s, logs and reports in {tests.results}")
    print(outcome, flush=True)
    return 1 if outcome.failed or not outcome.passed else 0


if __name__ == "__main__":
    sys.exit(main())
