#!/usr/bin/env python3
"""Three robots, goals, random cancels, and a robot that dies: nobody collides, and each goal ends truly.

ROSOCLINGO_SEED chooses other goals and durations, ROSOCLINGO_GOALS their number.
"""

import os
import random
import sys
import threading
import unittest
from collections import Counter
from pathlib import Path

import rostest
from actionlib.action_server import ActionServer
from actionlib_msgs.msg import GoalStatus
from move_base_msgs.msg import MoveBaseAction
from rosoclingo.msg import DeliverAction, PickupAction

HERE = Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[1]), str(HERE.parents[3] / "bench")]

from core_helpers import Client  # noqa: E402
from deliveries import Floor, Request  # noqa: E402
from fleet_world import FleetWorld  # noqa: E402
from interface_helpers import PATIENCE, init_node, wait_until  # noqa: E402
from planning_domains import RuleError  # noqa: E402

SEED, GOALS = (int(os.environ.get(f"ROSOCLINGO_{name}", usual)) for name, usual in (("SEED", "1"), ("GOALS", "8")))
ROWS = [(one, one + 1) for one in (1, 2, 3, 4, 6, 7, 8, 9)]
LADDER = Floor("ladder", 10, frozenset([*ROWS, *((one, one + 5) for one in range(1, 6))]))
STARTS = {"r1": 1, "r2": 5, "r3": 8}
KINDS = {"move_base": MoveBaseAction, "pickup": PickupAction, "deliver": DeliverAction}


class Robots:
    """The action servers of all robots: each action takes a random time, and a model watches them.

    Attributes:
        world: the model.
        faults: the actions that the model has refused.
        begun: how often each action on a package has begun.

    """

    def __init__(self, source):
        self.world, self.faults, self.begun = FleetWorld(LADDER, STARTS), [], Counter()
        self._source, self._lock, self._dead = source, threading.RLock(), set()
        self._servers = {robot: [self._serve(robot, verb) for verb in KINDS] for robot in STARTS}

    def _serve(self, robot, verb):
        server = ActionServer(
            f"{robot}/{verb}",
            KINDS[verb],
            lambda handle: self._begin(robot, verb, handle),
            self._ignore,
            auto_start=False,
        )
        server.start()
        return server

    @staticmethod
    def _ignore(_handle):
        """Complete a cancelled action nevertheless."""

    def _begin(self, robot, verb, handle):
        goal = handle.get_goal()
        what = round(goal.target_pose.pose.position.x) if verb == "move_base" else int(goal.package)
        with self._lock:
            if robot in self._dead:
                return
            handle.set_accepted()
            try:
                self.world.begin(robot, verb, what)
            except RuleError as error:
                self.faults.append(str(error))
            self.begun[verb, what] += verb != "move_base"
            timer = threading.Timer(self._source.uniform(0.02, 0.3), self._end, [robot, handle])
            timer.daemon = True
            timer.start()

    def _end(self, robot, handle):
        with self._lock:
            if robot not in self._dead and handle.get_goal_status().status in (
                GoalStatus.ACTIVE,
                GoalStatus.PREEMPTING,
            ):
                if robot in self.world.acts:
                    self.world.end(robot)
                handle.set_succeeded()

    def ask(self, request):
        """Put a package on the floor."""
        with self._lock:
            self.world.ask([request])

    def kill(self, robot):
        """Let a robot die: it moves no more, and its servers vanish. Return its load and its places."""
        with self._lock:
            self._dead.add(robot)
            load = set(self.world.load[robot])
            places = {office for office in range(1, 11) if robot in self.world.holders(office)}
        for server in self._servers[robot]:
            server.publish_status = lambda: None  # its timer goes on
            for one in (server.goal_sub, server.cancel_sub, server.status_pub, server.result_pub, server.feedback_pub):
                one.unregister()
        return load, places


class FleetTest(unittest.TestCase):
    def setUp(self):
        self.source = random.Random(SEED)
        self.robots, self.client = Robots(random.Random(SEED + 1)), Client()
        self.goals, self.cancelled = {}, set()

    def test_fleet_survives_the_death_of_a_robot(self):
        for number in range(1, GOALS + 1):
            self.send(number)
            if number == GOALS // 2:
                wait_until(lambda: self.robots.world.load["r3"], "r3 to have a load")
                load, places = self.robots.kill("r3")
            done = len(self.robots.begun)
            if number > 6:
                wait_until(lambda done=done: len(self.robots.begun) > done or not self.open(), "the fleet to go on")
        for number, (goal, request) in self.goals.items():
            status, result = goal.wait(2 * PATIENCE)
            self.check(number, request, status, result, load, places)
        self.assertEqual(self.robots.faults, [])
        self.assertEqual({what: count for what, count in self.robots.begun.items() if count > 1}, {})

    def open(self):
        """Return the goals that have not ended."""
        return [goal for goal, _ in self.goals.values() if not goal._done.is_set()]

    def send(self, number):
        """Send a goal, and perhaps cancel an earlier one whose package still waits."""
        request = Request(number, *self.source.sample(range(1, 11), 2))
        self.robots.ask(request)
        self.goals[number] = self.client.send(request.goal), request
        if self.source.random() < 0.2:
            other = self.source.randint(1, number)
            self.cancelled.add(other)
            self.robots.world.allow_return(other)
            self.goals[other][0].cancel()

    def check(self, number, request, status, result, load, places):
        """Check that a goal has ended truly; those of packages on the dead robot, or at its place, are aborted."""
        text = f"{request}: {result.message}"
        delivered = number in self.robots.world.delivered
        if status == GoalStatus.SUCCEEDED:
            self.assertTrue(delivered, text)
        elif status == GoalStatus.ABORTED:
            self.assertTrue(number in load or places & {request.start, request.end}, text)
        else:
            self.assertIn(number, self.cancelled, text)
            self.assertFalse(
                any(number in load for load in self.robots.world.load.values()) and number not in load, text
            )


if __name__ == "__main__":
    init_node("fleet_test")
    rostest.rosrun("rosoclingo", "fleet", FleetTest, sys.argv)
