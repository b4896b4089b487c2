"""Kill core, interfaces and office during actions: each package is at the right place, and no action runs twice.

ROSOCLINGO_SEED chooses other goals and instants, ROSOCLINGO_KILLS the number of kills.
"""

import os
import random
import threading
import unittest

import rospy
import tf2_ros
from actionlib.action_client import CommState
from actionlib.action_server import ActionServer
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from core_helpers import Client
from interface_helpers import PATIENCE, base_at, kill, wait_for_server, wait_to_hear, wait_until
from move_base_msgs.msg import MoveBaseAction
from rosoclingo.msg import DeliverActionResult, InterfaceIO, PackageStates, PickupActionResult

from rosoclingo.reasoning.keywords import CORE

SEED, KILLS = (int(os.environ.get(f"ROSOCLINGO_{name}", usual)) for name, usual in (("SEED", "1"), ("KILLS", "3")))
OFFICES = ("office1", "office2", "office3", "office4")
INTERFACES = {"pickup": "pickup_interface", "deliver": "deliver_interface", "move_base": "move_base_interface"}
ALL, NODE = tuple(INTERFACES.values()), "rosoclingo"
HANDLING = ("pickup", "deliver")  # the servers of the office


class Base:
    """A move_base that reaches each target after a moment, and publishes it to tf."""

    def __init__(self):
        self._broadcaster = tf2_ros.StaticTransformBroadcaster()
        self._stand(1.9, 0.0)
        self._server = ActionServer("move_base", MoveBaseAction, self._begin, self._cancel, auto_start=False)
        self._server.start()

    def _stand(self, x, y):
        self._broadcaster.sendTransform(base_at(x, y))

    def _begin(self, handle):
        handle.set_accepted()
        threading.Timer(0.3, self._arrive, [handle]).start()

    def _arrive(self, handle):
        if handle.get_goal_status().status == GoalStatus.ACTIVE:
            place = handle.get_goal().target_pose.pose.position
            self._stand(place.x, place.y)
            handle.set_succeeded()

    @staticmethod
    def _cancel(handle):
        handle.set_canceled()


class World:
    """The observable office: the way of each package, the active server, and the refused actions."""

    def __init__(self):
        self.ways, self.refused, self.runs, self.most = {}, [], set(), 0
        self._begun = {server: set() for server in INTERFACES}
        heard = [rospy.Subscriber("packages", PackageStates, self._note_packages, queue_size=None)]
        for server in INTERFACES:
            status = f"{server}/status"
            heard.append(rospy.Subscriber(status, GoalStatusArray, self._note_status, server, queue_size=None))
        for server, kind in (("pickup", PickupActionResult), ("deliver", DeliverActionResult)):
            heard.append(rospy.Subscriber(f"{server}/result", kind, self._note_result, queue_size=None))
        wait_to_hear(*heard)
        rospy.Subscriber("out_rosoclingo", InterfaceIO, self._note_run, queue_size=None)

    def _note_packages(self, message):
        self.most = max(self.most, sum(one.carried for one in message.packages))
        for one in message.packages:
            way, place = self.ways.setdefault(one.id, []), "robot" if one.carried else one.location
            if way[-1:] != [place]:
                way.append(place)

    def _note_status(self, message, server):
        self._begun[server] |= {one.goal_id.id for one in message.status_list if one.status == GoalStatus.ACTIVE}

    def _note_result(self, message):
        if message.status.status == GoalStatus.ABORTED:
            self.refused.append(message.result.message)

    def _note_run(self, message):
        if message.interface == CORE:
            self.runs.update(message.facts)

    def begun(self, server):
        """Return how often a server has begun an action."""
        return len(self._begun[server])

    def way(self, package, origin):
        """Return where a package has been since it lay in its office."""
        way = self.ways.get(str(package), [])
        return way[1:] if way[:1] == [origin] else way


class MailbotKilled(unittest.TestCase):
    def setUp(self):
        self.source = random.Random(SEED)
        self.base, self.world, self.client = Base(), World(), Client()
        wait_for_server(self.client.raw)
        self.goals, self.cancelled = [], set()

    def test_mailbot_survives_repeated_kills(self):
        for number in range(KILLS):
            if self.source.random() < 0.5:
                self.cancel(self.send())
            self.kill_at(number)
        wait_until(self.all_have_arrived, "the last goals to arrive")
        for goal, package, origin, target in self.goals:
            status, _ = goal.wait(2 * PATIENCE)
            self.check(goal, status, package, origin, target)
        self.assertEqual(self.world.refused, [], "the office received an impossible request")
        self.assertEqual(len(self.world.runs), 1, "a core that goes on is of the same run")
        self.assertLessEqual(self.world.most, 3)

    def send(self):
        """Send a goal for a package of its own."""
        origin, target = self.source.sample(OFFICES, 2)
        package = 10 + len(self.goals)
        goal = self.client.send(f"goal({origin},{target},{package})")
        self.goals.append((goal, package, origin, target))
        return goal

    def cancel(self, goal):
        """Cancel a goal at once, or when its package is on the robot."""
        package = str(self.goals[-1][1])
        wait_until(self.all_have_arrived, "the goals to arrive")
        if self.source.random() < 0.5:
            wait_until(lambda: "robot" in self.world.ways.get(package, []), "the package to be on the robot")
        self.cancelled.add(goal)
        goal.cancel()

    def all_have_arrived(self):
        return not [goal for goal, *_ in self.goals if not goal.has_arrived()]  # each is examined

    def kill_at(self, number):
        """Kill interfaces, alone or with core or office, when a server has begun an action or at any instant."""
        server = (*INTERFACES, None)[number % 4]
        own = [INTERFACES[server]] if server else self.source.sample(ALL, 1)
        core_too = (number + number // 4) % 2
        victims = [NODE, *self.source.choice([[], own, ALL])] if core_too else self.source.choice([own, ALL])
        if server in HANDLING and INTERFACES[server] in victims and number % 8 < 4:
            victims = [*victims, "office"]
        before = server and self.world.begun(server)
        self.send()
        if server:
            wait_until(lambda: self.all_have_arrived() and self.world.begun(server) > before, f"{server} to begin")
        kill(*victims)

    def check(self, goal, status, package, origin, target):
        """Check that a goal has ended once, and that its package is where the end says."""
        way, reported = self.world.way(package, origin), f"{goal.text}: {self.world.ways.get(str(package))}"
        self.assertEqual(goal.states.count(CommState.DONE), 1, reported)
        if status == GoalStatus.SUCCEEDED:
            self.assertEqual(way, ["robot", target], reported)
        else:
            self.assertIn(status, (GoalStatus.RECALLED, GoalStatus.PREEMPTED), reported)
            self.assertIn(goal, self.cancelled, reported)
            self.assertIn(way, ([], ["robot", origin], ["robot", target]), reported)  # last: a late cancel
