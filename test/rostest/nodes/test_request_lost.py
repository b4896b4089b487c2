"""A request from the command line ends as lost once its core is gone, with any ROS time, and not before."""

import signal
import threading
import unittest

import rospy
from actionlib_msgs.msg import GoalStatus
from core_helpers import ManualInterfaces, start_core
from interface_helpers import PATIENCE, send_request, wait_to_hear, wait_until
from rosgraph_msgs.msg import Clock
from rosoclingo.msg import ROSoClingoActionResult

from rosoclingo.nodes.goal_client import SILENCE


def ask(server, *arguments):
    """Start `rosrun rosoclingo request`."""
    return send_request("do(walk,1)", "--server", server, *arguments)


class RequestLost(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clock = rospy.Publisher("/clock", Clock, queue_size=10, latch=True)
        cls.running = threading.Event()
        cls.running.set()
        threading.Thread(target=cls.tick, daemon=True).start()
        wait_until(lambda: rospy.get_time() > 0.0, "the time to begin")

    @classmethod
    def tick(cls):
        """Let simulated time run while ``running`` is set."""
        seconds = 1.0
        while True:
            cls.running.wait()
            cls.clock.publish(Clock(rospy.Time(seconds)))
            seconds += 0.02
            threading.Event().wait(0.02)

    def tearDown(self):
        self.running.set()

    def asks(self, namespace):
        """Start a request whose action is under way."""
        hands = ManualInterfaces(f"{namespace}/rosoclingo")
        request = ask(f"{namespace}/rosoclingo")
        return hands, hands.take(), request

    def is_lost(self, request):
        code, said = request.wait(2 * PATIENCE)
        self.assertEqual(code, 5, said)
        self.assertIn("lost: no news of do(walk,1)", said)
        self.assertIn("does not respond", said)

    def test_core_is_killed_while_time_stands_still(self):
        with start_core("frozen") as process:
            hands, command, request = self.asks("frozen")
            with request:
                self.running.clear()
                for _ in range(int(3 * SILENCE)):
                    self.assertTrue(request.running, "the core is there: its time stands still, and so its status")
                    threading.Event().wait(1.0)
                process.signal(signal.SIGKILL)
                self.is_lost(request)
            self.assertTrue(command and hands)

    def test_core_ends_its_goals_while_time_stands_still(self):
        with start_core("paused"):
            hands, command, request = self.asks("paused")
            with request:
                self.running.clear()
                hands.succeed(command)
                self.assertEqual(request.wait(2 * PATIENCE)[0], 0)

    def test_request_waits_for_time_to_begin(self):
        other = "/clock:=/late_clock"
        with start_core("early", other), ask("early/rosoclingo", other) as request:
            hands = ManualInterfaces("early/rosoclingo")
            for _ in range(int(4 * SILENCE)):
                self.assertTrue(request.running, "the core is there, and waits for time to begin")
                threading.Event().wait(1.0)
            clock = rospy.Publisher("/late_clock", Clock, queue_size=10, latch=True)
            ticks = rospy.Timer(rospy.Duration(0.05), lambda event: clock.publish(Clock(event.current_real)))
            hands.succeed(hands.take())
            code, said = request.wait(2 * PATIENCE)
            ticks.shutdown()
        self.assertEqual(code, 0, said)
        self.assertIn("ROS time has not begun", said)

    def test_core_is_restarted(self):
        with start_core("restarted") as process:
            _, _, request = self.asks("restarted")
            with request:
                process.signal(signal.SIGKILL)
                process.wait()
                with start_core("restarted"):
                    code, said = request.wait(2 * PATIENCE)
                    self.assertEqual(code, 5, said)
                    self.assertIn("lost:", said)

    def test_goal_of_a_killed_request_continues(self):
        results = []
        subscriber = rospy.Subscriber("orphan/rosoclingo/result", ROSoClingoActionResult, results.append)
        with start_core("orphan"):
            hands, command, request = self.asks("orphan")
            wait_to_hear(subscriber, nodes=["/orphan/rosoclingo"])
            with request:
                pass  # it is killed at the end
            hands.succeed(command)
            wait_until(lambda: results, "the goal to end")
        self.assertEqual(results[0].status.status, GoalStatus.SUCCEEDED)
