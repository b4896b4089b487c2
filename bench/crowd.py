"""Disturbances for tours: people who walk around, and a robot that is moved to another pose."""

import math
import subprocess
import time
from typing import Tuple

import numpy as np

__all__ = ["PREFIX", "Walker", "carry", "launch_text", "walk"]

PREFIX = "robot_0/"  # prefix of topics and frames of the robot on tour if there are several robots
STEPS = (1.5, 6.0)  # range of seconds for which a person walks in one direction
PACE, TURN = 0.5, 1.5  # m/s, rad/s
FACING = 0.2  # rad

NAVIGATION = """<launch>
  <include file="$(find rosoclingo)/launch/navigation.launch">
    <arg name="nav" value="none"/>
    <arg name="localization" value="none"/>
    <arg name="map_server" value="{map_server}"/>
    <arg name="map" value="{map}"/>
  </include>
  <group ns="robot_0">
    <remap from="map" to="/map"/>
    <remap from="static_map" to="/static_map"/>
    <include file="$(find rosoclingo)/launch/navigation.launch">
      <arg name="map_server" value="none"/>
      <arg name="frame_prefix" value="robot_0/"/>
      <arg name="nav" value="{nav}"/>
      <arg name="localization" value="{localization}"/>
      <arg name="navigation_config" value="{navigation}"/>
      <arg name="initial_pose" value="{start}"/>
    </include>
  </group>
</launch>
"""


def launch_text(**words: str) -> str:
    """Return a launch file for the navigation of the first of several robots."""
    return NAVIGATION.format(**words)


class Walker:
    """A person, a disc that walks straight for a while and then turns on the spot to another direction."""

    def __init__(self, random: np.random.Generator) -> None:
        self._random = random
        self._yaw, self._until = 0.0, -math.inf

    def command(self, now: float, yaw: float) -> Tuple[float, float]:
        """Return the velocities (m/s, rad/s) at the time ``now`` (s) and the present ``yaw`` (rad)."""
        if now >= self._until or now < self._until - STEPS[1]:
            self._yaw, self._until = self._random.uniform(-math.pi, math.pi), now + self._random.uniform(*STEPS)
        error = math.remainder(self._yaw - yaw, 2.0 * math.pi)
        turn = max(-TURN, min(TURN, 2.0 * error))
        return (PACE if abs(error) < FACING else 0.0), turn


def walk(count: int, seed: int) -> list:
    """Let all robots except the first walk around; return the subscribers that control them."""
    import rospy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry

    def start(number: int):
        walker = Walker(np.random.default_rng((seed, number)))
        publisher = rospy.Publisher(f"robot_{number}/cmd_vel", Twist, queue_size=1, tcp_nodelay=True)

        def on_truth(message) -> None:
            turned = message.pose.pose.orientation
            twist = Twist()
            now = message.header.stamp.to_sec()
            twist.linear.x, twist.angular.z = walker.command(now, 2.0 * math.atan2(turned.z, turned.w))
            publisher.publish(twist)

        return rospy.Subscriber(f"robot_{number}/base_pose_ground_truth", Odometry, on_truth, tcp_nodelay=True)

    return [start(number) for number in range(1, count + 1)]


def carry(sim: str, prefix: str, pose) -> None:
    """Move the robot to a pose (m, rad), in Stage to its start, and publish the pose on initialpose."""
    import rospy
    from geometry_msgs.msg import PoseWithCovarianceStamped
    from nav_msgs.msg import Odometry
    from std_srvs.srv import Empty

    if sim == "stage":
        rospy.ServiceProxy("reset_positions", Empty)()
    else:
        # A separate process, because this one has the sources on its path and not the generated messages.
        request = "{{robot: robot, x: {}, y: {}, yaw: {}}}".format(*pose)
        command = ["rosservice", "call", "simulator/set_pose", request]
        answer = subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout.decode()
        if "success: True" not in answer:
            raise RuntimeError(answer)
    for _ in range(3):  # the first message can be older than the move
        truth = rospy.wait_for_message(prefix + "base_pose_ground_truth", Odometry, 30.0)
    initial = PoseWithCovarianceStamped()
    initial.header.frame_id, initial.header.stamp, initial.pose.pose = "map", truth.header.stamp, truth.pose.pose
    initial.pose.covariance[0] = initial.pose.covariance[7] = 0.04
    initial.pose.covariance[35] = 0.03
    publisher = rospy.Publisher(prefix + "initialpose", PoseWithCovarianceStamped, queue_size=1)
    end = time.monotonic() + 20.0
    while not publisher.get_num_connections() and time.monotonic() < end:
        time.sleep(0.05)
    publisher.publish(initial)
    rospy.sleep(1.0)
