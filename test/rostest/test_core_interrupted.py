#!/usr/bin/env python3
"""The core while its solver works without end: time limit, cancel, Ctrl-C and the node's sudden death."""

import os
import signal
import sys
import tempfile
import unittest
from contextlib import contextmanager, suppress
from pathlib import Path
from xmlrpc.client import ServerProxy

import rosgraph
import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, Updates
from interface_helpers import Process, wait_until

ERRANDS = Path(__file__).resolve().parents[1] / "data" / "errands.lp"

#: The errand boom is ground without end, the errand pigeons is searched without end.
ENDLESS = """
#program cumulative(t).
n(0,t) :- asked(boom,_,C), C <= t+1.
n(X+1,t) :- n(X,t), X < 2000000000.
1 { in(P,H,t) : H = 1..14 } 1 :- P = 1..15, asked(pigeons,I,C), C <= t, not dropped(I).
:- in(P,H,t), in(Q,H,t), P < Q.
#program base.
dropped(I) :- _request(cancel(I),_).
"""


@contextmanager
def core(namespace, **parameters):
    """A core with endless errands; its topics are /NAMESPACE/..."""
    with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
        file.write(ERRANDS.read_text() + ENDLESS)
        file.flush()
        values = [f"_{name}:={value}" for name, value in dict(parameters, program_files=f"[{file.name}]").items()]
        command = ["rosrun", "rosoclingo", "core", "__name:=rosoclingo", f"__ns:={namespace}", *values]
        with Process(*command, "_action_timeout:=1") as process:
            yield process


def stat(pid):
    """State and parent of a process, None where there is none."""
    with suppress(OSError):
        state, parent = Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[:2]
        return state, int(parent)
    return None


def children(node):
    """Process ids of a node's children."""
    pid = ServerProxy(rosgraph.Master(rospy.get_name()).lookupNode(node)).getPid(rospy.get_name())[2]
    pids = [int(path.name) for path in Path("/proc").glob("[0-9]*")]
    return [one for one in pids if stat(one) is not None and stat(one)[1] == pid]


def gone(pid):
    return stat(pid) is None or stat(pid)[0] == "Z"


class CoreInterrupted(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        rospy.init_node("core_interrupted_test")

    def serves(self, namespace, goal, updates):
        """The core serves another goal."""
        sent = Client(f"{namespace}/rosoclingo").send(goal)
        action = goal.replace("do(", "_action_lib(")[:-1]
        wait_until(lambda: any(goal in text for text in updates.texts), "the request")
        sent.arrived()
        wait_until(lambda: any(action in text for text in self.plan(sent)), "a plan")
        sent.handle.cancel()
        return sent

    @staticmethod
    def plan(sent):
        return [text for feedback in sent.feedback for text in feedback.task_plan]

    def test_time_limit_ends_grounding(self):
        with core("timed", search_timeout=1.5):
            updates = Updates("timed/rosoclingo")
            goal = Client("timed/rosoclingo").send("do(boom,1)")
            message = goal.ends_as(GoalStatus.ABORTED)
            self.assertIn("do(boom,1) is given up without a plan: it took longer than 1.5 s", message)
            self.serves("timed", "do(walk,2)", updates)

    def test_cancel_ends_grounding_and_search(self):
        with core("cancelled", search_timeout=0, horizon_limit=2):
            updates = Updates("cancelled/rosoclingo")
            for number, what in enumerate(["boom", "pigeons"], 1):
                text = f"do({what},{number})"
                goal = Client("cancelled/rosoclingo").send(text)
                wait_until(lambda text=text: any(text in update for update in updates.texts), "the request")
                goal.handle.cancel()
                self.assertIn(goal.wait()[0], (GoalStatus.RECALLED, GoalStatus.PREEMPTED))
            self.serves("cancelled", "do(walk,3)", updates)

    def test_ctrl_c_ends_grounding(self):
        with core("stopped", search_timeout=0) as process:
            updates = Updates("stopped/rosoclingo")
            (child,) = children("/stopped/rosoclingo")
            goal = Client("stopped/rosoclingo").send("do(boom,1)")
            wait_until(lambda: updates.texts, "the request")
            process.signal(signal.SIGINT)
            self.assertIn("the core shuts down", goal.ends_as(GoalStatus.ABORTED))
            code, error = process.wait()
            self.assertEqual(code, 0, error)
            self.assertNotIn("Traceback", error)
            wait_until(lambda: gone(child), "the end of the solver's process")

    def test_sudden_death_leaves_no_process_behind(self):
        with core("killed", search_timeout=0) as process:
            updates = Updates("killed/rosoclingo")
            (child,) = children("/killed/rosoclingo")
            Client("killed/rosoclingo").send("do(boom,1)")
            wait_until(lambda: updates.texts, "the request")
            process.signal(signal.SIGKILL)
            wait_until(lambda: gone(child), "the end of the solver's process")

    def test_death_of_the_solver_costs_one_update_at_most(self):
        with core("robbed") as process:
            updates = Updates("robbed/rosoclingo")
            self.serves("robbed", "do(walk,1)", updates)
            (child,) = children("/robbed/rosoclingo")
            os.kill(child, signal.SIGKILL)
            wait_until(lambda: gone(child), "the end of the solver's process")
            self.serves("robbed", "do(run,2)", updates)
            self.assertIsNotNone(process)


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "core_interrupted", CoreInterrupted, sys.argv)
