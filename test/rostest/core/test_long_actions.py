#!/usr/bin/env python3
"""Actions of different length run at once: the fast ones do not wait for the slow one, also if the core is killed."""

import os
import shutil
import signal
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, ManualInterfaces, Updates
from interface_helpers import Process, executable, init_node, is_another, process_of, wait_until

TEAM = str(Path(__file__).resolve().parents[2] / "data" / "team.lp")
NODE = "/rosoclingo"


class LongActions(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.hands, cls.client = ManualInterfaces(), Client()

    def setUp(self):
        self.hands.wait_for(NODE)

    def begin(self, text):
        """Send a goal and wait for its action."""
        goal = self.client.send(text)
        wait_until(goal.has_arrived, "the goal to arrive")
        return goal, self.hands.take()

    def test_fast_actions_do_not_wait_for_slow_one(self):
        updates = Updates()
        slow, sawing = self.begin("job(saw,1)")
        for number in (2, 3, 4):
            fast, drilling = self.begin(f"job(drill,{number})")
            self.hands.succeed(drilling)
            fast.ends_as(GoalStatus.SUCCEEDED)
        cycle = int(sawing[len("_action_lib(saw,1,") : -1])
        updates.wait_for(f"_running(saw,1,{cycle + 1}).")
        self.assertNotEqual(slow.handle.get_comm_state(), CommState.DONE)
        self.hands.succeed(sawing)
        slow.ends_as(GoalStatus.SUCCEEDED)
        self.assertEqual(self.hands.seen.count(sawing), 1, "it is sent once")

    def test_killed_core_continues_running_actions(self):
        slow, sawing = self.begin("job(saw,11)")
        fast, drilling = self.begin("job(drill,12)")
        runs, process = set(self.hands.runs), process_of(NODE)
        os.kill(process, signal.SIGKILL)
        wait_until(lambda: is_another(NODE, process), "the core to be started again")
        self.assertEqual({self.hands.take(), self.hands.take()}, {sawing, drilling}, "as they were sent before")
        wait_until(lambda: self.hands.succeed(drilling) or CommState.DONE in fast.states, "the fast goal to end")
        fast.ends_as(GoalStatus.SUCCEEDED)
        self.assertNotIn(CommState.DONE, slow.states)
        self.hands.succeed(sawing)
        slow.ends_as(GoalStatus.SUCCEEDED)
        self.assertEqual(set(self.hands.runs), runs)

    def test_slow_action_times_out_while_others_start(self):
        values = [f"_program_files:=[{TEAM}]", "_journal:=none", "_action_timeout:=2.0"]
        with Process(executable("core"), "__name:=rosoclingo", "__ns:=elsewhere", *values):
            hands, client = ManualInterfaces("elsewhere/"), Client("elsewhere/rosoclingo")
            hands.wait_for("/elsewhere/rosoclingo")
            updates = Updates("elsewhere/rosoclingo")
            slow = client.send("job(saw,1)")
            self.assertEqual(hands.take(), "_action_lib(saw,1,1)")
            fast = client.send("job(drill,2)")
            hands.succeed(hands.take())
            fast.ends_as(GoalStatus.SUCCEEDED)
            updates.wait_for("_return(saw,timeout,")
            again = hands.take()
            self.assertTrue(again.startswith("_action_lib(saw,1,"), again)
            hands.succeed(again)
            slow.ends_as(GoalStatus.SUCCEEDED)


if __name__ == "__main__":
    folder = rospy.myargv()[1]
    init_node("long_actions_test")
    try:
        rostest.rosrun("rosoclingo", "long_actions", LongActions, sys.argv)
    finally:
        shutil.rmtree(folder, ignore_errors=True)
