#!/usr/bin/env python3
"""Plays the scenarios of this package in the running system, and compares how they end with what they expect."""

import sys
import unittest
from pathlib import Path

import rospy
import rostest
from rosoclingo.nodes.scenarios.playing import find_scenario, run_scenario

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
SERVERS = ["move_base"]  # action servers that have to be there
PATIENCE = 300.0  # seconds of wall time for them


class ScenariosTest(unittest.TestCase):
    def test_they_end_as_expected(self):
        for path in sorted(SCENARIOS.glob("*.yaml")):
            lines = []
            outcome = run_scenario(find_scenario(str(path)), SERVERS, lines.append, PATIENCE)
            self.assertEqual(outcome.faults, [], f"{path.name}\n" + "\n".join(lines))


if __name__ == "__main__":
    rospy.init_node("test_scenarios")
    rostest.rosrun("@NAME@", "scenarios", ScenariosTest, sys.argv)
