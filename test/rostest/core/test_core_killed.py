#!/usr/bin/env python3
"""The core is killed at any time: each goal ends once with a true status, and nothing is done twice.

ROSOCLINGO_SEED chooses other goals and instants, ROSOCLINGO_KILLS how many there are.
"""

import os
import random
import signal
import sys
import threading
import unittest
from collections import Counter
from pathlib import Path

import rosgraph
import rospy
import rostest
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus
from rosoclingo.msg import GoalStates, InterfaceIO, State

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.keywords import CORE

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client
from interface_helpers import PATIENCE, init_node, process_of, wait_until

SEED, KILLS = (int(os.environ.get(f"ROSOCLINGO_{name}", usual)) for name, usual in (("SEED", "1"), ("KILLS", "10")))
SUCCEEDED, RECALLED, PREEMPTED = GoalStatus.SUCCEEDED, GoalStatus.RECALLED, GoalStatus.PREEMPTED


class World:
    """The interface layer, and what was done: an action that is known is not done again, its answer is told again."""

    def __init__(self, source):
        self._source = source
        self._lock = threading.Lock()
        self._answers = {}  # command -> its answer, None while it is under way
        self._latest = 0
        self.done, self.runs, self.waits = Counter(), set(), False
        self._publisher = rospy.Publisher("in_rosoclingo", InterfaceIO, queue_size=100)
        self._subscriber = rospy.Subscriber("out_rosoclingo", InterfaceIO, self._note)
        self._timer = rospy.Timer(rospy.Duration(0.1), lambda _: self._tell_again())

    def close(self):
        """Answer no more."""
        self._timer.shutdown()
        self._subscriber.unregister()
        self._publisher.unregister()

    @property
    def under_way(self):
        """Commands that were not answered."""
        with self._lock:
            return [command for command, answer in self._answers.items() if answer is None]

    def _note(self, message):
        if message.interface == CORE:
            self.runs.update(message.facts)
            return
        with self._lock:
            for command in message.facts:
                self._latest = max(self._latest, parse_atom(command).arguments[2].number)
                self._answers.setdefault(command, None)
        if not self.waits:
            self.answer()

    def answer(self):
        """End what is under way."""
        with self._lock:
            for command in [command for command, answer in self._answers.items() if answer is None]:
                what, number, cycle = parse_atom(command).arguments
                good = str(what) == "quick" or self._source.random() < 0.8
                self.done[f"do({what},{number})"] += good
                self._answers[command] = f"_return({what},{number if good else 'failed'},{cycle})"
        self._tell_again()

    def _tell_again(self):
        """Tell the answers of the last cycle, which may not have been heard."""
        with self._lock:
            last = [
                answer
                for command, answer in self._answers.items()
                if answer is not None and parse_atom(command).arguments[2].number == self._latest
            ]
        if last:
            self._publisher.publish(InterfaceIO("world", last))


