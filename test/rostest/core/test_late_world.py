#!/usr/bin/env python3
"""Office and house under late, repeated and false facts: every action and every end is right.

ROSOCLINGO_SEED chooses another course of events, ROSOCLINGO_GOALS the number of goals in each of the two worlds.
"""

import os
import sys
import threading
import unittest
from pathlib import Path

import rospy
import rostest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "unit"))

from carrying_stage import Stage
from carrying_world import HOUSE, OFFICE, ROBOT

SEED = int(os.environ.get("ROSOCLINGO_SEED", "1"))
GOALS = int(os.environ.get("ROSOCLINGO_GOALS", "12"))  # in each of the two worlds


class LateWorld(unittest.TestCase):
    def test_each_action_and_each_end_is_right(self):
        stages = [Stage("office", OFFICE, SEED, GOALS), Stage("house", HOUSE, SEED, GOALS)]
        threads = [threading.Thread(target=self.play, args=(stage,)) for stage in stages]
        self.ended_well = []
        for one in threads:
            one.start()
        for one in threads:
            one.join()
        for stage in stages:
            play = stage.play
            self.assertEqual(play.faults, [], play.story)
            self.assertIn(stage, self.ended_well, play.story)
            self.assertNotIn(ROBOT, {one.place for one in play.things.values()})
            self.assertGreaterEqual(sum(play.ends.values()), GOALS)
            self.assertGreaterEqual(play.ends["succeeded"], GOALS // 10, play.ends)
        ends = {end: sum(stage.play.ends[end] for stage in stages) for end in stages[0].play.ends}
        self.assertGreaterEqual(min(ends.values()), max(GOALS // 50, 1), ends)

    def play(self, stage):
        if stage.run_to_the_end():
            self.ended_well.append(stage)


if __name__ == "__main__":
    rospy.init_node("late_world_test")
    rostest.rosrun("rosoclingo", "late_world", LateWorld, sys.argv)
