"""A restarted roscore: activities continue, newcomers find the nodes, and missed publishers are found."""

import importlib.util
import os
import signal
import socket
import subprocess
import unittest
from contextlib import ExitStack
from pathlib import Path
from unittest import mock

import rosgraph
from interface_helpers import PATIENCE, Process, executable, master_answers, send_request, wait_until

ROOT = Path(__file__).resolve().parents[3]
ERRANDS = ROOT / "test" / "data" / "errands.lp"
ANSWER = "{interface: test, facts: ['_return(walk,1,1)']}"


#: The address on which the nodes of this test listen.
ADDRESS = os.environ.get("ROS_HOSTNAME", "localhost")


def free_port():
    with socket.socket() as one:
        one.bind((ADDRESS, 0))
        return one.getsockname()[1]


class MasterRestarted(unittest.TestCase):
    def setUp(self):
        self.stack = ExitStack()
        self.addCleanup(self.stack.close)
        self.port = str(free_port())
        environment = {"ROS_MASTER_URI": f"http://{ADDRESS}:{self.port}", "PYTHONUNBUFFERED": "1"}
        self.stack.enter_context(mock.patch.dict(os.environ, environment))
        self.start_master()

    def start_master(self):
        self.master = self.stack.enter_context(Process("rosmaster", "--core", "-p", self.port))
        wait_until(master_answers, "the master")

    def run_node(self, script, *arguments):
        self.stack.enter_context(Process(executable(script), *arguments))

    def known(self, *entries):
        """Return whether the master lists all of these (0 publisher, 1 subscriber, 2 service; name; node)."""
        state = rosgraph.Master("/test").getSystemState()
        return all(node in dict(state[kind]).get(name, []) for kind, name, node in entries)

    def restart_master(self):
        self.master.signal(signal.SIGKILL)
        self.master.wait()
        self.start_master()

    def test_core_continues_and_is_found_again(self):
        entries = [(1, "/in_rosoclingo", "/rosoclingo"), (0, "/out_rosoclingo", "/rosoclingo")]
        self.run_node("core", f"_program_files:=[{ERRANDS}]")
        wait_until(lambda: self.known(*entries), "the core")
        waiting = self.stack.enter_context(send_request("do(walk,1)"))
        waiting.lines_until("walk")
        self.restart_master()
        wait_until(lambda: self.known(*entries), "the core at the new master")
        self.assertEqual(rosgraph.Master("/test").getParam("/rosoclingo/program_files"), [str(ERRANDS)])
        with Process("rostopic", "pub", "-r", "2", "in_rosoclingo", "rosoclingo/InterfaceIO", ANSWER):
            self.assertEqual(waiting.wait()[0], 0, "the action under way succeeds")

    @unittest.skipUnless(importlib.util.find_spec("tf2_ros"), "the office needs tf2_ros, which is compiled")
    def test_state_of_the_office_is_persisted_again(self):
        self.run_node("office", "_labels:={hall: [0, 0], attic: [9, 9]}", "_packages:={hall: ['1', '2']}")
        wait_until(lambda: self.known((2, "/office/put_package", "/office")), "the office")
        call = ["rosservice", "call", "/office/put_package", "{package: '1', location: attic}"]
        subprocess.run(call, check=True, timeout=PATIENCE, stdout=subprocess.DEVNULL)
        kept = {"lying": {"attic": ["1"], "hall": ["2"]}, "carried": []}
        self.assertEqual(rosgraph.Master("/test").getParam("/office/kept"), kept)
        self.restart_master()
        wait_until(lambda: rosgraph.Master("/test").hasParam("/office/kept"), "the packages at the new master")
        self.assertEqual(rosgraph.Master("/test").getParam("/office/kept"), kept)

    def test_publisher_missed_by_rospy_is_found(self):
        """Its node is connected although the master has reported it only once, and rospy missed that."""
        with Process(str(Path(__file__).with_name("missing_listener.py"))) as listener:
            wait_until(lambda: self.known((1, "/news", "/listener")), "the listener")
            with Process("rostopic", "pub", "-r", "2", "news", "std_msgs/String", "hello"):
                self.assertEqual(listener.lines_until("hello")[-1], "hello True")
