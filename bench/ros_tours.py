#!/usr/bin/env python3
"""Drives tours of random goals on an office floor with the nodes of this package, or with Stage and move_base.

Floor, obstacles that its map lacks, and figures are those of bench/tours.py, without events. The bench starts a
separate master, simulation.launch and navigation.launch. Collisions are the reports of this package's simulator, or
with Stage the times that the robot stands still despite its commands.

Run it in the built workspace: ./dev exec python3 bench/ros_tours.py
With Stage and move_base: ./dev --overlay WORKSPACE exec python3 bench/ros_tours.py --sim stage --nav move_base
"""

import math
import subprocess
import tempfile
import time
from pathlib import Path

import actionlib
import numpy as np
import rospy
import yaml
from actionlib_msgs.msg import GoalStatus
from figures import Option, main
from geometry_msgs.msg import Twist
from move_base_msgs.msg import MoveBaseAction, MoveBaseGoal
from nav_msgs.msg import Odometry
from PIL import Image
from ros_system import System
from std_msgs.msg import String
from tours import BODIES, Tour, Variant, drive_all, office_floor
from waiting import wait_until

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 300.0  # s of wall time, the limit of a goal


class NodesTour(Tour):
    """A tour whose robot the nodes drive; ``folder`` gets the files that they read."""

    clock = staticmethod(time.monotonic)

    def __init__(self, options, system, folder):
        variant, random = Variant(footprint=BODIES[options.body]), np.random.default_rng(options.seed)
        super().__init__(office_floor(options.seed), variant, random, 60, 0.0)
        self.write_map(folder)
        self.write_world(folder, options.drift)
        self.launch(options, system, folder)
        rospy.init_node("tours")
        self.watch = StageWatch() if options.sim == "stage" else SimulatorWatch()
        self.client = actionlib.SimpleActionClient("move_base", MoveBaseAction)
        wait_until(lambda: self.client.wait_for_server(rospy.Duration(20.0)), "move_base")

    def write_map(self, folder):
        """Write the map as map_server reads it."""
        grey = np.select([self.grid.cells == 100, self.grid.cells < 0], [0, 205], 254).astype(np.uint8)
        Image.fromarray(grey[::-1]).save(folder / "map.pgm")
        keys = {"image": "map.pgm", "resolution": self.grid.resolution, "origin": [0, 0, 0], "negate": 0}
        keys.update(occupied_thresh=0.65, free_thresh=0.196)
        (folder / "map.yaml").write_text(yaml.safe_dump(keys))

    def write_world(self, folder, drift):
        """Write the world file and the parameters of navigation."""
        footprint = [list(corner) for corner in self.variant.footprint]
        body = {"footprint": footprint} if footprint else {"radius": self.drive.robot.spec.radius}
        laser = {"range": 6.0, "angle": 270.25, "beams": 1081, "noise": self.variant.noise}
        pose = list(map(float, self.drive.robot.pose))
        robot = {"name": "robot", "pose": pose, "laser": laser, "drift": [drift, drift], **body}
        obstacles = [
            {"name": f"thing{one.name}", "at": list(map(float, one.at)), "radius": float(one.radius)}
            for one in self.world.obstacles.values()
        ]
        world = {"map": "map.yaml", "robots": [robot], "obstacles": obstacles}
        (folder / "world.yaml").write_text(yaml.safe_dump(world))
        navigation = yaml.safe_load((ROOT / "config" / "navigation.yaml").read_text())
        if footprint:
            del navigation["global_costmap"]["robot_radius"]
            navigation["global_costmap"]["footprint"] = footprint
        (folder / "navigation.yaml").write_text(yaml.safe_dump(navigation))

    def launch(self, options, system, folder):
        """Launch the simulator and navigation."""
        world, stage = folder / "world.yaml", folder / "stage.world"
        if options.sim == "stage":
            subprocess.run(["rosrun", "rosoclingo", "stage_world", str(world), "-o", str(stage)], check=True)
        own = options.sim == options.nav == options.localization == "rosoclingo"
        speed = options.speed if options.speed >= 0.0 else 0.0 if own else 5.0
        simulation = {"sim": options.sim, "world": world, "stage_world": stage, "speed": speed}
        navigation = {
            "nav": options.nav,
            "localization": options.localization,
            "map_server": "rosoclingo" if options.nav == "rosoclingo" else "map_server",
            "map": folder / "map.yaml",
            "navigation_config": folder / "navigation.yaml",
            "initial_pose": " ".join(map(str, self.drive.robot.pose)),
        }
        for name, arguments in (("simulation.launch", simulation), ("navigation.launch", navigation)):
            system.launch(name, *(f"{key}:={value}" for key, value in arguments.items()))

    @property
    def time(self):
        """The simulated time in seconds."""
        return rospy.get_time()

    @property
    def collisions(self):
        """The number of collisions so far."""
        return self.watch.collisions

    def drive_to(self, goal, points):
        """Send a goal to move_base; return whether it is reached, and why not."""
        target, end = MoveBaseGoal(), time.monotonic() + LIMIT
        target.target_pose.header.frame_id = "map"
        place, turn = target.target_pose.pose.position, target.target_pose.pose.orientation
        place.x, place.y, turn.z, turn.w = goal.x, goal.y, math.sin(0.5 * goal.yaw), math.cos(0.5 * goal.yaw)
        self.client.send_goal(target)
        while self.client.get_state() in (GoalStatus.PENDING, GoalStatus.ACTIVE) and time.monotonic() < end:
            time.sleep(0.02)
        here = rospy.wait_for_message("base_pose_ground_truth", Odometry, 30.0).pose.pose.position
        self.drive.robot.pose = self.drive.robot.pose._replace(x=here.x, y=here.y)  # the goal is judged from here
        return self.client.get_state() == GoalStatus.SUCCEEDED, self.client.get_goal_status_text()


