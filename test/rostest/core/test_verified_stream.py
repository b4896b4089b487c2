#!/usr/bin/env python3
"""A stream found by verification is played to a core node, which shows the finding."""

import os
import sys
import unittest
from pathlib import Path

import rospkg
import rospy
import rostest
from rosgraph_msgs.msg import Log

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from core_helpers import Client, ManualInterfaces, Updates
from interface_helpers import init_node, wait_to_hear, wait_until

from rosoclingo.checking.verifying.moves import GOAL
from rosoclingo.checking.verifying.scope import DefectKind, VerifyLimits
from rosoclingo.checking.verifying.verification import verify
from rosoclingo.oclingo import ReactiveProgram

PROGRAM = os.path.join(rospkg.RosPack().get_path("rosoclingo"), "test", "data", "late_door.lp")


class VerifiedStream(unittest.TestCase):
    def setUp(self):
        init_node("verified_stream_test")
        self.said = []
        log = rospy.Subscriber("/rosout", Log, lambda message: self.said.append(message.msg))
        self.hands = ManualInterfaces()
        self.hands.wait_for("/rosoclingo")
        self.client, self.updates = Client(), Updates()
        wait_to_hear(log, nodes=["/rosoclingo"])

    def test_core_shows_the_finding_of_verification(self):
        verdict = verify(
            ReactiveProgram.from_files([PROGRAM]), limits=VerifyLimits(events=2, together=1, steps=12), seconds=250
        )
        (defect,) = verdict.defects
        self.assertEqual((defect.kind, defect.cost), (DefectKind.NO_ANSWER, 2))
        for step in defect.way:
            under_way = [self.hands.take() for _ in step.move.answers]
            self.assertEqual(under_way, [str(one.action.atom) for one in step.move.answers])
            for one in step.move.arrivals:
                if one.kind == GOAL:
                    self.client.send(one.text)
                else:
                    self.hands.tell(one.text, origin="sensor")
                    self.finding = one.text
            for answer in step.move.answers:
                self.hands.tell(answer.text)
        wait_until(lambda: any(self._is_doubt(text) for text in self.said), "the core to doubt the finding")

    def _is_doubt(self, text):
        return self.finding in text and "contradicts that go(" in text


if __name__ == "__main__":
    rostest.rosrun("rosoclingo", "verified_stream", VerifiedStream)
