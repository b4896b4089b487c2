"""The markers node redraws labels, packages and plan at each change."""

import signal
import unittest
from pathlib import Path

import rospy
from documented_names import check_names
from interface_helpers import Process, executable, refuses, wait_until
from nav_msgs.msg import OccupancyGrid
from rosoclingo.msg import GoalState, GoalStates, PackageState, PackageStates, State, TaskPlan
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

from rosoclingo.nodes.rviz.markers import MarkersNode
from rosoclingo.runs.recorded_run import ProgramFile, RunProgram


class Markers(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.texts = {}
        cls.packages = rospy.Publisher("packages", PackageStates, queue_size=1, latch=True)
        cls.plan = rospy.Publisher("rosoclingo/task_plan", TaskPlan, queue_size=1, latch=True)
        cls.goals = rospy.Publisher("rosoclingo/goals", GoalStates, queue_size=1, latch=True)
        cls.program = rospy.Publisher("rosoclingo/program", String, queue_size=1, latch=True)
        cls.state = rospy.Publisher("rosoclingo/state", State, queue_size=1, latch=True)
        rospy.Subscriber("markers/markers", MarkerArray, cls.note)

    @classmethod
    def note(cls, message):
        assert message.markers[0].action == Marker.DELETEALL
        ids = [(marker.ns, marker.id) for marker in message.markers]
        assert len(ids) == len(set(ids))
        cls.texts = {
            ns: [marker.text for marker in message.markers if marker.ns == ns and marker.text] for ns, _ in ids
        }

    def test_names_match_the_reference_page(self):
        check_names("markers", "/markers", {})

    def test_goals_and_drawings_of_the_program_are_shown(self):
        self.goals.publish(
            goals=[GoalState(request="g(1)", status=1), GoalState(request="g(2)", status=5, reason="no")]
        )
        reported = ["goals: 1 open, 1 ended\ng(1): under way\ng(2): rejected (no)"]
        wait_until(lambda: self.texts.get("goals") == reported, "the goals")
        self.state.publish(cycle=1, atoms=["shut(office1,office2,now)", "lies(cup,office2,now)"])
        self.program.publish(String("no program"))
        text = '_draws(shut,blocked,"shut"). _draws(lies,thing).'
        self.program.publish(String(RunProgram("r", (ProgramFile("a.lp", text, False),), {}, "").text()))
        wait_until(lambda: self.texts.get("drawn") == ["shut"], "the blocked way")
        wait_until(lambda: self.texts.get("packages") == ["cup"], "the thing that is believed in")
        self.state.publish(cycle=2, atoms=[])
        wait_until(lambda: not self.texts.get("drawn"), "nothing to be blocked")

    def test_labels_packages_and_plan_are_shown(self):
        wait_until(lambda: self.texts.get("labels") == ["office1", "office2"], "the labels")
        self.packages.publish(packages=[PackageState("1", "office2", False), PackageState("2", "", True)])
        wait_until(lambda: self.texts.get("packages") == ["1", "2"], "the packages")
        self.plan.publish(cycle=1, actions=["_action_lib(move_base,office2,1)", "nonsense", "_action_lib(pickup,1,2)"])
        wait_until(
            lambda: self.texts.get("plan") == ["cycle 1: plan\n1. move_base office2  now\n2. pickup 1"], "the plan"
        )
        self.plan.publish(cycle=3, actions=[])
        wait_until(lambda: self.texts.get("plan") == ["cycle 3: idle"], "the idle plan")

    def test_rviz_ends_on_ctrl_c_while_it_waits_for_the_map(self):
        maps = rospy.Publisher("map", OccupancyGrid, queue_size=1)
        others = maps.get_num_connections
        wait_until(lambda: others() == 1, "the markers to wait for the map")
        config = str(Path(__file__).resolve().parents[3] / "config" / "mailbot.rviz")
        with Process(executable("rviz_on_map"), config) as process:
            wait_until(lambda: others() == 2, "rviz to wait for the map")
            process.signal(signal.SIGINT)
            self.assertEqual(process.wait(), (130, ""))

    def test_unusable_parameters_are_refused(self):
        rospy.set_param("~labels", {"a": [1, 2]})
        for name, value in (("panel", [1]), ("panel", 3), ("robot_radius", "wide")):
            refuses(MarkersNode, name, **{name: value})
