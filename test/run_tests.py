#!/usr/bin/env python3
"""Runs the groups that ``./dev test`` names, on all cores, and ends with all failures and "N passed, N failed"."""

import argparse
import fnmatch
import itertools
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
import uuid
import xml.etree.ElementTree as ElementTree
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Dict, Iterable, Iterator, List, Mapping, Optional, Sequence

import yaml
from durations import Duration, summary
from outcome import Outcome, count, judge, report
from processes import ROOT, check_interrupt, end_on_interrupt, run

UNIT_LIMIT, INSTALL_LIMIT, LINT_LIMIT = 3600.0, 1800.0, 900.0  # seconds, for a slow or busy machine
CORES = min(os.cpu_count() or 1, 4)  # concurrent unit tests
ROSTEST_MARGIN = 300.0  # seconds in which master and nodes start and stop, in addition to the tests' own time limits

HOOKS = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())["repos"][0]["hooks"]
LINTERS: Dict[str, List[str]] = {one["name"]: shlex.split(one["entry"])[2:] for one in HOOKS}  # without "./dev exec"
GROUPS = ("lint", "unit", "rostest", "python38", "install", "pip")  # and "quick"
SLOW_LINTERS = ("mypy", "vermin")
ROSTESTS = sorted((ROOT / "test" / "rostest").rglob("*.test"), key=lambda path: path.stem)
# also on Python 3.8: the core and the interfaces with all their imports, and tests without compiled ROS modules
ON_BOTH = ("configured_interfaces", "core_words")
# These compute little: two of them run next to one of the others for every two cores. More at a time take longer than
# one after the other, since simulated time, and its cost, goes on meanwhile.
WAITING = (
    "configured_interfaces",
    "core_defence",
    "core_interrupted",
    "core_killed",
    "core_launch",
    "core_start",
    "exactly_once",
    "hosts",
    "mailbot_killed",
    "master_restarted",
    "office",
    "operated_pages",
    "recorder",
    "request_lost",
    "scenario_player",
    "scenarios_office",
    "shipped_interfaces",
    "simulated_time_interfaces",
    "time_jump",
    "tutorial",
    "web_page",
)
QUICK_ROSTESTS = ("core_start", "shipped_interfaces")
IN_PARALLEL = (f"--numprocesses={CORES}", "--dist=worksteal")
# Most of these tests take milliseconds: collecting them in further processes, and rewriting assertions, takes longer.
ONE_PROCESS = ("--numprocesses=0", "--assert=plain")
NOT_SLOW = ("-m", "not slow")
GIVING_WAY = ("nice", "-n", "5")  # rostests have time limits; weighs a third of them on a busy machine
PYTEST_REPORT = "unit.xml"
MODULES = ("test", "test/unit", "bench")  # folders of modules that tests import, as in pyproject.toml
ON_PYTHON38 = " on Python 3.8"
NO_PYTHON38 = 3  # the exit code of ./dev exec-python38 without a Python 3.8


