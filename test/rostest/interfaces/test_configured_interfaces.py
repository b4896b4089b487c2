"""Interfaces by configuration: goals filled, ends answered, time-outs, retries, servers that are absent or die."""

import signal
import sys
import threading
import unittest
from pathlib import Path
from unittest import mock

import rospy
from actionlib.msg import (
    TestAction,
    TestGoal,
    TestRequestAction,
    TestRequestResult,
    TwoIntsAction,
    TwoIntsGoal,
    TwoIntsResult,
)
from actionlib_msgs.msg import GoalStatusArray
from clingo import Function, Number
from diagnostic_msgs.msg import DiagnosticStatus
from interface_helpers import (
    PATIENCE,
    CoreSide,
    Process,
    Server,
    executable,
    heard_log,
    values_of,
    wait_for_diagnosis,
    wait_until,
)
from rospy.topics import _PublisherImpl

from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.answers import Answer
from rosoclingo.interfaces.attempt import ActionLimits
from rosoclingo.interfaces.base import Interface, RefusalError
from rosoclingo.interfaces.config import ConfigError
from rosoclingo.interfaces.hosting import InterfacesNode

MORTAL = str(Path(__file__).resolve().parent / "mortal_server.py")


def succeed(goal):
    goal.set_accepted()
    goal.set_succeeded()


def fail(goal):
    goal.set_accepted()
    goal.set_aborted()


def reject(goal):
    goal.set_rejected()


