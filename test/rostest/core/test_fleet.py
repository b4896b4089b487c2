"""Three robots, goals, random cancels: one robot is lost for a while, one for good, and each goal ends truly.

ROSOCLINGO_SEED chooses other goals and durations, ROSOCLINGO_GOALS their number.
"""

import os
import random
import signal
import threading
import unittest
from collections import Counter
from contextlib import ExitStack

import rospy
from actionlib.action_server import ActionServer
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, Updates
from deliveries import Floor, Request
from fleet_world import FleetWorld
from interface_helpers import PATIENCE, Process, executable, wait_for_diagnosis, wait_until
from move_base_msgs.msg import MoveBaseAction
from planning_domains import RuleError
from rosoclingo.msg import DeliverAction, PickupAction

SEED, GOALS = (int(os.environ.get(f"ROSOCLINGO_{name}", usual)) for name, usual in (("SEED", "1"), ("GOALS", "30")))
OFFICES, COLUMNS = 12, 4
ROWS = [(one, one + 1) for one in range(1, OFFICES) if one % COLUMNS]
GRID = Floor("grid", OFFICES, frozenset([*ROWS, *((one, one + COLUMNS) for one in range(1, OFFICES - COLUMNS + 1))]))
STARTS = {"r1": 1, "r2": 4, "r3": 10}
KINDS = {"move_base": MoveBaseAction, "pickup": PickupAction, "deliver": DeliverAction}

#: Greatest number of goals that are open at the same time.
MOST_OPEN = 6


class Robots:
    """The action servers of all robots: each action takes a random time, and a model watches them.

    Attributes:
        world: the model.
        faults: the actions that the model has refused.
        begun: how often each action on a package has begun.
        struck: the robots that an accident has met.
        barred: the offices that a robot has held since its accident.

    """

    def __init__(self, source):
        self.world, self.faults, self.begun = FleetWorld(GRID, STARTS), [], Counter()
        self.struck, self.barred = [], set()
        self._source, self._lock, self._dead, self._accident = source, threading.RLock(), set(), None
        self._servers = [self._serve(robot, verb) for robot in STARTS for verb in KINDS]

    def _serve(self, robot, verb):
        def begin(handle):
            self._begin(robot, verb, handle)

        def complete_nevertheless(_handle):
            pass

        server = ActionServer(f"/{robot}/{verb}", KINDS[verb], begin, complete_nevertheless, auto_start=False)
        server.start()
        return server

    def _begin(self, robot, verb, handle):
        goal = handle.get_goal()
        what = round(goal.target_pose.pose.position.x) if verb == "move_base" else int(goal.package)
        with self._lock:
            handle.set_accepted()
            try:
                self.world.begin(robot, verb, what)
            except RuleError as error:
                self.faults.append(str(error))
                handle.set_aborted()
                return
            self.begun[verb, what] += verb != "move_base"
            if self._accident and self.world.load[robot]:
                self._accident(robot)
            if robot in self.struck:
                self.barred |= {office for office in range(1, OFFICES + 1) if robot in self.world.holders(office)}
            timer = threading.Timer(self._source.uniform(0.02, 0.2), self._end, [robot, handle])
            timer.daemon = True
            timer.start()

    def _end(self, robot, handle):
        with self._lock:
            if robot not in self._dead:
                self.world.end(robot)
                handle.set_succeeded()

    def ask(self, request):
        """Put a package on the floor."""
        with self._lock:
            self.world.ask([request])

    def strike_next(self, kill):
        """Let an accident meet the next robot that begins to act with a load; with ``kill``, it never moves again."""

        def strike(robot):
            self.struck.append(robot)
            if kill:
                self._dead.add(robot)
            self._accident = None

        with self._lock:
            self._accident = strike

    def recover(self):
        """Let all robots act as before."""
        with self._lock:
            self.struck.clear()


