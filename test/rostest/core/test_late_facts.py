#!/usr/bin/env python3
"""Facts of past cycles and of now at two core nodes; and their published stream, played to the command oclingo."""

import json
import os
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import rospkg
import rospy
import rostest
from actionlib_msgs.msg import GoalStatus
from rosgraph_msgs.msg import Log
from rosoclingo.msg import TaskPlan
from std_msgs.msg import UInt32

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, ManualInterfaces, Updates
from interface_helpers import PATIENCE, executable, init_node, wait_to_hear, wait_until

DATA = os.path.join(rospkg.RosPack().get_path("rosoclingo"), "test", "data")


class Side:
    """A core with its interfaces, a client, and all published messages."""

    def __init__(self, namespace):
        self.hands = ManualInterfaces(namespace + "/")
        self.hands.wait_for(namespace + "/rosoclingo")
        self.client = Client(namespace + "/rosoclingo")
        self.updates = Updates(namespace + "/rosoclingo")
        self.plans = {}
        self._plans = rospy.Subscriber(namespace + "/rosoclingo/task_plan", TaskPlan, self._note)
        wait_until(lambda: self.plans, "the first plan")

    def _note(self, plan):
        self.plans[plan.cycle] = plan.horizon if ahead(plan.actions, plan.cycle) else None


def ahead(atoms, cycle):
    """Return the actions of a cycle and later."""
    actions = [atom for atom in atoms if atom.startswith("_action_lib(")]
    return [atom for atom in actions if int(atom[:-1].rsplit(",", 1)[1]) >= cycle]


class LateFacts(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        init_node("late_facts_test")
        cls.said = []
        cls.log = rospy.Subscriber("/rosout", Log, lambda message: cls.said.append(message.msg))
        cls.battery, cls.house = Side(""), Side("/house")
        wait_to_hear(cls.log, nodes=["/house/rosoclingo"])

    def test_house_uses_corrections_of_robot_and_thing(self):
        side = self.house
        side.hands.at_once = True
        done = len(side.hands.seen)
        words = ("_at(bedroom,now)", "_lies(cup,study,now)", "_at(cellar,now)")
        for fact in words:
            side.hands.tell(fact, origin="operator")
            side.updates.wait_for(fact.split(",now")[0])
        side.client.send("bring(hallway,cup)").ends_as(GoalStatus.SUCCEEDED)
        found = [text[len("_action_lib(") :].rpartition(",")[0] for text in side.hands.seen[done:]]
        self.assertEqual(found, ["move_base,study", "pickup,cup", "move_base,hallway", "deliver,cup"])
        wait_until(lambda: any("there is no place cellar" in text for text in self.said), "the core to refuse it")

    def test_battery_stream_gives_same_answers_by_command(self):
        side = self.battery
        self.assertEqual(rospy.wait_for_message("rosoclingo/cycle", UInt32, PATIENCE).data, 1)
        goal = side.client.send("do(walk,1)")
        side.hands.succeed(side.hands.take())
        goal.ends_as(GoalStatus.SUCCEEDED)
        side.hands.tell("_battery(low,1)", origin="power")
        side.updates.wait_for("_battery(low,3).")
        self.assertFalse(any("_battery(low,1)" in text for text in side.updates.texts))
        goal = side.client.send("do(run,2)")
        command = side.hands.take()
        side.hands.tell("_battery(low,now)", origin="power")
        side.hands.fail(command)
        command = side.hands.take()
        side.updates.wait_for(f"_battery(low,{int(command.rsplit(',', 1)[1][:-1]) - 1}).")
        side.hands.succeed(command)
        goal.ends_as(GoalStatus.SUCCEEDED)
        side.client.send("do(never,3)").ends_as(GoalStatus.ABORTED)
        side.updates.wait_for("_request(do(never,3),")
        self.check_stream(side, list(side.updates.texts))

    def check_stream(self, side, updates):
        wait_until(lambda: set(range(1, len(updates) + 1)) <= set(side.plans), "the plan of each update")
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as stream:
            stream.write("".join(updates))
            stream.flush()
            command = [executable("oclingo"), os.path.join(DATA, "battery.lp"), "--shortest", "--json"]
            run = subprocess.run(
                [*command, "--stream", stream.name], stdout=subprocess.PIPE, text=True, timeout=PATIENCE, check=False
            )
        played = [json.loads(line) for line in run.stdout.splitlines()]
        self.assertEqual([one["step"] for one in played], list(range(1, len(played) + 1)))
        self.assertEqual(run.returncode, 20)
        self.assertIn("unsatisfiable", [one["outcome"] for one in played])
        for one in played:
            with_actions = one["answers"] and ahead(one["answers"][0], one["step"])
            self.assertEqual(side.plans[one["step"]], one["horizon"] if with_actions else None)


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "late_facts", LateFacts, sys.argv)