class ConfiguredInterfaces(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.core = CoreSide()
        cls.oracle = Server("oracle", TestRequestAction)
        cls.count = Server("count", TestAction)
        cls.hasty, cls.slow = Server("hasty", TestAction), Server("slow", TestAction)
        cls.core.wait_for("interface")

    def tearDown(self):
        self.assertTrue(self.core.silent(), "exactly one message answers an action")

    def test_goal_fields_and_answer_follow_the_entry(self):
        self.core.send("ask", '_action_lib(ask,q(42,"some words",true,"1.5"),2)')
        handle = self.oracle.accept()
        goal = handle.get_goal()
        self.assertEqual((goal.the_result, goal.result_text, goal.ignore_cancel), (42, "some words!", True))
        self.assertEqual(goal.delay_terminate, rospy.Duration(1.5))
        handle.set_succeeded(TestRequestResult(the_result=43), "seen(cup)")
        self.assertEqual(self.core.receive(), ["said(42,2)", "seen(cup)", "_return(ask,answer(43),2)"])

    def test_failed_goal_is_sent_again_up_to_the_limit(self):
        for ends, value in (([fail, fail, succeed], "5"), ([fail] * 3, "failed"), ([reject], "rejected")):
            self.core.send("count", "_action_lib(count,5,1)")
            for end in ends:
                end(self.count.take())
            self.assertEqual(self.core.receive(), [f"_return(count,{value},1)"])

    def test_timeout_cancels_the_goal(self):
        self.core.send("slow", "_action_lib(slow,a,1)")
        self.slow.accept()
        self.slow.cancelled().set_canceled()
        self.assertEqual(self.core.receive(), ["_return(slow,timeout,1)"])

    def test_timeout_of_server_that_ignores_the_cancel(self):
        self.core.send("hasty", "_action_lib(hasty,a,2)")
        handle = self.hasty.accept()
        self.hasty.cancelled()
        self.assertEqual(self.core.receive(), ["_return(hasty,server_lost,2)"])
        self.assertTrue(self.hasty.idle(), "it is not sent again to a server that still has it")
        handle.set_succeeded()  # too late: it must be ignored
        self.assertEqual(self.core.run("absent", "_action_lib(absent,a,3)"), ["_return(absent,server_lost,3)"])

    def test_cancelled_goal_ends_as_its_server_says(self):
        for end, value in (
            (lambda goal: goal.set_canceled(), "preempted"),
            (lambda goal: goal.set_aborted(), "failed"),
            (lambda goal: goal.set_succeeded(), "5"),
        ):
            self.core.send("count", "_action_lib(count,5,1)")
            goal = self.count.accept()
            self.core.send("count", "_cancel(count,5,1)")
            self.count.cancelled()
            end(goal)
            self.assertEqual(self.core.receive(), [f"_return(count,{value},1)"])

    def test_absent_server_fails_the_action(self):
        self.assertEqual(self.core.run("absent", "_action_lib(absent,a,1)"), ["_return(absent,server_lost,1)"])
        self.core.send("absent", "_action_lib(absent,a,2)", "_cancel(absent,a,2)")
        self.assertEqual(self.core.receive(), ["_return(absent,preempted,2)"])

    def test_goal_waits_until_its_result_can_be_received(self):
        """rospy counts a connection at its reading end first: results sent before the server knows it are lost."""
        counts, add, lines = threading.Event(), _PublisherImpl.add_connection, heard_log("interface")

        def late(topic, connection):
            if topic.name == "/late/result":
                counts.wait(PATIENCE)
            return add(topic, connection)

        with mock.patch.object(_PublisherImpl, "add_connection", late):
            server = Server("late", TestAction)
            self.core.send("late", "_action_lib(late,a,1)")
            wait_until(lambda: any("late: waiting for the action server late" in one for one in lines), "that it waits")
            counts.set()
            server.take().set_rejected()
            self.assertEqual(self.core.receive(), ["_return(late,rejected,1)"])

    def test_server_that_dies_comes_back(self):
        for end in (signal.SIGKILL, signal.SIGINT, signal.SIGUSR1):
            with Process(sys.executable, MORTAL) as server:
                self.core.send("mortal", "_action_lib(mortal,a,1)")
                statuses = rospy.Subscriber("mortal/status", GoalStatusArray, self._note)
                self.statuses = []
                wait_until(lambda: 1 in self.statuses, "the goal to be active")
                server.signal(end)
                self.assertEqual(self.core.receive(), ["_return(mortal,server_lost,1)"])
                statuses.unregister()

    def _note(self, message):
        self.statuses.extend(status.status for status in message.status_list)


class SumInterface(Interface):
    """An interface in code: two numbers in a term, their sum in the return."""

    def make_goal(self, action):
        if not action.parameter.arguments:
            raise RefusalError("no_numbers", "add what?")
        first, second = (argument.number for argument in action.parameter.arguments)
        return TwoIntsGoal(first, second) if first else TestGoal(second)

    def make_answer(self, action, ended):
        if ended.status == "succeeded":
            return Answer(Number(ended.result.sum), ("calculated",)) if ended.result.sum else None
        return Answer(Function("no_sum")) if ended.status == "aborted" else super().make_answer(action, ended)


def report_of(name, condition):
    """Return the next diagnostic status of an interface that meets a condition."""
    return wait_for_diagnosis(f"rosoclingo: interface {name}", condition, f"a report of {name}")


class SubclassedInterface(unittest.TestCase):
    def test_subclass_computes_goal_and_answer(self):
        core, server, worker = CoreSide(), Server("adder", TwoIntsAction), Worker()
        SumInterface("sum", TwoIntsAction, "adder", worker=worker)
        worker.start()
        core.wait_for(rospy.get_name())
        # refused, and faults of the subclass itself
        for parameter, reason in (
            ("nothing", "no_numbers"),
            ("two(a,b)", "bad_parameter"),
            ("two(0,4)", "bad_parameter"),
        ):
            self.assertEqual(core.run("sum", f"_action_lib(sum,{parameter},2)"), [f"_return(sum,{reason},2)"])
        for end, value in (
            (lambda goal: goal.set_aborted(), "no_sum"),
            (lambda goal: goal.set_succeeded(TwoIntsResult(0)), "failed"),  # make_answer returns None
            (lambda goal: goal.set_succeeded(TwoIntsResult(7)), "7"),
        ):
            core.send("sum", "_action_lib(sum,two(3,4),1)")
            goal = server.accept()
            self.assertEqual((goal.get_goal().a, goal.get_goal().b), (3, 4))
            end(goal)
            self.assertEqual(core.receive(), [*["calculated"] * (value == "7"), f"_return(sum,{value},1)"])
        status = report_of("sum", lambda one: values_of(one)["succeeded"] == "2")
        values = values_of(status)
        self.assertEqual((status.level, status.message), (DiagnosticStatus.OK, "idle"))
        self.assertEqual((values["server"], values["failed"]), ("adder", "4"))
        status = report_of("absent", lambda _: True)
        self.assertEqual((status.level, status.message), (DiagnosticStatus.WARN, "server absent is not connected"))
        worker.stop()

    def test_subclass_fault_affects_only_its_actions(self):
        core, server, worker = CoreSide(), Server("trader", TwoIntsAction), Worker()
        SumInterface("odd", TwoIntsAction, "trader", ActionLimits(timeout="soon"), worker=worker)
        SumInterface("trade", TwoIntsAction, "trader", worker=worker)
        worker.start()
        core.wait_for(rospy.get_name())
        lines = heard_log(rospy.get_name())
        core.send("trade", "_action_lib(trade,two(3,4),1)")
        handle = server.accept()
        core.send("odd", "_action_lib(odd,two(1,1),1)", "_action_lib(odd,two(2,2),1)")
        odd = [server.accept() for _ in range(2)]
        self.assertEqual([core.receive(), core.receive()], [["_return(odd,failed,1)"]] * 2)
        for _ in odd:
            server.cancelled().set_canceled()
        status = report_of("odd", lambda one: values_of(one)["faults"] == "2")
        self.assertEqual(status.level, DiagnosticStatus.ERROR)
        self.assertIn("internal error: TypeError: '<' not supported", status.message)
        handle.set_succeeded(TwoIntsResult(7))
        self.assertEqual(core.receive(), ["calculated", "_return(trade,7,1)"])
        wait_until(lambda: any("odd: internal error: TypeError" in line for line in lines), "the log")
        reported = [line for line in lines if "odd: internal error: TypeError" in line and "Traceback" in line]
        self.assertEqual(len(reported), 1)
        worker.stop()


class InterfaceNode(unittest.TestCase):
    """The node as a process: its parameters, and its end."""

    def test_faults_are_reported_all_at_once(self):
        parameters = {
            "interfaces": {
                "pickup": {"type": "rosoclingo/PickupAction", "timeout": -1, "goal": {"pack": 1}},
                "leg": {"type": "nowhere/NoAction"},
            },
            "labels": {"a": 3},
            "names": ["pickup", "leg", "tail"],
            "server": 3,
            "timeout": -1,
        }
        for name, value in parameters.items():
            rospy.set_param("~" + name, value)
            self.addCleanup(rospy.delete_param, "~" + name)
        with self.assertRaises(ConfigError) as caught:
            InterfacesNode()
        beginnings = (
            "~labels/a: must be {x, y, yaw} or [x, y, yaw], not 3",
            "~names: ~interfaces has no entry tail; its entries are ",
            "~server, ~timeout, ~server_timeout, ~pause, ~retries and ~repeatable need",
            "~server: must be the name of an actionlib server, of letters, digits, _ and /, not 3",
            "~timeout: must be a number of at least 0",
            "~interfaces: pickup.timeout: must be a number of at least 0",
            "~interfaces: pickup.goal.pack: rosoclingo/PickupGoal has no such field; it has package",
            "~interfaces: leg.type: no action nowhere/NoAction",
        )
        faults = str(caught.exception).splitlines()
        self.assertEqual(len(faults), len(beginnings), faults)
        for fault, beginning in zip(sorted(faults), sorted(beginnings)):
            self.assertTrue(fault.startswith(beginning), fault)

    def test_interface_that_ends_says_so(self):
        core = CoreSide()
        server = Server("elsewhere", TestAction)
        entry = "_interfaces:={arm: {type: actionlib/TestAction, goal: {goal: $parameter}}}"
        with Process(executable("interface"), "__name:=mortal_interface", entry, "_server:=elsewhere") as node:
            core.wait_for("mortal_interface")
            core.send("arm", "_action_lib(arm,3,1)")
            server.accept()
            node.signal(signal.SIGINT)
            self.assertEqual(core.receive(), ["_return(arm,interface_lost,1)"])
            server.cancelled()
            self.assertEqual(node.wait()[0], 0)
