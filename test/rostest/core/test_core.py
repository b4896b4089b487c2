"""The core with manual interfaces: goals of several clients, rejections, cancels, stray facts, late subscribers."""

import random
import signal
import subprocess
import unittest

import rospy
import yaml
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus
from core_helpers import Client, ManualInterfaces, SentGoal, Updates
from documented_names import check_names
from interface_helpers import PATIENCE, CommandProcess, send_request, wait_until
from rosoclingo.msg import GoalStates, ROSoClingoResult, TaskPlan
from std_msgs.msg import UInt32

from rosoclingo.reasoning.goals import Outcome

SUCCEEDED, ABORTED, REJECTED = GoalStatus.SUCCEEDED, GoalStatus.ABORTED, GoalStatus.REJECTED
PREEMPTED, RECALLED = GoalStatus.PREEMPTED, GoalStatus.RECALLED


class Core(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.hands = ManualInterfaces()
        cls.client = Client()
        cls.updates = Updates()
        cls.number = 0

    def setUp(self):
        self.hands.at_once = False

    def tearDown(self):
        left = self.hands.clear()
        self.assertEqual(left, [], "commands were left over")

    @classmethod
    def errand(cls, what="walk"):
        """Return a goal text with an identity of its own."""
        cls.number += 1
        return f"do({what},{cls.number})"

    def test_outcome_codes_are_those_of_the_action(self):
        for outcome in Outcome:
            self.assertEqual(getattr(ROSoClingoResult, outcome.name), int(outcome))

    def test_names_match_the_reference_page(self):
        check_names("core", "/rosoclingo", {})

    def test_goal_with_feedback_and_result(self):
        goal = self.client.send(self.errand())
        command = self.hands.take()
        wait_until(lambda: goal.feedback, "feedback")
        self.assertEqual(goal.feedback[0].task_plan[-1], command)
        self.assertEqual(goal.feedback[0].task_plan[goal.feedback[0].position], command)
        self.assertEqual(f",{goal.feedback[0].cycle})", command[command.rindex(",") :])
        self.assertEqual(goal.feedback[0].status, "pending")
        self.hands.succeed(command)
        status, result = goal.wait()
        self.assertEqual((status, result.outcome), (SUCCEEDED, ROSoClingoResult.SUCCEEDED))
        self.assertIn("is met", result.message)

    def test_late_interface_receives_run_and_only_actions_under_way(self):
        self.assertRegex(self.hands.runs[0], r'^_run\("[-:T0-9]+-[0-9a-f]{8}"\)$')
        self.hands.at_once = True
        self.client.send(self.errand()).ends_as(SUCCEEDED)
        self.hands.at_once = False
        goal = self.client.send(self.errand("run"))
        command = self.hands.take()
        echo = ["rostopic", "echo", "-n", "2", "/out_rosoclingo/facts"]  # a subscriber with a connection of its own
        late = subprocess.run(echo, stdout=subprocess.PIPE, text=True, timeout=PATIENCE, check=True).stdout
        self.assertEqual(list(yaml.safe_load_all(late))[:2], [self.hands.runs[:1], [command]])
        self.hands.succeed(command)
        goal.ends_as(SUCCEEDED)

    def test_plan_is_latched(self):
        self.hands.at_once = True
        self.client.send(self.errand()).ends_as(SUCCEEDED)
        plan = rospy.wait_for_message("rosoclingo/task_plan", TaskPlan, PATIENCE)
        self.updates.wait_for(f"#step {plan.cycle} : 60.\n")
        self.assertEqual(rospy.wait_for_message("rosoclingo/cycle", UInt32, PATIENCE).data, plan.cycle)
        self.assertGreaterEqual(plan.horizon, plan.cycle)
        self.assertEqual(plan.actions[-1], self.hands.seen[-1])

    def test_goals_are_latched_as_by_actionlib(self):
        goal = self.client.send(self.errand())
        command = self.hands.take()
        one = goal.entry(self.latched(lambda message: goal.entry(message).request))
        self.assertEqual((one.request, one.status, one.reason), (goal.text, GoalStatus.PENDING, ""))
        self.assertEqual((one.since, one.ended), (rospy.Time(), rospy.Time()))
        refused = self.client.send("do(")
        message = refused.ends_as(REJECTED)
        self.hands.succeed(command)
        goal.ends_as(SUCCEEDED)
        over = self.latched(lambda message: goal.entry(message).status == SUCCEEDED)
        met = goal.entry(over)
        self.assertEqual((met.id, met.came, met.reason), (one.id, one.came, goal.wait()[1].message))
        self.assertTrue(rospy.Time() < met.came <= met.since <= met.ended)
        lost = refused.entry(over)
        self.assertEqual((lost.status, lost.reason, lost.since), (REJECTED, message, rospy.Time()))
        self.assertLess(over.goals.index(met), over.goals.index(lost))

    @staticmethod
    def latched(fit):
        """Wait for a message of all goals that fits: it is published soon after the goals' own news."""
        topic, found = "rosoclingo/goals", []
        wait_until(lambda: found.append(rospy.wait_for_message(topic, GoalStates, PATIENCE)) or fit(found[-1]), topic)
        return found[-1]

    def test_request_from_the_command_line_succeeds(self):
        self.hands.at_once = True
        nobody = [self.errand(), "--server", "nobody", "--wait", "0.2"]
        for words, code in (([self.errand()], 0), (["do("], 3), ([self.errand("never")], 4), (nobody, 5)):
            with send_request(*words) as request:
                self.assertEqual(request.wait()[0], code)

    def test_watch_joins_a_run_and_ends_with_a_summary(self):
        before = self.client.send(self.errand())
        self.hands.succeed(self.hands.take())
        before.ends_as(SUCCEEDED)
        goal = self.client.send(self.errand())
        command = self.hands.take()
        _, number, cycle = command[:-1].split(",")
        with CommandProcess("watch", "--state") as watch:
            lines = watch.lines_until("action   walks")
            self.assertTrue(all(f"cycle {cycle} " in line for line in lines), lines)
            self.assertTrue(lines[0].endswith(f"plan     walks {number}"), lines)
            self.assertNotIn(before.text, "".join(lines))
            if goal.text not in "".join(lines):
                watch.lines_until(goal.text)  # its request or its status, whichever message arrived first
            self.hands.succeed(command)
            watch.lines_until(f"goal     {goal.text}: done")
            watch.signal(signal.SIGINT)
            code, rest = watch.wait()
        self.assertEqual(code, 0)
        rest = rest.splitlines()
        begin = rest.index(f"{goal.text}: done")  # after the output that preceded the interrupt
        self.assertEqual((rest[begin - 1], rest[begin + 1]), ("", f"actions: walks {number}"))

    def test_many_goals_of_many_clients(self):
        self.hands.at_once = True
        chance = random.Random(1)
        clients = [Client() for _ in range(4)]
        sent = [(chance.random() < 0.3, SentGoal(chance.choice(clients).raw, self.errand("quick"))) for _ in range(40)]
        for cancelled, goal in sent:
            if cancelled:
                goal.cancel()
        for cancelled, goal in sent:
            self.assertIn(goal.wait()[0], (SUCCEEDED, PREEMPTED, RECALLED) if cancelled else (SUCCEEDED,))
            self.assertEqual(goal.states.count(CommState.DONE), 1)
