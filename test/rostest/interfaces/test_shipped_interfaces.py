"""move_base, pickup and deliver: every end of a goal becomes the right return."""

import unittest

from documented_names import check_names
from interface_helpers import CoreSide, Server
from move_base_msgs.msg import MoveBaseAction
from rosoclingo.msg import DeliverAction, DeliverResult, PickupAction, PickupResult


class ShippedInterfaces(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.core = CoreSide()
        cls.move_base = Server("move_base", MoveBaseAction)
        cls.pickup = Server("pickup", PickupAction)
        cls.deliver = Server("deliver", DeliverAction)
        cls.core.wait_for("move_base_interface", "pickup_interface", "deliver_interface")

    def tearDown(self):
        self.assertTrue(self.core.silent(), "exactly one message answers an action")

    def move(self, cycle, label="office2"):
        self.core.send("move_base", f"_action_lib(move_base,{label},{cycle})")

    def test_names_match_the_reference_page(self):
        check_names("interface", "/move_base_interface", {"SERVER": ("move_base", "move_base_msgs/MoveBaseAction")})

    def test_success_returns_the_label(self):
        self.move(1)
        handle = self.move_base.accept()
        pose = handle.get_goal().target_pose
        self.assertEqual((pose.header.frame_id, pose.pose.position.x, pose.pose.position.y), ("map", 3.0, 4.0))
        self.assertAlmostEqual(pose.pose.orientation.z, 0.7071, places=3)
        handle.set_succeeded(text="Goal reached.")
        self.assertEqual(self.core.receive(), ["_return(move_base,office2,1)"])

    def test_abort_returns_the_reason(self):
        for cycle, (text, reason) in enumerate(
            [
                ("Failed to find a valid plan. Even after executing recovery behaviors.", "blocked"),
                ("Failed to find a valid control. Even after executing recovery behaviors.", "blocked"),
                ("Robot is oscillating. Even after executing recovery behaviors.", "blocked"),
                ("Failed to find a valid plan. Every path to the goal is blocked by something", "blocked"),
                ("Failed to find a valid plan: no path leads to the goal on the map", "unreachable"),
                ("Robot makes no progress", "blocked"),
                ("the laser is silent", "sensor_lost"),
                ("localisation lost", "not_localized"),
                ("out of coffee", "failed"),
            ],
            start=1,
        ):
            self.move(cycle)
            self.move_base.accept().set_aborted(text=text)
            self.assertEqual(self.core.receive(), [f"_return(move_base,{reason},{cycle})"])

    def test_unknown_label_is_a_reason(self):
        self.assertEqual(
            self.core.run("move_base", "_action_lib(move_base,cellar,1)"), ["_return(move_base,unknown_label,1)"]
        )

    def test_unreadable_message_is_dropped_alone(self):
        self.core.send(
            "move_base", "nonsense(", "_action_lib(move_base,office1)", "_action_lib(move_base,office1,1)", ""
        )
        self.move_base.accept().set_succeeded()
        self.assertEqual(self.core.receive(), ["_return(move_base,office1,1)"])

    def test_repeated_command_is_run_once(self):
        self.move(1)
        handle = self.move_base.accept()
        self.move(1)
        self.core.send("move_base", "_cancel(move_base,office1,9)")
        self.move(2, "office1")
        other = self.move_base.accept()
        other.set_succeeded()
        self.assertEqual(self.core.receive(), ["_return(move_base,office1,2)"])
        handle.set_succeeded()
        self.assertEqual(self.core.receive(), ["_return(move_base,office2,1)"])

    def test_packages_are_picked_up_and_delivered(self):
        for server, name, result in ((self.pickup, "pickup", PickupResult), (self.deliver, "deliver", DeliverResult)):
            self.core.send(name, f"_action_lib({name},7,3)")
            handle = server.accept()
            self.assertEqual(handle.get_goal().package, "7")
            handle.set_succeeded(result(outcome=result.SUCCEEDED, location="office3"))
            self.assertEqual(self.core.receive(), [f"_return({name},7,3)"])
            for outcome, reason in (
                (result.FAILED, "failed"),
                (result.UNKNOWN_PACKAGE, "unknown_package"),
                (result.NOT_HERE, "not_here"),
                (result.NOT_AT_LABEL, "not_at_label"),
                (result.FULL, "full"),
                (result.NOT_CARRIED, "not_carried"),
            ):
                self.core.send(name, f"_action_lib({name},7,3)")
                server.accept().set_aborted(result(outcome=outcome))
                self.assertEqual(self.core.receive(), [f"_return({name},{reason},3)"])
