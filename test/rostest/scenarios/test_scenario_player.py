#!/usr/bin/env python3
"""A scenario ends when its time is over, and also when whoever makes simulated time is gone.

It is judged by all that is said of its end, also by what comes after the last goal's status.
"""

import itertools
import sys
import unittest
from pathlib import Path
from unittest import mock

import rospy
import rostest
from rosgraph_msgs.msg import Clock
from rosoclingo.msg import PackageState, PackageStates

from rosoclingo.nodes.account_node import TopicAccount
from rosoclingo.nodes.scenarios import player as scenario_player
from rosoclingo.nodes.scenarios import playing
from rosoclingo.nodes.scenarios.player import PlayError, ScenarioPlayer
from rosoclingo.runs.scenario import Scenario

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from interface_helpers import init_node, wait_until

SCENARIO = "{title: test, events: [{time: 50.0, request: 'goal(office1,office2,1)'}], timeout: 20.0}"


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
        ScenarioPlayer(Scenario.from_text(SCENARIO), [], print, check).play()

    def test_time_that_stands_still(self):
        with mock.patch.object(scenario_player, "STILL", 0.5):
            self.assertRaisesRegex(PlayError, "time has stood still for 0.5 s", self.play)

    def test_time_that_is_over(self):
        self.assertRaisesRegex(PlayError, "not done after .* request", self.play, self.tick)

    def test_a_package_that_is_told_after_the_last_goal(self):
        account = TopicAccount(print)
        carried, lying = PackageState("1", "", True), PackageState("1", "office1", False)
        news = iter([carried, carried, lying])

        def tell():
            for one in itertools.islice(news, 1):
                account.take("packages", PackageStates(packages=[one]), 0.0)

        expect = {"packages": {"1": "office1"}}
        tell()
        self.assertTrue(account.differences(expect))
        playing.wait_for_news(ScenarioPlayer(Scenario.from_text(SCENARIO), [], print, tell), account, expect)
        self.assertEqual(account.differences(expect), [])

    def test_news_that_never_come(self):
        account, expect = TopicAccount(print), {"robot": "office1"}
        with mock.patch.object(playing, "LATE_NEWS", 0.2):
            playing.wait_for_news(ScenarioPlayer(Scenario.from_text(SCENARIO), [], print), account, expect)
        self.assertEqual(account.differences(expect), ["robot: expected office1, found "])


if __name__ == "__main__":
    init_node("scenario_player_test")
    rostest.rosrun("rosoclingo", "scenario_player", ScenarioPlayerTest, sys.argv)