class FleetTest(unittest.TestCase):
    def setUp(self):
        self.source = random.Random(SEED)
        self.robots, self.client, self.updates = Robots(random.Random(SEED + 1)), Client(), Updates()
        self.goals, self.cancelled, self.lost = {}, set(), set()
        self.stack = ExitStack()
        self.addCleanup(self.stack.close)
        self.interfaces = {robot: self.stack.enter_context(self.interface(robot)) for robot in STARTS}
        known = [f"{verb}({robot})" for robot in STARTS for verb in KINDS]
        wait_for_diagnosis(
            "rosoclingo: core", lambda one: all(name in str(one.values) for name in known), "the interfaces"
        )

    def interface(self, robot):
        """Return the process with the interfaces of a robot."""
        for name in ("labels", "interfaces"):
            rospy.set_param(f"/interfaces_{robot}/{name}", rospy.get_param(f"~{name}"))
        rospy.set_param(f"/interfaces_{robot}/values", {"R": [robot]})
        return Process(executable("interface"), f"__name:=interfaces_{robot}", "_memory:=''")

    def test_fleet_survives_the_loss_of_robots(self):
        for number in range(1, GOALS + 1):
            if number == GOALS // 3:
                robot, _ = self.lose(number)
                self.robots.recover()
                self.interfaces[robot].signal(signal.SIGCONT)
                self.updates.wait_for(f"_back({robot},")
            elif number == 2 * GOALS // 3:
                robot, known = self.lose(number, kill=True)
                self.wait_for_update(f"({robot}),lost,", known)
            else:
                self.send(number)
                self.perhaps_cancel(number)
            wait_until(lambda: len(self.open()) < MOST_OPEN, "goals to end")
        wait_until(self.serves_another, "the rest of the fleet to serve a goal")
        for number, (goal, request) in self.goals.items():
            self.check(number, request, *goal.wait(PATIENCE))
        self.assertEqual(self.robots.faults, [])
        self.assertEqual({what: count for what, count in self.robots.begun.items() if count > 1}, {})

    def open(self):
        """Return the goals that have not ended."""
        return [number for number, (goal, _) in self.goals.items() if not goal.has_ended]

    def send(self, number, offices=range(1, OFFICES + 1)):
        """Send a goal between two of these offices."""
        request = Request(number, *self.source.sample(offices, 2))
        self.robots.ask(request)
        if self.robots.barred:  # it can become unreachable with its package on board
            self.robots.world.allow_return(number)
        self.goals[number] = self.client.send(request.goal), request

    def perhaps_cancel(self, number):
        """Cancel an open goal, perhaps the one with this number, or none."""
        if self.source.random() < 0.2:
            other = self.source.choice(self.open() or [number])
            self.cancelled.add(other)
            self.robots.world.allow_return(other)
            self.goals[other][0].cancel()

    def lose(self, number, kill=False):
        """Send a goal, suspend the interfaces of a robot that acts with a load, and wait until the core has lost it.

        Return the robot, and the number of updates before the loss.
        """
        self.robots.strike_next(kill)
        self.send(number)
        wait_until(lambda: self.robots.struck, "a robot to act with a load")
        robot, known = self.robots.struck[0], len(self.updates.texts)
        for one in self.goals:
            self.robots.world.allow_return(one)
        self.interfaces[robot].signal(signal.SIGSTOP)
        self.wait_for_update(f"_lost({robot},", known)
        self.lost.add(robot)
        return robot, known

    def wait_for_update(self, words, known):
        """Wait for an update with these words after the first ``known`` ones."""
        wait_until(lambda: any(words in text for text in self.updates.texts[known:]), words)

    def serves_another(self):
        """Return whether a further goal between offices that no lost robot has held succeeds."""
        number = len(self.goals) + 1
        self.send(number, sorted(set(range(1, OFFICES + 1)) - self.robots.barred))
        return self.goals[number][0].wait()[0] == GoalStatus.SUCCEEDED

    def check(self, number, request, status, result):
        """Check that a goal has ended truly."""
        text, world = f"{request}: {result.message}", self.robots.world
        carrier = next((robot for robot, load in world.load.items() if number in load), None)
        if status == GoalStatus.SUCCEEDED:
            self.assertIn(number, world.delivered, text)
        elif status == GoalStatus.ABORTED and "is on robot" in result.message:
            self.assertTrue(f"robot {carrier}, which is out of service" in text or number in world.delivered, text)
        elif status == GoalStatus.ABORTED:
            self.assertRegex(text, "no robot in service can fetch it|robot r. cannot reach office")
            self.assertTrue(self.robots.barred & {request.start, request.end}, text)
        else:
            self.assertIn(number, self.cancelled, text)
            can_return = carrier not in {None, *self.lost} and request.start not in self.robots.barred
            self.assertFalse(can_return, text)