class CoreKilled(unittest.TestCase):
    def setUp(self):
        self.source = random.Random(SEED)
        self.world, self.client, self.goals = World(self.source), Client(), []
        self.cancelled, self.killed = set(), set()
        self.addCleanup(self.world.close)

    @staticmethod
    def pid():
        """The process that is the core now, None where there is none."""
        try:
            return process_of("/rosoclingo")
        except (rosgraph.MasterException, OSError):
            return None

    def kill(self):
        """Kill the core and wait for the next one."""
        wait_until(lambda: self.pid() not in {None, *self.killed}, "a core")
        pid = self.pid()
        self.killed.add(pid)
        os.kill(pid, signal.SIGKILL)

    def wait_for_core(self):
        """Wait until a core that lives hears and is heard."""
        wait_until(lambda: self.pid() not in {None, *self.killed}, "the next core")
        wait_until(lambda: self.is_there(), "the next core to be connected")

    def is_there(self):
        """Whether the core has the goals that were sent; those that it has lost before it told of them come again."""
        return not [goal for goal in self.goals if not goal.has_arrived()]  # each is looked at

    def send(self, *kinds):
        """Send a goal of each kind."""
        for kind in kinds:
            self.goals.append(self.client.send(f"do({kind},{len(self.goals) + 1})"))

    def kinds(self, most):
        """Some kinds of goals."""
        return [self.source.choice(("walk", "run", "quick")) for _ in range(self.source.randint(1, most))]

    def cancel_one(self):
        """Cancel any goal that has not ended."""
        live = [one for one in self.goals if one.handle.get_comm_state() in (CommState.PENDING, CommState.ACTIVE)]
        if live:
            goal = self.source.choice(live)
            self.cancelled.add(goal.text)
            goal.cancel()

    def test_a_core_that_goes_on_tells_at_once_what_it_believes(self):
        self.world.waits, text = True, "do(walk,2000)"
        self.client.raw.wait_for_server()
        self.goals.append(self.client.send(text))
        wait_until(lambda: self.world.under_way, "an action")
        before = rospy.wait_for_message("rosoclingo/state", State, PATIENCE)
        self.kill()
        wait_until(lambda: self.pid() not in {None, *self.killed}, "the next core")
        states, goals = [], []
        subscribers = [
            rospy.Subscriber("rosoclingo/state", State, states.append),
            rospy.Subscriber("rosoclingo/goals", GoalStates, lambda message: goals.extend(message.goals)),
        ]
        wait_until(lambda: states and goals, "state and goals of the core that goes on")
        self.assertEqual((states[0].cycle, states[0].atoms), (before.cycle, before.atoms))
        self.assertEqual(goals[0].request, text)
        self.assertIn(goals[0].status, (GoalStatus.PENDING, GoalStatus.ACTIVE))
        for one in subscribers:
            one.unregister()
        self.world.waits = False
        self.world.answer()
        self.check(self.goals[0])

    def test_killed_again_and_again(self):
        self.client.raw.wait_for_server()
        for number in range(KILLS):
            self.world.waits = self.source.random() < 0.5
            self.send(*self.kinds(3))
            self.instant(number)
            self.kill()
            self.wait_for_core()
            self.world.waits = False
            self.world.answer()
        wait_until(self.is_there, "the last goals to arrive")
        for goal in self.goals:
            self.check(goal)
        self.assertEqual(len(self.world.runs), 1, "a core that goes on is of the same run")

    def test_a_client_that_connects_late_has_the_result_too(self):
        """A core that goes on may have met a goal before the client's connection for results is there again."""
        raw = self.client.raw
        self.world.waits = True
        goal = self.client.send("do(quick,1000)")
        self.goals.append(goal)
        wait_until(lambda: self.world.under_way, "an action")
        raw.result_sub.unregister()
        self.kill()
        self.wait_for_core()
        self.world.waits = False
        self.world.answer()
        wait_until(lambda: goal.handle.get_goal_status() == SUCCEEDED, "the goal to be met")
        raw.result_sub = rospy.Subscriber(raw.ns + "/result", raw.ActionResult, raw._result_cb)
        self.assertEqual(goal.wait()[0], SUCCEEDED)

    def instant(self, number):
        """Wait for one of the instants at which the core is killed."""
        if number % 4 == 0:  # an action goes out
            self.world.waits = True
            wait_until(lambda: self.world.under_way, "an action")
            if self.source.random() < 0.5:
                self.world.answer()
        elif number % 4 == 1:  # the goals are known
            wait_until(self.is_there, "the goals to arrive")
            self.cancel_one()
        elif number % 4 == 2:  # a goal ends
            self.world.waits = False
            self.world.answer()
            wait_until(self.is_there, "the goals to arrive")
            self.goals[-1].wait()
        elif self.source.random() < 0.5:  # at once
            self.cancel_one()

    def check(self, goal):
        """A goal ends once, as the world has it."""
        status, _ = goal.wait(PATIENCE * 2)
        done = self.world.done[goal.text]
        self.assertEqual(goal.states.count(CommState.DONE), 1)
        if goal.text in self.cancelled:
            self.assertIn(status, (SUCCEEDED, PREEMPTED, RECALLED))
        else:
            self.assertEqual(status, SUCCEEDED, goal.text)
        self.assertLessEqual(done, 1, goal.text)
        self.assertTrue(done or status != SUCCEEDED, goal.text)
        self.assertTrue(not done or status != RECALLED, goal.text)


if __name__ == "__main__":
    init_node("core_killed_test")
    rostest.rosrun("rosoclingo", "core_killed", CoreKilled, sys.argv)
