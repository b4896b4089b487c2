#!/usr/bin/env python3
"""Many goals from four clients at once, some of them cancelled: each has a result, and no package is lost.

Parameters: ``~offices``, the number of offices; ``~cancels``, whether some goals are cancelled, otherwise all are
met; ``~goals``, the number of goals per client.
"""

import collections
import json
import subprocess
import sys
import unittest
from pathlib import Path

import rospy
import rostest
from actionlib.action_server import ActionServer
from actionlib_msgs.msg import GoalStatus
from crowd_errands import CLIENTS, errands, names
from move_base_msgs.msg import MoveBaseAction
from rosoclingo.msg import DeliverAction, DeliverResult, PickupAction, PickupResult, ROSoClingoActionResult

from rosoclingo.common.action_servers import start_server
from rosoclingo.common.labels import LabelTable
from rosoclingo.common.reading import Reader
from rosoclingo.robot.simulation.office_packages import PackageOffice

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import init_node, wait_to_hear, wait_until

LIMIT = 600.0  # seconds of wall time
SUCCEEDED, ABORTED, REJECTED = GoalStatus.SUCCEEDED, GoalStatus.ABORTED, GoalStatus.REJECTED
CANCELED = (GoalStatus.PREEMPTED, GoalStatus.RECALLED)


class QuickRobot:
    """The servers of the robot, with an office behind them; every action ends at once."""

    def __init__(self, labels, packages, offices):
        self._labels = labels
        self._at = "office1"
        self.office = PackageOffice(offices)
        self.office.read(Reader(packages))
        self.faults = []
        self._servers = [
            self._serve("move_base", MoveBaseAction, self._drive),
            self._serve("pickup", PickupAction, lambda goal: self._handle(goal, self.office.pickup, PickupResult)),
            self._serve("deliver", DeliverAction, lambda goal: self._handle(goal, self.office.deliver, DeliverResult)),
        ]

    @staticmethod
    def _serve(name, action, do):
        server = ActionServer(name, action, do, lambda _: None, auto_start=False)
        start_server(server)
        return server

    def _drive(self, handle):
        handle.set_accepted()
        position = handle.get_goal().target_pose.pose.position
        self._at = str(self._labels.nearest(position.x, position.y, 0.01).name)
        handle.set_succeeded()

    def _handle(self, goal_handle, do, result):
        goal_handle.set_accepted()
        done = do(goal_handle.get_goal().package, self._at)
        if done.succeeded:
            goal_handle.set_succeeded(result(), done.message)
        else:
            self.faults.append(done.message)
            goal_handle.set_aborted(result(outcome=done.outcome), done.message)


class Crowd(unittest.TestCase):
    def test_crowd_goals_all_have_a_result(self):
        self.kind = tuple(map(rospy.get_param, ("~offices", "~cancels", "~goals")))
        offices = names(self.kind[0])
        wanted = [errand for client in range(CLIENTS) for errand in errands(client, *self.kind)]
        packages = {office: [one.number for one in wanted if one.origin == office] for office in offices}
        robot = QuickRobot(LabelTable.from_mapping(rospy.get_param("rosoclingo/labels")), packages, offices)
        results = collections.Counter()
        subscriber = rospy.Subscriber(
            "rosoclingo/result", ROSoClingoActionResult, lambda one: results.update([one.status.goal_id.id])
        )
        wait_to_hear(subscriber)
        ends = self.play()
        self.assertEqual(sorted(ends), [one.number for one in wanted])
        self.assertEqual(robot.faults, [], "the plan and the world parted")
        self.assertEqual(robot.office.carried, [])
        where = {int(place.package): place.location for place in robot.office.places}
        for errand in wanted:
            self.judge(errand, *ends[errand.number], where[errand.number])
        wait_until(lambda: len(results) == len(wanted), "all results")
        self.assertEqual(set(results.values()), {1}, "a goal has ended twice")

    def play(self):
        """Return number to status and message, of all goals.

        The clients connect one after the other: if they connect at once, rospy connects to some twice and drops the
        messages of the first connection.
        """
        client = str(Path(__file__).with_name("crowd_client.py"))
        clients, ends = [], {}
        self.addCleanup(lambda: [one.kill() for one in clients])
        for number in range(CLIENTS):
            command = [sys.executable, client, *(str(int(one)) for one in (number, *self.kind))]
            clients.append(subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True))
            self.assertEqual(clients[-1].stdout.readline(), "connected\n")
        for one in clients:
            one.stdin.write("begin\n")
            one.stdin.flush()
        for one in clients:
            ends.update({int(number): end for number, end in json.loads(one.communicate(timeout=LIMIT)[0]).items()})
        return ends

    def judge(self, errand, status, message, place):
        """Check that a status is true: it was possible, and the package is where it says."""
        if status == SUCCEEDED:
            self.assertEqual(place, errand.destination, errand)
        else:
            self.assertIn(status, CANCELED, f"{errand}: {message}")
            self.assertIsNotNone(errand.patience, errand)
            self.assertEqual(place, errand.origin, errand)


if __name__ == "__main__":
    init_node("crowd_test")
    rostest.rosrun("rosoclingo", "crowd", Crowd, sys.argv)
