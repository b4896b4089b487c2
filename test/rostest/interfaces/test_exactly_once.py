"""Kill interface and core during actions: each action runs once, and is answered."""

import itertools
import os
import re
import signal
import sys
import unittest
import uuid
from pathlib import Path

import rospy
from actionlib.msg import TestAction
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from full_disk import room_for
from interface_helpers import (
    CoreSide,
    Process,
    Server,
    is_another,
    process_of,
    values_of,
    wait_for_diagnosis,
    wait_until,
)
from std_msgs.msg import Int32MultiArray

MORTAL = str(Path(__file__).resolve().parent / "mortal_server.py")
NODE = "interface"
NAMES = ("arm", "drive", "shelf", "stubborn")
GOALS = itertools.count(1)


def is_idle(report):
    return values_of(report)["under way"] == "0"


class ExactlyOnce(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.servers = {name: Server(name, TestAction) for name in NAMES}
        cls.shelved = rospy.Publisher("shelved", Int32MultiArray, latch=True, queue_size=1)
        cls.shelved.publish(Int32MultiArray())

    def setUp(self):
        self.core = self.start_core(uuid.uuid4().hex)

    def tearDown(self):
        self.assertTrue(self.core.silent(), "one message answers an action")
        self.core.die()
        for name, server in self.servers.items():
            self.assertTrue(server.idle(), f"{name} has got a goal too many")

    def start_core(self, run, under_way=()):
        self.run_id = run
        core = CoreSide(run, under_way)
        core.wait_for(NODE)
        return core

    def begin(self, name, cycle=3):
        """Begin an action of an interface; return the core's message, its return, and the server's goal."""
        number = next(GOALS)
        fact = f"_action_lib({name},{number},{cycle})"
        self.core.begin(name, fact)
        return fact, f"_return({name},{{}},{cycle})", number, self.servers[name].accept()

    def resume(self, *under_way):
        self.core = self.start_core(self.run_id, under_way)

    def kill_node(self, before_it_dies=lambda: None):
        """Kill the interface node and wait for the next one; the old one misses later events."""
        self.kill_deaf_node(before_it_dies)
        self.core.wait_for(NODE)

    def kill_deaf_node(self, before_it_dies=lambda: None):
        process = process_of(NODE)
        self.readers = self.servers["arm"].readers()
        os.kill(process, signal.SIGSTOP)
        stat = Path(f"/proc/{process}/stat")
        wait_until(lambda: stat.read_text().rpartition(")")[2].split()[0] == "T", "the node to stand still")
        before_it_dies()
        os.kill(process, signal.SIGKILL)
        wait_until(lambda: is_another(NODE, process), "the node to be started again")

    def settle(self):
        """Wait until the node has processed its earlier messages."""
        number = next(GOALS)
        self.core.send("drive", f"_action_lib(drive,{number},99)")
        self.servers["drive"].accept().set_succeeded()
        self.assertEqual(self.core.receive(), [f"_return(drive,{number},99)"])

    def wait_until_idle(self, name):
        """Wait until the interface reports no action under way."""
        wait_for_diagnosis(f"rosoclingo: interface {name}", is_idle, f"{name} to be idle")

    def answers(self, *returns):
        """Receive these returns, in any order, one in a message."""
        self.assertEqual(sorted(self.core.receive() for _ in returns), sorted([one] for one in returns))

    # ---- the core is killed ---------------------------------------------------------------------------------------

    def test_end_without_core_is_answered_on_repeat(self):
        fact, answer, _, goal = self.begin("arm")
        self.core.die()
        goal.set_aborted()
        self.resume(("arm", fact))
        self.assertEqual(self.core.receive(), [answer.format("failed")])

    def test_answered_action_is_answered_again(self):
        fact, answer, number, goal = self.begin("arm")
        goal.set_succeeded()
        self.assertEqual(self.core.receive(), [answer.format(number)])
        self.core.die()
        self.resume(("arm", fact))
        self.assertEqual(self.core.receive(), [answer.format(number)])

    def test_former_run_action_is_cancelled_without_return(self):
        fact, answer, number, _ = self.begin("arm")
        self.core.die()
        self.core = self.start_core(uuid.uuid4().hex)
        self.servers["arm"].cancelled().set_succeeded()
        self.settle()
        self.core.begin("arm", fact)  # same cycle, same name: it is another action
        self.servers["arm"].accept().set_succeeded()
        self.assertEqual(self.core.receive(), [answer.format(number)])

    # ---- the interface node is killed -----------------------------------------------------------------------------

    def test_action_unknown_to_all_is_interrupted(self):
        _, answer, _, goal = self.begin("arm")
        self.kill_node(goal.set_succeeded)
        self.assertEqual(self.core.receive(), [answer.format("interrupted")])

    def test_harmless_action_is_repeated(self):
        _, answer, number, goal = self.begin("drive")
        self.kill_node(goal.set_succeeded)
        self.servers["drive"].accept().set_succeeded()
        self.assertEqual(self.core.receive(), [answer.format(number)])

    def test_world_tells_whether_action_was_executed(self):
        (_, done, number, first), (_, undone, other, second) = (self.begin("shelf", cycle) for cycle in (3, 4))
        self.shelved.publish(Int32MultiArray(data=[0, number]))
        self.kill_node(lambda: (first.set_succeeded(), second.set_aborted()))
        self.servers["shelf"].accept().set_succeeded()
        self.answers(done.format(number), undone.format(other))

    def test_action_not_begun_is_executed(self):
        def send():
            self.core.begin("arm", "_action_lib(arm,0,4)")

        self.kill_node(send)
        self.servers["arm"].accept().set_succeeded()
        self.assertEqual(self.core.receive(), ["_return(arm,0,4)"])

    def test_full_disk_is_written_once_it_has_room(self):
        with room_for(0, process_of(NODE)):
            _, answer, number, goal = self.begin("arm")
            goal.set_succeeded()
            self.assertEqual(self.core.receive(), [answer.format(number)])
            trouble = "cannot write .*: continuing, but after a crash, actions begun now will be unknown"
            wait_for_diagnosis("rosoclingo: interface arm", lambda one: re.match(trouble, one.message), "the trouble")
        wait_for_diagnosis("rosoclingo: interface arm", lambda one: one.message == "idle", "its end")
        self.kill_node()
        self.assertEqual(self.core.receive(), [answer.format(number)])

    # ---- the action is cancelled ----------------------------------------------------------------------------------

    def test_world_tells_result_of_an_ignored_cancel(self):
        (done, answer, number, _), (undone, other, _, _) = (self.begin("stubborn", cycle) for cycle in (3, 4))
        self.shelved.publish(Int32MultiArray(data=[0, number]))
        for fact in (done, undone):
            self.core.cancel("stubborn", fact)
            self.servers["stubborn"].cancelled()
        self.answers(answer.format(number), other.format("server_lost"))

    # ---- the server is killed -------------------------------------------------------------------------------------

    def test_server_death_fails_only_the_action_without_effect(self):
        done, active = next(GOALS), []
        with Process(sys.executable, MORTAL) as server:
            topic = rospy.Subscriber("mortal/status", GoalStatusArray, lambda one: active.append(one.status_list))
            self.core.begin("mortal", f"_action_lib(mortal,{done},5)")
            self.core.begin("mortal", f"_action_lib(mortal,{next(GOALS)},6)")
            both = [GoalStatus.ACTIVE] * 2
            wait_until(lambda: active and [one.status for one in active[-1]] == both, "the goals to be active")
            topic.unregister()
            self.shelved.publish(Int32MultiArray(data=[0, done]))
            server.signal(signal.SIGKILL)
        with Process(sys.executable, MORTAL):
            self.answers(f"_return(mortal,{done},5)", "_return(mortal,server_lost,6)")

    # ---- both are killed ------------------------------------------------------------------------------------------

    def test_answer_survives_node_and_core_without_receipt(self):
        fact, answer, number, goal = self.begin("arm")
        self.core.die()
        goal.set_succeeded()
        self.wait_until_idle("arm")
        self.kill_deaf_node()
        self.resume(("arm", fact))
        self.assertEqual(self.core.receive(), [answer.format(number)])

    def test_goal_is_taken_over_after_both_were_killed(self):
        fact, answer, number, goal = self.begin("arm")
        self.core.die()
        self.kill_deaf_node()
        self.resume(("arm", fact))
        self.servers["arm"].wait_for_new_reader(NODE, self.readers)
        goal.set_succeeded()
        self.assertEqual(self.core.receive(), [answer.format(number)])
