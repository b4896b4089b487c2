#!/usr/bin/env python3
"""Interfaces by configuration: goals filled, ends answered, time-outs, retries, servers that are absent or die."""

import signal
import sys
import threading
import unittest
from pathlib import Path
from unittest import mock

import rospy
import rostest
from actionlib.msg import (
    TestAction,
    TestActionGoal,
    TestActionResult,
    TestGoal,
    TestRequestAction,
    TestRequestResult,
    TestResult,
    TwoIntsAction,
    TwoIntsGoal,
    TwoIntsResult,
)
from actionlib_msgs.msg import GoalID, GoalStatusArray
from clingo import Function, Number, String
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rosgraph_msgs.msg import Log
from rospy.topics import _PublisherImpl

from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.answers import Answer
from rosoclingo.interfaces.attempt import ActionLimits
from rosoclingo.interfaces.base import Interface, RefusalError
from rosoclingo.interfaces.config import ConfigError
from rosoclingo.interfaces.hosting import InterfacesNode

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import PATIENCE, CoreSide, Process, Server, executable, init_node, wait_to_hear, wait_until

MORTAL = str(Path(__file__).resolve().parent / "mortal_server.py")


class ConfiguredInterfaces(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("core_side")
        cls.core = CoreSide()
        cls.oracle = Server("oracle", TestRequestAction)
        cls.count = Server("count", TestAction)
        cls.hasty = Server("hasty", TestAction)
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

    def test_rules_match_result_and_text(self):
        self.core.send("ask", "_action_lib(ask,q(1,a,false,0),2)")
        self.oracle.accept().set_aborted(TestRequestResult(the_result=7), "No Term")
        self.assertEqual(self.core.receive(), ['_return(ask,"No Term",2)'])
        self.core.send("ask", "_action_lib(ask,q(1,a,false,0),2)")
        self.oracle.accept().set_aborted(TestRequestResult(the_result=8), "No Term")
        self.assertEqual(self.core.receive(), ["_return(ask,failed,2)"])

    def test_fact_that_is_no_atom_is_left_out(self):
        self.core.send("ask", "_action_lib(ask,q(1,a,false,0),2)")
        self.oracle.accept().set_succeeded(TestRequestResult(the_result=1), "No Atom")
        self.assertEqual(self.core.receive(), ["said(1,2)", "_return(ask,answer(1),2)"])

    def test_unsuitable_parameters_are_refused(self):
        for parameter in ("q(1,a,false)", "q(much,a,false,0)", "q(1,a,perhaps,0)", 'q(1,a,false,"1e300")', "alone"):
            self.assertEqual(
                self.core.run("ask", f"_action_lib(ask,{parameter},2)"), ["_return(ask,bad_parameter,2)"], parameter
            )

    def test_failed_goal_is_sent_again(self):
        self.core.send("count", "_action_lib(count,5,1)")
        self.count.accept().set_aborted()
        self.count.accept().set_aborted()
        self.count.accept().set_succeeded()
        self.assertEqual(self.core.receive(), ["_return(count,5,1)"])

    def test_retries_are_limited(self):
        self.core.send("count", "_action_lib(count,5,1)")
        for _ in range(3):
            self.count.accept().set_aborted()
        self.assertEqual(self.core.receive(), ["_return(count,failed,1)"])

    def test_other_reasons_are_not_retried(self):
        self.core.send("count", "_action_lib(count,5,1)")
        self.count.take().set_rejected()
        self.assertEqual(self.core.receive(), ["_return(count,rejected,1)"])

    def test_timeout_cancels_the_goal(self):
        self.core.send("hasty", "_action_lib(hasty,a,1)")
        self.hasty.accept()
        self.hasty.cancelled().set_canceled()
        self.assertEqual(self.core.receive(), ["_return(hasty,timeout,1)"])

    def test_timeout_of_server_that_ignores_the_cancel(self):
        self.core.send("hasty", "_action_lib(hasty,a,2)")
        handle = self.hasty.accept()
        self.hasty.cancelled()
        self.assertEqual(self.core.receive(), ["_return(hasty,server_lost,2)"])
        self.assertTrue(self.hasty.idle(), "it is not sent again to a server that still has it")
        handle.set_succeeded()  # too late: it must be ignored
        self.assertEqual(self.core.run("absent", "_action_lib(absent,a,3)"), ["_return(absent,server_lost,3)"])

    def test_reason_is_no_success_despite_equal_parameter(self):
        ends = (
            (lambda goal: goal.set_rejected(), "rejected", "failed(rejected)"),
            (lambda goal: goal.set_rejected(), '"rejected"', "rejected"),
            (lambda goal: goal.set_aborted(None, "as told"), "left", "failed(left)"),
            (lambda goal: goal.set_aborted(None, "by name: left"), '"by name: left"', 'failed("by name: left")'),
            (lambda goal: goal.set_succeeded(TestResult(1)), "missed", "failed(missed)"),
            (lambda goal: goal.set_succeeded(TestResult(2)), "missed", "missed"),
            (lambda goal: goal.set_succeeded(TestResult(1)), "left", "missed"),
        )
        for cycle, (end, parameter, value) in enumerate(ends, 10):
            self.core.send("belt", f"_action_lib(belt,{parameter},{cycle})")
            end(self.count.take() if "rejected" in parameter else self.count.accept())
            self.assertEqual(self.core.receive(), [f"_return(belt,{value},{cycle})"])
        self.core.send("belt", "_action_lib(belt,failed,1)")
        for _ in range(2):  # it is retried because of its reason
            self.count.accept().set_aborted()
        self.assertEqual(self.core.receive(), ["_return(belt,failed(failed),1)"])

    def test_reason_is_no_success_of_concurrent_action(self):
        self.core.send("belt", "_action_lib(belt,right,7)", "_action_lib(belt,rejected,7)")
        right, rejected = self.count.take(), self.count.accept()
        rejected.set_succeeded(TestResult(2))
        self.assertEqual(self.core.receive(), ["_return(belt,rejected,7)"])
        right.set_rejected()
        self.assertEqual(self.core.receive(), ["_return(belt,failed(rejected,right),7)"])

    def test_entry_can_treat_an_end_as_success(self):
        self.core.send("ask", "_action_lib(ask,q(1,a,false,0),2)")
        self.oracle.accept().set_aborted(TestRequestResult(the_result=9), "it was there already")
        self.assertEqual(self.core.receive(), ["_return(ask,q(1,a,false,0),2)"])

    def test_server_words_of_any_kind_in_a_fact(self):
        words = 'two "words", a\\b\nc ä'
        self.core.send("ask", "_action_lib(ask,q(1,a,false,0),2)")
        goal = self.oracle.accept()
        self.core.send("ask", "_cancel(ask,q(1,a,false,0),2)")
        self.oracle.cancelled()
        goal.set_canceled(None, words)
        self.assertEqual(self.core.receive(), [f"heard({String(words)},now)", "_return(ask,preempted,2)"])

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

    def test_ignored_cancel_is_no_preemption(self):
        self.core.send("deaf", "_action_lib(deaf,a,1)")
        self.count.accept()
        self.core.send("deaf", "_cancel(deaf,a,1)")
        self.count.cancelled()
        self.assertEqual(self.core.receive(), ["_return(deaf,server_lost,1)"])
        self.assertTrue(self.count.idle(), "it is not sent again: nobody wants it")

    def test_absent_server_fails_the_action(self):
        self.assertEqual(self.core.run("absent", "_action_lib(absent,a,1)"), ["_return(absent,server_lost,1)"])
        self.core.send("absent", "_action_lib(absent,a,2)", "_cancel(absent,a,2)")
        self.assertEqual(self.core.receive(), ["_return(absent,preempted,2)"])

    def test_goal_waits_until_its_result_can_be_received(self):
        """rospy counts a connection at its reading end first: results sent before the server knows it are lost."""
        counts, add, lines = threading.Event(), _PublisherImpl.add_connection, []

        def late(topic, connection):
            if topic.name == "/late/result":
                counts.wait(PATIENCE)
            return add(topic, connection)

        wait_to_hear(rospy.Subscriber("/rosout", Log, lambda one: lines.append(one.msg)), nodes=["interface"])
        with mock.patch.object(_PublisherImpl, "add_connection", late):
            server = Server("late", TestAction)
            self.core.send("late", "_action_lib(late,a,1)")
            wait_until(lambda: any("late: waiting for the action server late" in one for one in lines), "that it waits")
            counts.set()
            server.take().set_rejected()
            self.assertEqual(self.core.receive(), ["_return(late,rejected,1)"])

    def test_server_that_never_acknowledges_fails_the_action(self):
        goals, cancels = [], []
        topics = [
            rospy.Publisher("mute/status", GoalStatusArray, queue_size=1),
            rospy.Publisher("mute/result", TestActionResult, queue_size=1),
            rospy.Subscriber("mute/goal", TestActionGoal, goals.append),
            rospy.Subscriber("mute/cancel", GoalID, cancels.append),
        ]
        wait_until(lambda: all(topic.get_num_connections() for topic in topics[:2]), "the interface to listen")
        wait_to_hear(*topics[2:])
        self.assertEqual(self.core.run("mute", "_action_lib(mute,a,1)"), ["_return(mute,server_lost,1)"])
        self.core.send("mute", "_action_lib(mute,a,2)", "_cancel(mute,a,2)")
        wait_until(lambda: goals[1:] and cancels and cancels[-1].id == goals[-1].goal_id.id, "goal and cancel")
        topics[0].publish(GoalStatusArray())  # does not report the goal, which is not lost for that reason
        self.assertEqual(self.core.receive(), ["_return(mute,server_lost,2)"])

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


class Reports:
    """The interfaces' reports on /diagnostics."""

    def __init__(self):
        self._found = []
        wait_to_hear(rospy.Subscriber("/diagnostics", DiagnosticArray, lambda one: self._found.extend(one.status)))

    def wait_for(self, name, condition):
        """Return the first report of an interface that meets the condition, with its values as a dict."""
        found = []

        def look():
            for status in list(self._found):
                values = {pair.key: pair.value for pair in status.values}
                if status.name == f"rosoclingo: interface {name}" and condition(status, values):
                    found.append((status, values))
            return found

        wait_until(look, f"a report of {name}")
        return found[0]


class SubclassedInterface(unittest.TestCase):
    def test_subclass_computes_goal_and_answer(self):
        core, server, worker = CoreSide(), Server("adder", TwoIntsAction), Worker()
        SumInterface("sum", TwoIntsAction, "adder", worker=worker)
        worker.start()
        core.wait_for(rospy.get_name())
        core.send("sum", "_action_lib(sum,two(3,4),1)")
        goal = server.accept()
        goal.set_succeeded(TwoIntsResult(goal.get_goal().a + goal.get_goal().b))
        self.assertEqual(core.receive(), ["calculated", "_return(sum,7,1)"])
        core.send("sum", "_action_lib(sum,two(3,4),2)")
        server.accept().set_aborted()
        self.assertEqual(core.receive(), ["_return(sum,no_sum,2)"])
        core.send("sum", "_action_lib(sum,two(3,4),3)")
        server.take().set_rejected()
        self.assertEqual(core.receive(), ["_return(sum,rejected,3)"])
        # refused, and faults of the subclass itself
        self.assertEqual(core.run("sum", "_action_lib(sum,nothing,4)"), ["_return(sum,no_numbers,4)"])
        self.assertEqual(core.run("sum", "_action_lib(sum,two(a,b),5)"), ["_return(sum,bad_parameter,5)"])
        self.assertEqual(core.run("sum", "_action_lib(sum,two(0,4),5)"), ["_return(sum,bad_parameter,5)"])
        core.send("sum", "_action_lib(sum,two(3,4),6)")
        server.accept().set_succeeded(TwoIntsResult(2**40))
        self.assertEqual(core.receive(), ["_return(sum,failed,6)"])
        core.send("sum", "_action_lib(sum,two(3,-3),7)")
        server.accept().set_succeeded(TwoIntsResult(0))
        self.assertEqual(core.receive(), ["_return(sum,failed,7)"])
        core.send("sum", "_action_lib(sum,two(3,4),8)")
        server.accept().set_succeeded(TwoIntsResult(7))
        self.assertEqual(core.receive(), ["calculated", "_return(sum,7,8)"])
        self.check_health()
        worker.stop()

    def check_health(self):
        reports = Reports()
        status, values = reports.wait_for("sum", lambda _, values: values["succeeded"] == "4")
        self.assertEqual((status.level, status.message), (DiagnosticStatus.OK, "idle"))
        self.assertEqual((values["server"], values["failed"], values["faults"]), ("adder", "5", "4"))
        self.assertIn("TypeError: make_answer returned None", values["last fault"])
        status, _ = reports.wait_for("absent", lambda *_: True)
        self.assertEqual((status.level, status.message), (DiagnosticStatus.WARN, "server absent is not connected"))

    def test_subclass_fault_affects_only_its_actions(self):
        core, server, worker, lines = CoreSide(), Server("trader", TwoIntsAction), Worker(), []
        log = rospy.Subscriber("/rosout", Log, lambda one: lines.append(one.msg), queue_size=1000)
        SumInterface("odd", TwoIntsAction, "trader", ActionLimits(timeout="soon"), worker=worker)
        SumInterface("trade", TwoIntsAction, "trader", worker=worker)
        worker.start()
        core.wait_for(rospy.get_name())
        reports = Reports()
        wait_to_hear(log)
        core.send("trade", "_action_lib(trade,two(3,4),1)")
        handle = server.accept()
        core.send("odd", "_action_lib(odd,two(1,1),1)", "_action_lib(odd,two(2,2),1)")
        odd = [server.accept() for _ in range(2)]
        self.assertEqual([core.receive(), core.receive()], [["_return(odd,failed,1)"]] * 2)
        for _ in odd:
            server.cancelled().set_canceled()
        status, _ = reports.wait_for("odd", lambda _, values: values["faults"] == "2")
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

    def test_names_must_be_a_list(self):
        rospy.set_param("~names", "pickup")
        with self.assertRaisesRegex(ConfigError, "~names: must be a list of interface names, not 'pickup'"):
            InterfacesNode()
        rospy.delete_param("~names")

    def test_faults_are_reported_all_at_once(self):
        rules = [{"when": {"outcome": "NOT_THERE"}, "return": "$result.y"}, {"stratus": "aborted"}]
        entries = {
            "pickup": {"type": "rosoclingo/PickupAction", "timeout": -1, "goal": {"pack": 1}, "returns": rules},
            "leg": {
                "type": "nowhere/NoAction",
                "done": {"topic": "packages", "type": "rosoclingo/PackageStates", "when": {"packages": {"idea": "$1"}}},
            },
            "head": {
                "type": "actionlib/TestAction",
                "goal": {"goal": "much"},
                "done": {"topic": "state", "type": "nowhere/Nothing", "when": {"data": 1}},
            },
        }
        parameters = {
            "interfaces": entries,
            "labels": {"a": 3},
            "names": ["pickup", "leg", "head", "tail"],
            "server": 3,
            "timeout": -1,
        }
        for name, value in parameters.items():
            rospy.set_param("~" + name, value)
        with self.assertRaises(ConfigError) as caught:
            InterfacesNode()
        for name in parameters:
            rospy.delete_param("~" + name)
        faults = str(caught.exception).splitlines()
        beginnings = (
            "~labels/a: must be {x, y, yaw} or [x, y, yaw], not 3",
            "~names: ~interfaces has no entry tail; its entries are ",
            "~server, ~timeout, ~server_timeout, ~pause, ~retries and ~repeatable need",
            "~server: must be the name of an actionlib server, not 3",
            "~timeout: must be a number of at least 0",
            "~interfaces: pickup.timeout: must be a number of at least 0",
            "~interfaces: pickup.returns[1]: unknown key 'stratus' (did you mean status?)",
            "~interfaces: pickup.goal.pack: rosoclingo/PickupGoal has no such field; it has package",
            "~interfaces: pickup.returns[0]: rosoclingo/PickupResult has no field y; it has outcome, message",
            "~interfaces: pickup.returns[0].when.outcome: rosoclingo/PickupResult has no constant NOT_THERE; its",
            "~interfaces: leg.type: no action nowhere/NoAction",
            "~interfaces: leg.done.when.packages.idea: rosoclingo/PackageState has no such field; it has id, location",
            "~interfaces: head.done.type: no message nowhere/Nothing",
            "~interfaces: head.goal.goal: needs int32, but much is not an integer",
        )
        for beginning in beginnings:
            self.assertEqual(len([fault for fault in faults if fault.startswith(beginning)]), 1, (beginning, faults))
        self.assertEqual(len(faults), len(beginnings), faults)

    def test_node_without_entries_does_not_start(self):
        with Process(executable("interface"), "__name:=empty", "_interfaces:={}") as node:
            code, error = node.wait()
        self.assertEqual(code, 1)
        self.assertIn("~interfaces: has no entries; write one for each action", error)

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


class Suite(unittest.TestSuite):
    def __init__(self):
        super().__init__()
        for case in (ConfiguredInterfaces, SubclassedInterface, InterfaceNode):
            self.addTests(unittest.defaultTestLoader.loadTestsFromTestCase(case))


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "configured_interfaces", "test_configured_interfaces.Suite", sys.argv)