class Tests:
    """The groups of tests; results go to a work folder."""

    def __init__(self, work: Path) -> None:
        self.work = work
        self.results = work / "results" / uuid.uuid4().hex[:8]
        self.results.mkdir(parents=True)
        self.durations: List[Duration] = []
        self.addresses = loopback_addresses(os.getpid())

    def lint(self, _names: Sequence[str]) -> Outcome:
        """Run the static checks."""
        return self._lint(LINTERS)

    def unit(self, arguments: Sequence[str]) -> Outcome:
        """Run the tests of the pure packages."""
        return self._unit("", os.environ, arguments or IN_PARALLEL)

    def rostest(self, names: Sequence[str]) -> Outcome:
        """Run the tests of the nodes, each file with its own master."""
        return self._rostests(_chosen(ROSTESTS, names), "", os.environ)

    def install(self, _names: Sequence[str]) -> Outcome:
        """Check the install space."""
        command = [*GIVING_WAY, str(ROOT / "dev"), "exec-install", str(ROOT / "test" / "install_space.py")]
        return self._run("install", "install", command, INSTALL_LIMIT, os.environ)

    def pip(self, _names: Sequence[str]) -> Outcome:
        """Check the pip installation without ROS."""
        return self._pip(_python38_environment())

    def quick(self, _names: Sequence[str]) -> Outcome:
        """Run the tests that find most faults in little time: no slow linter, no slow test, two rostests."""
        outcome = self._lint([name for name in LINTERS if name not in SLOW_LINTERS])
        with Lanes() as lanes:
            rostests = self._begin(lanes, _chosen(ROSTESTS, QUICK_ROSTESTS), "", os.environ)
            outcome += self._unit("", os.environ, [*IN_PARALLEL, *NOT_SLOW])
            return outcome + sum((one.result() for one in rostests), Outcome())

    def whole(self) -> Outcome:
        """Run all groups: next to the rostests, which have time limits, one low-priority group at a time.

        More at a time would take longer. The unit tests, which can use all cores up to the end, come last.
        """
        outcome = self.lint(())
        with Lanes() as lanes, ThreadPoolExecutor(1) as pool:
            others = self._begin(lanes, ROSTESTS, "", os.environ)
            others.append(pool.submit(self.install, ()))
            python38 = _python38_environment()
            others += self._begin(lanes, _chosen(ROSTESTS, ON_BOTH) if python38 else (), ON_PYTHON38, python38)
            others.append(pool.submit(self._pip, python38))
            others.append(pool.submit(self._unit_again, python38))
            others.append(pool.submit(self.unit, ()))
            return outcome + sum((one.result() for one in others), Outcome())

    def python38(self, _names: Sequence[str]) -> Outcome:
        """Run on Python 3.8, if there is one: the unit tests, and the rostests without compiled modules."""
        environment = _python38_environment()
        rostests = _chosen(ROSTESTS, ON_BOTH) if environment else ()
        return self._unit_again(environment) + self._rostests(rostests, ON_PYTHON38, environment)

    def _pip(self, python38: Mapping[str, str]) -> Outcome:
        pythons = [sys.executable, *filter(None, [python38 and shutil.which("python3", path=python38["PATH"])])]
        command = [*GIVING_WAY, sys.executable, str(ROOT / "test" / "without_ros.py"), *pythons]
        return self._run("pip", "pip", command, INSTALL_LIMIT, os.environ)

    def _unit_again(self, environment: Mapping[str, str]) -> Outcome:
        if not environment:
            print("none   python38: see the message above", flush=True)
            return Outcome()
        print("(on Python 3.8 the first test of each file that is neither slow nor marked once)", flush=True)
        # the folder is named because an older pytest does not look for options in testpaths
        return self._unit(ON_PYTHON38, environment, [*ONE_PROCESS, "--first-of-files", str(ROOT / "test" / "unit")])

    def _lint(self, names: Iterable[str]) -> Outcome:
        return sum((self._run("lint", name, LINTERS[name], LINT_LIMIT, os.environ) for name in names), Outcome())

    def _unit(self, suffix: str, environment: Mapping[str, str], arguments: Sequence[str]) -> Outcome:
        name = "unit" + suffix
        reports = self.results / _file_name(name)
        # the same path to the sources as in the build, so that compiled code is reused
        sources = self.work / ("python38" if suffix else "") / "ws" / "src" / "rosoclingo" / "src"
        command = [*GIVING_WAY, "python3", "-m", "pytest", "-q", f"--junitxml={reports / PYTEST_REPORT}"]
        folders = [sources, *(ROOT / one for one in MODULES)]  # pytest splits the option as a shell does
        command += ["-o", "pythonpath=" + " ".join(shlex.quote(str(one)) for one in folders), *arguments]
        return self._run(name, name, command, UNIT_LIMIT, environment, reports)

    def _rostests(self, paths: Sequence[Path], suffix: str, environment: Mapping[str, str]) -> Outcome:
        with Lanes() as lanes:
            return sum((one.result() for one in self._begin(lanes, paths, suffix, environment)), Outcome())

    def _begin(
        self, lanes: "Lanes", paths: Sequence[Path], suffix: str, environment: Mapping[str, str]
    ) -> "List[Future[Outcome]]":
        """Run the rostests in their lanes; the longest first, so that none runs alone at the end."""
        longest_first = sorted(paths, key=lambda path: sum(_time_limits(path)), reverse=True)
        return [lanes.of(path).submit(self._rostest, path, suffix, environment) for path in longest_first]

    def _rostest(self, path: Path, suffix: str, environment: Mapping[str, str]) -> Outcome:
        name = f"rostest {path.stem}{suffix}"
        reports = self.results / _file_name(name)
        limit = ROSTEST_MARGIN + sum(_time_limits(path))
        command = ["rostest", "--pkgdir", str(ROOT), "--package", "rosoclingo"]
        command += ["--results-filename", path.stem + ".xml", "--results-base-dir", str(reports), str(path)]
        own = {**environment, "ROS_HOSTNAME": next(self.addresses)}
        return self._run("rostest" + suffix, name, command, limit, own, reports)

    def _run(
        self,
        part: str,
        name: str,
        command: Sequence[str],
        limit: float,
        environment: Mapping[str, str],
        reports: Optional[Path] = None,
    ) -> Outcome:
        log = self.results / (_file_name(name) + ".log")
        begin = time.monotonic()
        finished = run(command, log, limit, environment)
        counted = count(sorted(reports.rglob("*.xml"))) if reports else Outcome(passed=int(finished.code == 0))
        outcome = judge(name, finished, counted)
        seconds = time.monotonic() - begin
        self.durations.append(
            Duration(part, name, begin, seconds, finished.computed, reports and reports / PYTEST_REPORT)
        )
        report(name, outcome, seconds, finished.computed, log)
        return outcome


