"""Simulated time, published by the test: it begins late, runs fast, stands still, is reset."""

import unittest

import rospy
from actionlib.msg import TestAction
from diagnostic_msgs.msg import DiagnosticArray
from interface_helpers import CoreSide, Server, wait_until
from rosgraph_msgs.msg import Clock


class SimulatedTimeInterfaces(unittest.TestCase):
    def set_clock(self, seconds):
        self.clock.publish(Clock(rospy.Time(seconds)))
        wait_until(lambda: rospy.get_time() == seconds == self.reported, "the time to arrive, at the interface too")

    def note(self, message):
        self.reported = message.header.stamp.to_sec()

    def test_interface_survives_a_day_in_simulated_time(self):
        self.clock = rospy.Publisher("/clock", Clock, queue_size=10, latch=True)
        self.reported = None  # the interface's time, which it publishes once a second of wall time
        rospy.Subscriber("/diagnostics", DiagnosticArray, self.note)
        core = CoreSide()
        server = Server("slow", TestAction)
        core.wait_for("interface")

        # before the first clock message
        core.send("slow", "_action_lib(slow,a,1)")
        server.accept().set_succeeded()
        self.assertEqual(core.receive(), ["_return(slow,a,1)"])
        self.assertEqual(core.run("absent", "_action_lib(absent,a,1)"), ["_return(absent,server_lost,1)"])

        # an action that began then has not timed out just because the clock begins with a large number
        core.send("slow", "_action_lib(slow,a,2)")
        handle = server.accept()
        self.set_clock(100000)
        self.set_clock(100059)
        handle.set_succeeded()
        self.assertEqual(core.receive(), ["_return(slow,a,2)"])

        # time-outs are in simulated time
        core.send("slow", "_action_lib(slow,a,3)")
        handle = server.accept()  # a server forgets goals without a handle after some seconds of simulated time
        self.set_clock(100130)
        server.cancelled().set_canceled()
        self.assertEqual(core.receive(), ["_return(slow,timeout,3)"])

        # a reset of simulated time ends nothing, and goals continue
        core.send("slow", "_action_lib(slow,a,4)")
        handle = server.accept()
        self.set_clock(5)
        handle.set_succeeded()
        self.assertEqual(core.receive(), ["_return(slow,a,4)"])
        core.send("slow", "_action_lib(slow,a,5)")
        server.accept().set_succeeded()
        self.assertEqual(core.receive(), ["_return(slow,a,5)"])

        # while time stands still, an absent server is noticed nevertheless
        self.assertEqual(core.run("absent", "_action_lib(absent,a,6)"), ["_return(absent,server_lost,6)"])
        self.assertTrue(core.silent())
