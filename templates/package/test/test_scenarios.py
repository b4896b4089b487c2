#!/usr/bin/env python3
"""Plays the scenarios of this package in the running system, and compares their ends with their expectations."""

import sys
import unittest
from pathlib import Path

import rospy
import rostest
from rosoclingo.nodes.scenarios.playing import find_scenario, run_scenario

SCENARIOS = Path(__file__).resolve().parents[1] / "scenarios"
SERVERS = ["move_base"]  # required action servers
PATIENCE = 300.0  # limit in seconds of wall time for their start


class ScenariosTest(unittest.TestCase):
    def test_they_end_as_expected(self):
        for path in sorted(SCENARIOS.glob("*.yaml")):
            lines = []
            outcome = run_scenario(find_scenario(str(path)), SERVERS, lines.append, PATIENCE)
            self.assertEqual(outcome.faults, [], f"{path.name}\n" + "\n".join(lines))


if __name__ == "__main__":
    rospy.init_node("test_scenarios")
    rostest.rosrun("@NAME@", "scenarios", ScenariosTest, sys.argv)
