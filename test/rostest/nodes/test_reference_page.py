#!/usr/bin/env python3
"""Core, interface, office and markers have exactly the topics, services and actions of the reference page."""

import sys
import time
import unittest
from pathlib import Path

import rospy
import rostest

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from documented_names import documented, offered

WALK = {"SERVER": ("walk", "actionlib/TestAction")}


class ReferencePage(unittest.TestCase):
    maxDiff = None

    def look(self, script, node, given):
        """Wait until the node is up and has the documented names, or report the differences."""
        wanted, end = documented(script, node, given), time.monotonic() + 300.0
        while offered(node) != wanted and time.monotonic() < end and not rospy.is_shutdown():
            rospy.rostime.wallsleep(0.1)
        self.assertEqual(offered(node), wanted)

    def test_core_names_match_the_page(self):
        self.look("core", "/rosoclingo", {})

    def test_interface_names_match_the_page(self):
        self.look("interface", "/legs", WALK)

    def test_office_names_match_the_page(self):
        self.look("office", "/office", {})

    def test_markers_names_match_the_page(self):
        self.look("markers", "/markers", {})


if __name__ == "__main__":
    rospy.init_node("reference_page_test")
    rostest.rosrun("rosoclingo", "reference_page", ReferencePage, sys.argv)
