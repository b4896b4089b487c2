"""The core is killed, also while its journal cannot be written: it resumes, or reports that it cannot."""

import re
import unittest
from pathlib import Path

import rospy
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, ManualInterfaces
from diagnostic_msgs.msg import DiagnosticStatus
from full_disk import room_for
from interface_helpers import (
    PATIENCE,
    heard_log,
    kill,
    process_of,
    wait_for_diagnosis,
    wait_until,
)
from rosoclingo.msg import GoalStates, State

NODE = "/rosoclingo"


def warns(words):
    return lambda one: one.level == DiagnosticStatus.WARN and re.search(words, one.message)


class CoreKilled(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.journal = Path(rospy.myargv()[2]) / "journal.db"
        cls.stale = Path(f"{cls.journal}.stale")
        cls.said = heard_log(NODE)
        cls.hands, cls.client = ManualInterfaces(), Client()

    def setUp(self):
        self.hands.connect()
        self.hands.at_once = False
        self.hands.clear()
        self.said.clear()

    def begin(self, text):
        """Send a goal and wait for its first action."""
        goal = self.client.send(text)
        wait_until(goal.has_arrived, "the goal to arrive")
        return goal, self.hands.take()

    def kill(self):
        """Kill the core and wait for the next one; return the earlier runs."""
        runs = set(self.hands.runs)
        kill(NODE)
        return runs

    def answer_until(self, command, condition):
        """Answer a command repeatedly, since a new core is perhaps not yet connected."""
        self.hands.at_once = True
        wait_until(lambda: self.hands.succeed(command) or condition(), "the goal to end")

    def test_resumed_core_publishes_its_beliefs_at_once(self):
        goal, command = self.begin("do(walk,20)")
        before = rospy.wait_for_message("rosoclingo/state", State, PATIENCE)
        self.kill()
        states, goals = [], []
        topics = [("state", State, states.append), ("goals", GoalStates, lambda one: goals.extend(one.goals))]
        for topic, kind, note in topics:
            subscriber = rospy.Subscriber(f"rosoclingo/{topic}", kind, note)
            self.addCleanup(subscriber.unregister)
        wait_until(lambda: states and goals, "state and goals of the core that goes on")
        self.assertEqual((states[0].cycle, states[0].atoms), (before.cycle, before.atoms))
        first = next(one for one in list(goals) if one.request == goal.text)
        self.assertIn(first.status, (GoalStatus.PENDING, GoalStatus.ACTIVE))
        self.answer_until(command, lambda: CommState.DONE in goal.states)
        goal.ends_as(GoalStatus.SUCCEEDED)

    def test_late_client_receives_the_result_too(self):
        """A resumed core can meet a goal before the client's connection for results exists again."""
        raw = self.client.raw
        goal, command = self.begin("do(quick,10)")
        raw.result_sub.unregister()
        self.kill()
        self.answer_until(command, lambda: goal.handle.get_goal_status() == GoalStatus.SUCCEEDED)
        raw.result_sub = rospy.Subscriber(raw.ns + "/result", raw.ActionResult, raw._result_cb)
        self.assertEqual(goal.wait()[0], GoalStatus.SUCCEEDED)

    def test_action_is_sent_again_to_an_interface_that_announces_itself_over_a_new_connection(self):
        """Its return can be lost with the former connection, also while a new core already sends over another."""
        goal, command = self.begin("do(walk,30)")
        self.kill()
        self.assertEqual(self.hands.take(), command, "a new core sends it at once")
        sent = self.hands.seen.count
        for times in (3, 4):
            wait_until(lambda n=times: self.hands.tell(origin="walk") or sent(command) == n, "it again")
            self.hands.renew_publisher()
        self.hands.succeed(command)
        goal.ends_as(GoalStatus.SUCCEEDED)

    def wait_for_trouble(self):
        wait_for_diagnosis(
            "rosoclingo: core", warns(f"the journal {self.journal} cannot be written: disk I/O error"), "the trouble"
        )

    def test_full_disk_stops_neither_robot_nor_later_journal(self):
        with room_for(0, process_of(NODE)):
            first, command = self.begin("do(walk,1)")
            self.wait_for_trouble()
            self.assertTrue(self.stale.exists())
            self.assertFalse(self.journal.exists())
            self.hands.succeed(command)
            first.ends_as(GoalStatus.SUCCEEDED)
            second, command = self.begin("do(walk,2)")
        wait_until(self.journal.exists, "the journal to be written again, though nothing happens")
        wait_for_diagnosis("rosoclingo: core", lambda one: one.level == DiagnosticStatus.OK, "the end of the trouble")
        wait_until(lambda: any("the journal is written again" in line for line in list(self.said)), "word of it")
        runs = self.kill()
        self.assertEqual(self.hands.take(), command)
        self.answer_until(command, lambda: CommState.DONE in second.states)
        second.ends_as(GoalStatus.SUCCEEDED)
        self.assertEqual(set(self.hands.runs), runs)

    def test_core_killed_on_full_disk_begins_a_new_run(self):
        with room_for(0, process_of(NODE)):
            lost, _ = self.begin("do(walk,3)")
            self.wait_for_trouble()
            runs = self.kill()
        wait_until(lambda: set(self.hands.runs) - runs, "another run")
        wait_until(
            lambda: any(f"the disk failed before {self.stale} was complete" in line for line in list(self.said)),
            "a warning",
        )
        self.assertEqual(lost.wait()[0], GoalStatus.LOST)
        goal, command = self.begin("do(walk,4)")
        self.answer_until(command, lambda: CommState.DONE in goal.states)
        goal.ends_as(GoalStatus.SUCCEEDED)