class SimulatorWatch:
    """Counts the collisions that this package's simulator reports."""

    def __init__(self):
        self.collisions = 0
        rospy.Subscriber("simulator/collisions", String, self._on_report)

    def _on_report(self, message):
        self.collisions += message.data.startswith("robot ran into")


class StageWatch:
    """Counts as ``collisions`` how often a robot stands still for three poses despite a command that is not outdated.

    Stage stops a robot before it collides.
    """

    def __init__(self):
        self.collisions, self._still, self._pose, self._commanded = 0, 0, None, -math.inf
        rospy.Subscriber("cmd_vel", Twist, self._on_command, tcp_nodelay=True)
        rospy.Subscriber("base_pose_ground_truth", Odometry, self._on_truth, tcp_nodelay=True)

    def _on_command(self, message):
        moves = abs(message.linear.x) > 0.02 or abs(message.angular.z) > 0.05  # m/s, rad/s
        self._commanded = rospy.get_time() if moves else -math.inf

    def _on_truth(self, message):
        place, rotation = message.pose.pose.position, message.pose.pose.orientation
        before, self._pose = self._pose, (place.x, place.y, 2.0 * math.atan2(rotation.z, rotation.w))
        stands = before is not None and max(abs(a - b) for a, b in zip(before, self._pose)) < 1e-6
        fresh = 0.0 <= message.header.stamp.to_sec() - self._commanded <= 0.15
        self._still = self._still + 1 if stands and fresh else 0
        self.collisions += self._still == 3


def measure(options):
    """Drive a tour with the nodes; yield the figures."""
    with tempfile.TemporaryDirectory() as folder, System(simulated=True) as system:
        yield from drive_all([NodesTour(options, system, Path(folder))], options.goals)


if __name__ == "__main__":
    main(
        __doc__,
        measure,
        sim=Option("rosoclingo", "sim of simulation.launch", choices=["rosoclingo", "stage"]),
        nav=Option("rosoclingo", "nav of navigation.launch", choices=["rosoclingo", "move_base"]),
        localization=Option("rosoclingo", "localization of navigation.launch", choices=["rosoclingo", "fake", "amcl"]),
        speed=Option(-1.0, "simulated s per s, 0 for no limit; -1: 0, or 5 if a node is not of this package"),
        body=Option("disc", "body of the robot", choices=[*BODIES]),
        goals=Option(10, "number of goals", 2),
        drift=Option(0.0, "greatest relative error of odometry"),
        seed=Option(0, "seed of floor and goals"),
    )
