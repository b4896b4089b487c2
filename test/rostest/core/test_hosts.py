"""A core and four robots on five hosts: slow, lossy and lost links, a restarted core's host, a robot gone for good."""

import os
import re
import signal
import tempfile
import time
import unittest
from collections import Counter
from contextlib import suppress
from pathlib import Path
from threading import Event

from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, Updates
from interface_helpers import executable, init_node, master_answers, wait_until
from network import Network, NotPermittedError

INITS_NODE = True  # a network namespace is entered before the first thread
HERE = Path(__file__).resolve()
PROGRAM = HERE.parents[2] / "data" / "robots.lp"
ROBOTS = {"r1": 2, "r2": 3, "r3": 4, "r4": 5}
PORT = "11311"

#: Seconds of two losses of links: TCP survives only the first. Both end in time for the actions to return.
SHORT_LOSS, LONG_LOSS, LOST_TIMEOUT = 20.0, 40.0, 60


class Hosts(unittest.TestCase):
    def setUp(self):
        try:
            self.network = Network(hosts=1 + len(ROBOTS))
        except NotPermittedError as error:
            self.skipTest(f"network namespaces are not permitted here, run the test as root: {error}")
        self.addCleanup(self.network.close)
        self.folder = Path(self.enter(tempfile.TemporaryDirectory()))
        self.processes = {}
        self.addCleanup(lambda: [self.kill(name) for name in self.processes])
        os.environ.update(ROS_MASTER_URI=f"http://{self.network.address(1)}:{PORT}", ROS_IP=self.network.address(1))
        os.environ.pop("ROS_HOSTNAME", None)
        self.start_core()
        for robot in ROBOTS:
            self.start_robot(robot)
        init_node("client")
        self.client, self.updates = Client(), Updates()
        self.goals = {}

    def enter(self, context):
        self.addCleanup(context.__exit__, None, None, None)
        return context.__enter__()

    def start(self, name, host, *command):
        self.processes[name] = self.network.start(host, self.folder / f"{name}.log", *command)

    def kill(self, name):
        with suppress(ProcessLookupError):
            os.killpg(self.processes[name].pid, signal.SIGKILL)
        self.processes[name].wait()

    def start_core(self, resume="no"):
        self.start("master", 1, "rosmaster", "--core", "-p", PORT, "-t", "5")
        wait_until(master_answers, "the master")
        parameters = {
            "program_files": f"[{PROGRAM}]",
            "journal": self.folder / "journal",
            "resume": f"'{resume}'",
            "interface_timeout": 3,
            "lost_timeout": LOST_TIMEOUT,
        }
        self.start("core", 1, executable("core"), *(f"_{key}:={value}" for key, value in parameters.items()))

    def start_robot(self, robot):
        host, log = ROBOTS[robot], self.folder / f"{robot}.goals"
        log.touch()
        entry = f"{{type: actionlib/TestAction, server: /{robot}/work, goal: {{goal: $parameter}}, timeout: 0}}"
        self.start(f"{robot} server", host, HERE.with_name("signalled_server.py"), "work", log, f"__ns:={robot}")
        self.start(
            f"{robot} interface",
            host,
            executable("interface"),
            f"__name:=interface_{robot}",
            f"_interfaces:={{work({robot}): {entry}}}",
            f"_memory:={self.folder}",
        )

    def signal(self, number, *robots):
        for robot in robots:
            os.kill(self.processes[f"{robot} server"].pid, number)

    def send(self, *identifiers):
        self.goals.update({one: self.client.send(f"do({one})") for one in identifiers})

    def begun(self, robot):
        """Return the goals that a robot's server has begun."""
        return list(map(int, (self.folder / f"{robot}.goals").read_text().split()))

    def succeed(self, *identifiers):
        for one in identifiers:
            self.goals[one].ends_as(GoalStatus.SUCCEEDED)

    def begin_on_each(self, *identifiers):
        """Send a goal for each robot and wait until each has begun one; return these by robot."""
        self.signal(signal.SIGUSR1, *ROBOTS)
        self.send(*identifiers)
        wait_until(lambda: all(set(self.begun(robot)) & set(identifiers) for robot in ROBOTS), "each robot to begin")
        return {robot: next(iter(set(self.begun(robot)) & set(identifiers))) for robot in ROBOTS}

    def restart_core(self):
        """Restart the core's host: its connections end without a word."""
        self.network.link(1).cut = True
        self.kill("core")
        self.kill("master")
        self.network.link(1).cut = False
        self.start_core(resume="yes")

    def test_faults_of_links_and_hosts(self):
        slow = self.network.link(ROBOTS["r4"])
        slow.delay, slow.loss = 0.2, 0.05
        self.send(1, 2, 3, 4)
        self.succeed(1, 2, 3, 4)

        self.begin_on_each(5, 6, 7, 8)
        self.restart_core()
        self.signal(signal.SIGUSR2, *ROBOTS)
        self.succeed(5, 6, 7, 8)

        work = self.begin_on_each(9, 10, 11, 12)
        since = time.monotonic()
        for robot in ("r1", "r2", "r3"):
            self.network.link(ROBOTS[robot]).cut = True
        self.kill("r2 interface")
        self.kill("r2 server")
        self.signal(signal.SIGUSR2, "r1", "r3", "r4")  # two actions end while the links are lost
        self.send(13, 14)
        self.succeed(work["r4"], 13, 14)  # while the others are lost
        for seconds, robot in ((SHORT_LOSS, "r1"), (LONG_LOSS, "r3")):
            Event().wait(max(0.0, since + seconds - time.monotonic()))
            self.network.link(ROBOTS[robot]).cut = False
        self.succeed(*self.goals)
        for words in ("_lost(r1,", "_lost(r2,", "_lost(r3,", "_back(r1,", "_back(r3,"):
            self.updates.wait_for(words)

        done = Counter(goal for robot in ROBOTS for goal in self.begun(robot))
        self.assertEqual(done.pop(work["r2"]), 2, "another robot repeats what r2 has begun")
        self.assertEqual(done, Counter(set(self.goals) - {work["r2"]}), "all others are done once")
        # A restarted core hears a robot again after two seconds or more, so the robot can be lost and back before.
        told = re.findall(r"_(lost|back)\(r2,", " ".join(self.updates.texts))
        self.assertEqual(told[-1], "lost", "r2 is not back once its host is gone")
