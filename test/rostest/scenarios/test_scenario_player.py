"""A scenario ends after its time, and also when the source of simulated time is gone.

It is judged by all messages about its end, including those after the last goal's status.
"""

import itertools
import signal
import threading
import time
import unittest
from unittest import mock

import rospy
import yaml
from actionlib_msgs.msg import GoalStatusArray
from interface_helpers import CommandProcess, wait_until
from rosgraph_msgs.msg import Clock
from rosoclingo.msg import InterfaceIO, TaskPlan
from std_msgs.msg import String

from rosoclingo.common.reading import Reader
from rosoclingo.nodes.account_node import AccountNode
from rosoclingo.nodes.scenarios import player as scenario_player
from rosoclingo.nodes.scenarios.player import PlayError, ScenarioPlayer
from rosoclingo.runs.account import Account
from rosoclingo.runs.scenario import Scenario

SCENARIO = "{title: test, events: [{time: 50.0, request: 'goal(office1,office2,1)'}], timeout: 20.0}"


def read(text):
    """Return the scenario in a text."""
    return Scenario.read(Reader(yaml.safe_load(text)))


class ScenarioPlayerTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.seconds = itertools.count(1)
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=10, latch=True)
        cls.tick()
        wait_until(lambda: rospy.get_time() > 0.0, "the clock")

    @classmethod
    def tick(cls):
        cls.clock.publish(Clock(rospy.Time(next(cls.seconds))))

    def play(self, check=lambda: None):
        ScenarioPlayer(read(SCENARIO), [], print, check).play()

    def test_scenario_ends_if_time_stands_still(self):
        with mock.patch.object(scenario_player, "STILL", 0.5):
            self.assertRaisesRegex(PlayError, "time has stood still for 0.5 s", self.play)

    def test_scenario_ends_when_its_time_is_over(self):
        self.assertRaisesRegex(PlayError, "not done after .* request", self.play, self.tick)

    def test_player_counts_cycles_from_the_beginning(self):
        """The core rests in its cycle 7 when the scenario begins; its next update is that of cycle 8."""
        said, cycles = [], iter([8, 9, 10])
        plans = rospy.Publisher("rosoclingo/task_plan", TaskPlan, queue_size=10, latch=True)
        updates = rospy.Publisher("rosoclingo/updates", String, queue_size=10)
        inlet = rospy.Publisher("in_rosoclingo", InterfaceIO, queue_size=100)  # also used by the player
        facts = rospy.Subscriber("in_rosoclingo", InterfaceIO, lambda message: said.append(message.facts[0]))
        text = "events: [{cycle: 1, facts: [first]}, {cycle: 3, facts: [third]}]"
        plans.publish(cycle=7)

        def go_on():
            self.tick()
            cycle = max(player.begun, default=0)
            if said == ["first"] and cycle < 10 and cycle + 1 == peek[0]:
                updates.publish(f"#step {peek[0]}.\n_seen(ball).\n#end step.\n")
                plans.publish(cycle=peek[0])
                peek[0] = next(cycles, 10)

        peek = [next(cycles)]
        player = ScenarioPlayer(read(text), [], print, go_on)
        player.wait_until(lambda: 7 in player.begun, 60.0, lambda: "no plan")
        wait_until(
            lambda: inlet.get_num_connections() > 0, "the player's facts to be heard"
        )  # rospy counts it last here
        wait_until(lambda: updates.get_num_connections() > 0, "the player to hear of updates")
        player.play()
        wait_until(lambda: said == ["first", "third"], "the facts")
        self.assertEqual((player.before, max(player.begun)), (7, 10))
        for one in (facts, inlet, plans, updates):
            one.unregister()

    def test_player_reports_a_cycle_that_does_not_come(self):
        text = "events: [{cycle: 5, facts: [a]}]"
        with mock.patch.object(scenario_player, "QUIET", 0.5):
            player = ScenarioPlayer(read(text), [], print, self.tick)
            self.assertRaisesRegex(PlayError, "never happened: in cycle 5 facts .*in cycle 1 of the", player.play)

    def test_player_waits_no_longer_after_a_slow_signal_handler(self):
        """Such as that of rospy, which joins threads: Ctrl-C did not end the player while no messages arrived."""
        node = AccountNode(Account(print))
        inlet = rospy.Publisher("in_rosoclingo", InterfaceIO, queue_size=100)
        late = threading.Timer(20.0, inlet.publish, [InterfaceIO("late", [])])
        self.addCleanup(late.cancel)
        self.addCleanup(signal.signal, signal.SIGALRM, signal.signal(signal.SIGALRM, lambda *_: time.sleep(0.3)))
        late.start()
        signal.setitimer(signal.ITIMER_REAL, 0.1)
        node.tick(0.2)
        self.assertTrue(late.is_alive())

    def test_player_ends_on_ctrl_c_while_it_waits_for_a_server(self):
        status = rospy.Publisher("nobody/status", GoalStatusArray, queue_size=1)
        with CommandProcess("play_scenario", "paper", "--wait-for", "nobody") as process:
            wait_until(lambda: status.get_num_connections() > 0, "the player to wait")
            process.signal(signal.SIGINT)
            code, printed = process.wait()
        self.assertIn("shut down while waiting: no action server nobody", printed)
        self.assertEqual(code, 1)

    def test_player_reports_a_cancel_of_nothing(self):
        player = ScenarioPlayer(read("events: [{time: 0, cancel: 5}]"), [], print, self.tick)
        self.assertRaisesRegex(PlayError, "cancel 5: no goal 5 was sent before", player.play)
