#!/usr/bin/env python3
"""Drives tours of random goals on an office floor with the nodes of this package, or with Stage and move_base.

The floor, 54 x 58.7 m at 0.1 m a cell, and 60 obstacles that its map lacks are those of bench/tours.py. The bench
starts a separate master, simulation.launch and navigation.launch. It prints how each goal ends, and counts collisions:
the reports of this package's simulator, or with Stage the times that the robot stands still despite its commands. A
goal that is not reached must be impossible: no path leads to it if all obstacles are 8 cm larger.

Run it in the built workspace: ./dev exec python3 bench/ros_tours.py
With Stage and move_base: ./dev --overlay WORKSPACE exec python3 bench/ros_tours.py --sim stage --nav move_base
"""

import math
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import rospy
import yaml
from actionlib_msgs.msg import GoalStatus
from figures import Figure, Option, main
from geometry_msgs.msg import Twist
from move_base_msgs.msg import MoveBaseGoal
from nav_msgs.msg import Odometry
from ros_system import System, move_base_client, pose_stamped, write_map
from std_msgs.msg import String
from tours import BODIES, SPARE, PlanOutcome, Tour, Variant, office_floor

ROOT = Path(__file__).resolve().parents[1]
LIMIT = 300.0  # s of wall time, the limit of a goal


def write_world(folder, tour, drift):
    """Write the map, the world file and the navigation parameters of a tour."""
    robot, footprint = tour.drive.robot, [list(corner) for corner in tour.variant.footprint]
    write_map(folder, tour.grid)
    body = {"footprint": footprint} if footprint else {"radius": robot.spec.radius}
    laser = {"range": 6.0, "angle": 270.25, "beams": 1081, "noise": tour.variant.noise}
    pose = list(map(float, robot.pose))
    things = tour.drive.world.obstacles.values()
    world = {
        "map": "map.yaml",
        "robots": [{"name": "robot", "pose": pose, "laser": laser, "drift": [drift, drift], **body}],
        "obstacles": [
            {"name": f"thing{one.name}", "at": list(map(float, one.at)), "radius": float(one.radius)} for one in things
        ],
    }
    (folder / "world.yaml").write_text(yaml.safe_dump(world))
    navigation = yaml.safe_load((ROOT / "config" / "navigation.yaml").read_text())
    if footprint:
        del navigation["global_costmap"]["robot_radius"]
        navigation["global_costmap"]["footprint"] = footprint
    (folder / "navigation.yaml").write_text(yaml.safe_dump(navigation))


def launch(system, folder, pose, options):
    """Launch the simulator and navigation for the world in ``folder``."""
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
        "initial_pose": " ".join(map(str, pose)),
    }
    for name, arguments in (("simulation.launch", simulation), ("navigation.launch", navigation)):
        system.launch(name, *(f"{key}:={value}" for key, value in arguments.items()))


class Stalls:
    """Counts the ``times`` that a robot stands still for three poses despite a command that is not outdated.

    Stage stops a robot before it collides.
    """

    def __init__(self):
        self.times, self._still, self._pose, self._commanded = 0, 0, None, -math.inf
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
        self.times += self._still == 3


def watch_collisions(sim):
    """Return a function that returns the number of collisions so far."""
    if sim == "stage":
        stalls = Stalls()
        return lambda: stalls.times
    reports = []
    rospy.Subscriber("simulator/collisions", String, lambda message: reports.append(message.data))
    return lambda: sum(text.startswith("robot ran into") for text in reports)


def go(client, tour, number):
    """Drive to a random pose and print the end; return "reached", "MISSED" or "impossible"."""
    target, since, end = tour.somewhere(), rospy.get_time(), time.monotonic() + LIMIT
    client.send_goal(MoveBaseGoal(pose_stamped(*target)))
    possible = tour.plan(target, SPARE, tour.variant.reach).outcome is PlanOutcome.FOUND
    while client.get_state() in (GoalStatus.PENDING, GoalStatus.ACTIVE) and time.monotonic() < end:
        time.sleep(0.02)
    reached = client.get_state() == GoalStatus.SUCCEEDED
    words = "reached" if reached else "MISSED" if possible else "impossible"
    took = rospy.get_time() - since
    print(f"goal {number}: {words} after {took:.0f} simulated s, {client.get_goal_status_text()}", flush=True)
    here = rospy.wait_for_message("base_pose_ground_truth", Odometry, 30.0).pose.pose.position
    tour.drive.robot.pose = tour.drive.robot.pose._replace(x=here.x, y=here.y)  # the next goal is judged from here
    return words


def measure(options):
    """Send the robot to one goal after the other and print how they end; yield the figures."""
    variant, random = Variant(footprint=BODIES[options.body]), np.random.default_rng(options.seed)
    tour = Tour(office_floor(options.seed), variant, random, 60, 0.0)
    with tempfile.TemporaryDirectory() as name, System(simulated=True) as system:
        write_world(Path(name), tour, options.drift)
        launch(system, Path(name), tour.drive.robot.pose, options)
        rospy.init_node("tours", anonymous=True)
        collisions, client = watch_collisions(options.sim), move_base_client()
        begin, wall = rospy.get_time(), time.monotonic()
        ends = [go(client, tour, number) for number in range(options.goals)]
        yield Figure("reached", ends.count("reached"), "goals", "higher")
        yield Figure("missed", ends.count("MISSED"), "goals")
        yield Figure("collisions", collisions(), "")
        pace = (rospy.get_time() - begin) / (time.monotonic() - wall)
        yield Figure("pace", pace, "simulated s per s", "higher")


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