def loopback_addresses(seed: int) -> Iterator[str]:
    """Yield distinct loopback addresses of this machine, on each of which ROS's nodes can listen alone.

    Each rostest has one, so that a node of another test that gets the port of a dead one is not mistaken for it.
    """
    second, third = 1 + seed // 256 % 254, seed % 256
    return (f"127.{second}.{(third + number // 254) % 256}.{1 + number % 254}" for number in itertools.count())


class Lanes:
    """Lanes of concurrent rostests: one that computes for two cores, which its nodes use fully, and two that wait."""

    def __init__(self) -> None:
        self._computing, self._waiting = ThreadPoolExecutor(max(1, CORES // 2)), ThreadPoolExecutor(2)

    def of(self, path: Path) -> ThreadPoolExecutor:
        """Return the lane for a rostest."""
        return self._waiting if path.stem in WAITING else self._computing

    def __enter__(self) -> "Lanes":
        return self

    def __exit__(self, *_: object) -> None:
        self._computing.shutdown()
        self._waiting.shutdown()


def _python38_environment() -> Dict[str, str]:
    """Return the environment of the workspace for Python 3.8; empty without one, which ``dev`` reports."""
    command = [str(ROOT / "dev"), "exec-python38", "env", "-0"]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    check_interrupt()
    if done.returncode == NO_PYTHON38:
        return {}
    done.check_returncode()
    return dict(line.split("=", 1) for line in done.stdout.split("\0") if line)


def _file_name(name: str) -> str:
    return re.sub(r"[^\w.]+", "-", name)


def _chosen(paths: Sequence[Path], patterns: Sequence[str]) -> List[Path]:
    unknown = [pattern for pattern in patterns if not any(fnmatch.fnmatch(path.stem, pattern) for path in paths)]
    if unknown:
        sys.exit(f"no such rostest: {', '.join(unknown)}; there are: {', '.join(path.stem for path in paths)}")
    return [path for path in paths if not patterns or any(fnmatch.fnmatch(path.stem, name) for name in patterns)]


def _time_limits(path: Path) -> List[float]:
    """Return the time limits of a rostest file's tests, in seconds; rostest's own default is a minute."""
    return [float(test.get("time-limit", 60)) for test in ElementTree.parse(path).getroot().iter("test")]


def main() -> int:
    """Run the groups that the command line names, or all of them."""
    parser = argparse.ArgumentParser(prog="./dev test")
    parser.add_argument("--work", type=Path, required=True, help=argparse.SUPPRESS)
    parser.add_argument("group", nargs="?", choices=(*GROUPS, "quick"), help="the group to run, all without one")
    parser.add_argument("names", nargs=argparse.REMAINDER, help="rostests, or arguments for pytest")
    arguments = parser.parse_args()
    end_on_interrupt()
    tests, begin = Tests(arguments.work), time.monotonic()
    try:
        outcome = getattr(tests, arguments.group)(arguments.names) if arguments.group else tests.whole()
    except KeyboardInterrupt:
        print(f"interrupted, logs and reports in {tests.results}", flush=True)
        return 130
    if outcome.failures:
        print("Failures:", *outcome.failures, sep="\n    ")
    print(*summary(tests.durations), sep="\n")
    print(f"took {time.monotonic() - begin:.0f} s, logs and reports in {tests.results}")
    print(outcome, flush=True)
    return 1 if outcome.failures or not outcome.passed else 0


if __name__ == "__main__":
    sys.exit(main())
