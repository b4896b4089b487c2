#!/usr/bin/env python3
"""The core node's start: bad parameters, gaps of a program, constants and labels; and the end of a request."""

import signal
import sys
import tempfile
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from rosoclingo.msg import TaskPlan

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, Updates, start_core
from interface_helpers import CommandProcess, Process, executable, init_node, wait_until


class CoreStart(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("core_start_test")

    def test_bad_parameters_end_the_start(self):
        with start_core("zero", horizon_limit=0) as process:
            code, error = process.wait()
        self.assertEqual(code, 1, error)
        self.assertIn("~horizon_limit: must be an integer of at least 1, not 0", error)
        self.assertNotIn("Traceback", error)

    def test_unread_parameters_are_reported(self):
        arm = ("_interfaces:={arm: {type: actionlib/TestAction}}", "_server_timout:=3", "_retries:=1")
        for process, words in (
            (start_core("misspelt", horizon_limt=7), "~horizon_limt (did you mean ~horizon_limit?)"),
            (Process(executable("interface"), "__name:=arm", *arm), "~server_timout (did you mean ~server_timeout?)"),
        ):
            with process:
                lines = process.lines_until("unknown parameters")
            self.assertIn(words, lines[-1])

    def test_program_gaps_are_reported_at_the_start(self):
        with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
            file.write("#const n = 2.\n#program cumulative(t).\n{ _action_lib(go,n,t) }.\n")
            file.flush()
            with start_core("lacking", program_files=f"[{file.name}]", constants="{n: -2}") as process:
                Client("lacking/rosoclingo").send("go(1)").ends_as(GoalStatus.REJECTED)
                process.signal(signal.SIGINT)
                error = process.wait()[1]
        for text in ("no external _request/2 (write", "no external _return/3 (write", "no volatile part", "n is -2"):
            self.assertEqual(error.count(text), 1, error)

    def test_constants_and_labels_reach_the_program(self):
        with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
            file.write(
                "#const n = 1.\n#external _return/3.\n#program cumulative(t).\n"
                "_action_lib(go,L,n) :- label(L), t = n.\n#program volatile(t).\n:- t < n.\n"
            )
            file.flush()
            values = {"program_files": f"[{file.name}]", "constants": "{n: 2}", "labels": "{kitchen: {x: 1, y: 2}}"}
            with start_core("labelled", **values):
                plans = []
                subscriber = rospy.Subscriber("labelled/rosoclingo/task_plan", TaskPlan, plans.append)
                wait_until(lambda: plans and plans[-1].cycle == 2, "cycle 2")
                subscriber.unregister()
                self.assertEqual(plans[-1].actions, ["_action_lib(go,kitchen,2)"])

    def test_request_is_cancelled_on_ctrl_c(self):
        with start_core("asked", action_timeout=2.0):
            updates = Updates("asked/rosoclingo")
            with CommandProcess("request", "do(walk,1)", "--server", "asked/rosoclingo", "--wait", "30") as request:
                wait_until(lambda: updates.texts, "the request")
                request.signal(signal.SIGINT)
                updates.wait_for("cancel(1)")
                self.assertEqual(request.wait()[0], 2)


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "core_start", CoreStart, sys.argv)
