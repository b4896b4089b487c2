"""The core during an endless search or grounding: time limit, cancel, Ctrl-C and sudden death of the node."""

import os
import signal
import tempfile
import unittest
from contextlib import contextmanager, suppress
from pathlib import Path

import rospy
from actionlib_msgs.msg import GoalStatus
from core_helpers import ERRANDS, Client, ManualInterfaces, Updates, start_core
from interface_helpers import PATIENCE, process_of, wait_until
from rosoclingo.msg import TaskPlan
from std_srvs.srv import SetBool, Trigger

#: The errand boom is grounded without end, the errand pigeons is searched without end.
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
    """Start a core with endless errands; its topics are /NAMESPACE/..."""
    with tempfile.NamedTemporaryFile("w", suffix=".lp") as file:
        file.write(Path(ERRANDS).read_text() + ENDLESS)
        file.flush()
        given = {"action_timeout": 0.2, **parameters, "program_files": f"[{file.name}]"}
        with start_core(namespace, **given) as process:
            yield process


def stat(pid):
    """Return the fields of a process in /proc from its state on; those of a dead one if it does not exist."""
    with suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
    return ["Z", "0"]


def children(node):
    """Return the process ids of a node's children."""
    parent = str(process_of(node))
    return [int(path.name) for path in Path("/proc").glob("[0-9]*") if stat(path.name)[1] == parent]


def gone(pid):
    return stat(pid)[0] == "Z"


def worked(node):
    """Return the processor time in seconds of each child of a node: an update is published only once it is in force."""
    return {pid: sum(map(int, stat(pid)[11:13])) / os.sysconf("SC_CLK_TCK") for pid in children(node)}


@contextmanager
def kept_busy(node):
    """Wait until a child has used more time than its start and the improvement of a plan during an action take."""
    before = worked(node)
    yield
    wait_until(
        lambda: any(seconds > before.get(pid, 0.0) + 1.5 for pid, seconds in worked(node).items()),
        "the solver to be at work",
    )


class CoreInterrupted(unittest.TestCase):
    def serves(self, namespace, goal, updates):
        """Check that the core serves another goal."""
        sent = Client(f"{namespace}/rosoclingo").send(goal)
        action = goal.replace("do(", "_action_lib(")[:-1]
        updates.wait_for(goal)
        sent.arrived()
        wait_until(lambda: any(action in text for text in self.plan(sent)), "a plan")
        sent.cancel()
        return sent

    @staticmethod
    def plan(sent):
        return [text for feedback in sent.feedback for text in feedback.task_plan]

    def test_time_limit_ends_grounding(self):
        with core("timed", search_timeout=1.0):  # in this processor time any machine can plan for the other goal
            updates = Updates("timed/rosoclingo")
            goal = Client("timed/rosoclingo").send("do(boom,1)")
            wait_until(lambda: goal.feedback, "word that the goal waits")
            self.assertEqual(goal.feedback[0].status, "waiting: the solver did not accept it in time")
            self.serves("timed", "do(walk,2)", updates)
            self.cancelled(goal)

    def cancelled(self, goal):
        """Cancel a goal, and check its end."""
        goal.cancel()
        self.assertIn(goal.wait()[0], (GoalStatus.RECALLED, GoalStatus.PREEMPTED))

    def test_cancel_and_operator_end_grounding_and_search(self):
        with core("cancelled", search_timeout=0, horizon_limit=2):
            updates = Updates("cancelled/rosoclingo")
            rospy.wait_for_service("cancelled/rosoclingo/stop", PATIENCE)
            for number, what in enumerate(["boom", "pigeons"], 1):
                with kept_busy("/cancelled/rosoclingo"):
                    goal = Client("cancelled/rosoclingo").send(f"do({what},{number})")
                self.cancelled(goal)
                self.assertLessEqual(len(children("/cancelled/rosoclingo")), 2, "more than one in reserve")
            with kept_busy("/cancelled/rosoclingo"):
                goal = Client("cancelled/rosoclingo").send("do(pigeons,3)")
            for other in [Client("cancelled/rosoclingo").send(f"do(walk,{number})") for number in (4, 5)]:
                other.arrived()
                other.cancel()
                self.assertIn("was cancelled before it was planned for", other.ends_as(GoalStatus.RECALLED))
            pause = rospy.ServiceProxy("cancelled/rosoclingo/pause", SetBool)
            self.assertEqual([pause(True).success, pause(False).success], [True, True])
            self.assertTrue(rospy.ServiceProxy("cancelled/rosoclingo/stop", Trigger)().success)
            self.assertIn("an operator has stopped the core", goal.ends_as(GoalStatus.ABORTED))
            self.serves("cancelled", "do(walk,6)", updates)

    def test_ctrl_c_ends_grounding(self):
        with core("stopped", search_timeout=0) as process:
            client = Client("stopped/rosoclingo")
            pids = children("/stopped/rosoclingo")
            with kept_busy("/stopped/rosoclingo"):
                goal = client.send("do(boom,1)")
            process.signal(signal.SIGINT)
            self.assertIn("the core shuts down", goal.ends_as(GoalStatus.ABORTED))
            code, error = process.wait()
            self.assertEqual(code, 0, error)
            self.assertNotIn("Traceback", error)
            wait_until(lambda: all(map(gone, pids)), "the end of the solver's process")

    def test_ctrl_c_cancels_running_actions_but_death_does_not(self):
        with tempfile.TemporaryDirectory() as folder:
            settings = {"journal": folder, "resume": "yes", "action_timeout": 0}
            with core("moving", **settings) as process:
                hands, client = ManualInterfaces("moving/rosoclingo"), Client("moving/rosoclingo")
                client.send("do(walk,1)")
                walk = hands.take()
                for number in (2, 3):
                    client.send(f"do(quick,{number})").arrived()
                hands.seen.clear()
                hands.succeed(walk)
                wait_until(lambda: len(hands.seen) == 2, "two actions")
                actions = {*hands.seen}
                cancels = {fact.replace("_action_lib", "_cancel") for fact in actions}
                process.signal(signal.SIGKILL)
                process.wait()
            with core("moving", **settings) as process:
                wait_until(lambda: len(hands.seen) == 4, "the core that goes on to send them again")
                self.assertEqual({*hands.seen}, actions)
                rospy.wait_for_message("moving/rosoclingo/task_plan", TaskPlan, PATIENCE)  # it has begun
                process.signal(signal.SIGINT)
                code, error = process.wait()
                self.assertEqual(code, 0, error)
            wait_until(lambda: {*hands.seen} == actions | cancels, "the cancels")
            hands.seen.clear()
            with core("moving", **settings):
                wait_until(lambda: {*hands.seen} == actions | cancels, "the core that goes on to send them again")

    def test_worker_death_costs_one_update_and_core_death_leaves_no_process(self):
        with core("robbed", search_timeout=0) as process:
            updates, client = Updates("robbed/rosoclingo"), Client("robbed/rosoclingo")
            self.serves("robbed", "do(walk,1)", updates)
            pids = children("/robbed/rosoclingo")
            for pid in pids:
                os.kill(pid, signal.SIGKILL)
            wait_until(lambda: all(map(gone, pids)), "the end of the solver's process")
            self.serves("robbed", "do(run,2)", updates)
            with kept_busy("/robbed/rosoclingo"):
                client.send("do(boom,3)")
            pids = children("/robbed/rosoclingo")
            process.signal(signal.SIGKILL)
            wait_until(lambda: all(map(gone, pids)), "the end of the solver's process")
