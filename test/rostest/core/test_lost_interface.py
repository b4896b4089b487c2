#!/usr/bin/env python3
"""An interface that is killed or suspended is lost, its action fails, and it is back once it is heard again."""

import signal
import sys
import unittest
from contextlib import ExitStack
from functools import partial
from pathlib import Path

import rostest
from actionlib.msg import TestAction
from actionlib_msgs.msg import GoalStatus
from diagnostic_msgs.msg import DiagnosticStatus

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, Updates
from interface_helpers import Process, Server, executable, init_node, wait_for_diagnosis, wait_until

ROBOTS = ("r1", "r2", "r3", "r4")


def reports_loss(robot, status):
    return (status.level, status.message) == (DiagnosticStatus.WARN, f"lost robots: {robot}")


class LostInterface(unittest.TestCase):
    def setUp(self):
        self.stack = ExitStack()
        self.addCleanup(self.stack.close)
        self.nodes = {}
        for robot in ROBOTS:
            self.start(robot)
        known = ", ".join(f"work({robot})" for robot in ROBOTS)
        wait_for_diagnosis("rosoclingo: core", lambda one: known in str(one.values), "the interfaces")
        self.updates = Updates()

    def start(self, robot):
        entry = f"{{type: actionlib/TestAction, server: {robot}/work, goal: {{goal: $parameter}}, timeout: 0}}"
        command = [
            executable("interface"),
            f"__name:=interface_{robot}",
            f"_interfaces:={{work({robot}): {entry}}}",
            "_memory:=''",
        ]
        self.nodes[robot] = self.stack.enter_context(Process(*command))

    def begin(self, identifier):
        """Send a goal; return it, the robot that begins it, and the handle of the robot's server."""
        goal, robots = CLIENT.send(f"do({identifier})"), []
        wait_until(lambda: robots.extend(one for one in ROBOTS if not SERVERS[one].idle()) or robots, "a robot")
        return goal, robots[0], SERVERS[robots[0]].accept()

    def test_killed_interface_is_lost_and_then_back(self):
        goal, robot, _ = self.begin(1)
        self.nodes[robot].signal(signal.SIGKILL)
        self.updates.wait_for(f"_lost({robot},")
        self.updates.wait_for(f"_return(work({robot}),lost,")
        wait_for_diagnosis("rosoclingo: core", partial(reports_loss, robot), "the diagnostics")
        others = [one for one in ROBOTS if one != robot]
        wait_until(lambda: any(not SERVERS[one].idle() for one in others), "another robot to get the goal")
        next(SERVERS[one] for one in others if not SERVERS[one].idle()).accept().set_succeeded()
        goal.ends_as(GoalStatus.SUCCEEDED)
        self.start(robot)
        self.updates.wait_for(f"_back({robot},")

    def test_suspended_interface_continues_or_cancels_its_action(self):
        goal, robot, handle = self.begin(2)
        self.nodes[robot].signal(signal.SIGSTOP)
        self.updates.wait_for(f"_lost({robot},")
        self.updates.wait_for(f"_return(work({robot}),lost,")
        self.nodes[robot].signal(signal.SIGCONT)
        SERVERS[robot].cancelled().set_canceled()
        next(SERVERS[one] for one in ROBOTS if not SERVERS[one].idle()).accept().set_succeeded()
        goal.ends_as(GoalStatus.SUCCEEDED)
        self.updates.wait_for(f"_back({robot},")
        self.assertNotEqual(handle.get_goal_status().status, GoalStatus.ACTIVE)
        self.assertTrue(all(SERVERS[one].idle() for one in ROBOTS), "nothing else is executed")


if __name__ == "__main__":
    init_node("client")
    CLIENT = Client()
    SERVERS = {robot: Server(f"{robot}/work", TestAction) for robot in ROBOTS}
    rostest.rosrun("rosoclingo", "lost_interface", LostInterface, sys.argv)
