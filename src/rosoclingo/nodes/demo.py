"""The demonstration: starts a whole system with its own master, plays a scenario, and shuts the system down."""

import os
import signal
import socket
import subprocess
import time
from contextlib import suppress
from datetime import datetime
from pathlib import Path
from typing import Callable, Dict, List, Optional

import rosgraph
import rospy

from rosoclingo.common.xmlrpc_api import address_of
from rosoclingo.nodes.pages.report_command import write_report
from rosoclingo.nodes.recording.bag_file import BagError, repair, unfinished_path
from rosoclingo.nodes.recording.recorder import RECORDED, is_recording
from rosoclingo.nodes.scenarios.playing import ScenarioOutcome, run_scenario
from rosoclingo.runs.recorded_run import RecordingError
from rosoclingo.runs.scenario import Scenario

#: Limits in seconds of wall time for the start, which compiles the first time (minutes on a busy machine), and for the
#: shutdown: roslaunch gives its nodes 15 s before it kills them.
START_TIME = 300.0
END_TIME = 25.0


class DemoError(RuntimeError):
    """The system cannot be started; the text has the reason and the place of the log."""


class DemoSystem:
    """A launch file of this package in its own process group, with files in ``folder``; a context manager."""

    def __init__(self, launch: str, folder: Path, arguments: List[str]) -> None:
        self.bag = folder / "run.bag"
        self.log = folder / "roslaunch.log"
        self._launch = launch + ".launch"
        self._folder = folder
        self._arguments = ["record:=true", f"bag:={self.bag}", *arguments]
        self._process: Optional[subprocess.Popen[bytes]] = None

    def __enter__(self) -> "DemoSystem":
        self._folder.mkdir(parents=True)
        port = _free_port()
        os.environ.update(_environment(port, self._folder))
        command = ["roslaunch", "-p", str(port), "rosoclingo", self._launch, *self._arguments]
        with self.log.open("wb") as log:
            self._process = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, start_new_session=True
            )
        try:
            self.wait_for(rosgraph.is_master_online, "the master")
            self.wait_for(lambda: bool(address_of("/rosoclingo")), "the core")  # by then all parameters are set
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_error: object) -> None:
        if self._process is None:
            return
        for number, patience in ((signal.SIGINT, END_TIME), (signal.SIGTERM, 5.0), (signal.SIGKILL, 5.0)):
            _signal_group(self._process.pid, number)
            try:
                self._process.wait(patience)
                break
            except subprocess.TimeoutExpired:
                continue
        _signal_group(self._process.pid, signal.SIGKILL)
        if unfinished_path(self.bag).exists():  # the recorder was killed
            with suppress(BagError):
                repair(self.bag, self.bag, "/record/notes")

    def check(self) -> None:
        """Raise DemoError if the system has ended."""
        if self._process is not None and self._process.poll() is not None:
            raise DemoError(f"the system ended by itself; its log is {self.log}{self._tail()}")

    def wait_for(self, condition: Callable[[], bool], what: str) -> None:
        """Wait until ``condition`` holds; raise DemoError if the system ends, or after START_TIME."""
        end = time.monotonic() + START_TIME
        while not condition():
            self.check()
            if time.monotonic() > end:
                raise DemoError(f"{what} is not up after {START_TIME:g} s; the log is {self.log}")
            time.sleep(0.05)

    def _tail(self) -> str:
        """Return the log from the first fatal error of a node, or else its last lines."""
        lines = self.log.read_text(encoding="utf-8", errors="replace").splitlines()
        fatal = (number for number, line in enumerate(lines) if "[FATAL]" in line)
        start = next(fatal, max(0, len(lines) - 15))
        return "".join("\n    " + line for line in lines[start : start + 15])


def demo(scenario: Scenario, folder: Path, arguments: List[str], say: Callable[[str], None]) -> ScenarioOutcome:
    """Play a scenario in its own system; print the account, the summary, and the paths of bag and report.

    Raises DemoError.
    """
    began = time.monotonic()
    say(f"{scenario.title}: starting roscore, simulation, navigation, interfaces and core ...")
    with DemoSystem(scenario.launch, folder, arguments) as system:
        rospy.init_node("demo", disable_signals=True)
        outcome = run_scenario(
            scenario,
            list(scenario.servers),
            say,
            START_TIME,
            check=system.check,
            recording=lambda: is_recording(RECORDED),
        )
        rospy.signal_shutdown("the scenario is over")
        for line in ("", *outcome.account.summary(), *_verdict(scenario, outcome)):
            say(line)
    say(f"time: {outcome.account.seconds:.1f} s simulated, {time.monotonic() - began:.1f} s in all")
    say(f"bag: {system.bag}")
    say(_report(scenario, outcome, system.bag))
    return outcome


def _verdict(scenario: Scenario, outcome: ScenarioOutcome) -> List[str]:
    """Return lines about the differences from the scenario's expectations."""
    if outcome.faults:
        return ["NOT AS EXPECTED: " + fault for fault in outcome.faults]
    return ["as expected"] if scenario.expect else []


def _report(scenario: Scenario, outcome: ScenarioOutcome, bag: Path) -> str:
    """Write a report of the run next to its bag and return a line with its path."""
    judged = scenario.expect or outcome.faults
    about = {"title": scenario.title, "verdict": list(outcome.faults) if judged else None}
    report = bag.with_suffix(".html")
    try:
        write_report(bag, report, about=about)
    except (RecordingError, OSError) as error:
        return f"no report: {error}"
    return f"report: {report}"


def run_folder(name: str) -> Path:
    """Return a new folder for the files of a run, in ROS's home."""
    home = Path(os.environ.get("ROS_HOME") or Path.home() / ".ros")
    stamp = datetime.now().strftime("%Y-%m-%d-%H-%M-%S")
    return home / "rosoclingo" / f"{Path(name).stem}-{stamp}-{os.getpid()}"


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _environment(port: int, folder: Path) -> Dict[str, str]:
    """Return ROS's environment variables for a system on this machine only."""
    os.environ.pop("ROS_HOSTNAME", None)
    os.environ.pop("ROS_NAMESPACE", None)
    uri = f"http://127.0.0.1:{port}"
    return {"ROS_MASTER_URI": uri, "ROS_IP": "127.0.0.1", "ROS_HOME": str(folder), "ROS_LOG_DIR": str(folder / "log")}


def _signal_group(leader: int, number: int) -> None:
    with suppress(ProcessLookupError):
        os.killpg(leader, number)
