"""Topics of one simulated robot, as in stage_ros."""

import math
from typing import Callable, List, Sequence, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import TransformStamped, Twist
from nav_msgs.msg import Odometry
from rosgraph.names import is_legal_name
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan
from std_msgs.msg import Header

from rosoclingo.common.parameters import ParameterError
from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.nodes.messages import fill_pose, fill_transform, sendable
from rosoclingo.robot.simulation.simulated_robot import Laser, Robot

# Mounting height of the laser in stage_ros; only published in tf.
LASER_HEIGHT = 0.25
IDENTITY = Pose2D(0.0, 0.0)


class RobotTopics:
    """Publishers and command subscriber of one robot. Messages are only built for subscribers.

    ``prefix`` precedes topics and frames: empty for a single robot, else ``robot_0/`` and so on.
    """

    def __init__(self, robot: Robot, prefix: str, on_command: Callable[[float, float], None]) -> None:
        self._robot = robot
        self._odom = prompt_publisher(prefix + "odom", Odometry)
        self._truth = prompt_publisher(prefix + "base_pose_ground_truth", Odometry)
        odom, footprint = prefix + "odom", prefix + "base_footprint"
        self._odom_message = Odometry(header=Header(frame_id=odom), child_frame_id=footprint)
        self._truth_message = Odometry(header=Header(frame_id=odom))
        self._frames = [_transform(odom, footprint), _transform(footprint, prefix + "base_link")]
        # As in stage_ros, topics and frames of several lasers are numbered.
        endings = [f"_{i}" for i in range(len(robot.lasers))] if len(robot.lasers) > 1 else [""]
        self._scans = [_ScanTopic(prefix, ending, laser) for ending, laser in zip(endings, robot.lasers)]
        self._frames += [scans.frame for scans in self._scans]
        self._command = rospy.Subscriber(
            prefix + "cmd_vel", Twist, lambda twist: on_command(twist.linear.x, twist.angular.z), tcp_nodelay=True
        )

    def frames(self, stamp: rospy.Time) -> List[TransformStamped]:
        """Return the transforms odom -> base_footprint -> base_link -> base_laser_link at a time."""
        fill_transform(self._frames[0].transform, self._robot.odometry)
        for frame in self._frames:
            frame.header.stamp = stamp
        return self._frames

    def publish(self, stamp: rospy.Time, now: float, scan: Callable[[int], np.ndarray]) -> None:
        """Publish odometry and ground truth, and at each laser's rate the ranges ``scan(number)``."""
        robot = self._robot
        for publisher, message, pose, axes in (
            (self._odom, self._odom_message, robot.odometry, 0.0),
            (self._truth, self._truth_message, robot.pose, robot.pose.yaw),  # velocity in world axes, as in stage_ros
        ):
            if publisher.get_num_connections():
                message.header.stamp = stamp
                fill_pose(message.pose.pose, pose)
                twist = message.twist.twist
                twist.linear.x, twist.linear.y = robot.v * math.cos(axes), robot.v * math.sin(axes)
                twist.angular.z = robot.w
                publisher.publish(message)
        for i, scans in enumerate(self._scans):
            if scans.due(now):
                scans.publish(stamp, scan(i))


class _ScanTopic:
    """Topic and frame of one laser."""

    def __init__(self, prefix: str, ending: str, laser: Laser) -> None:
        self._spec = laser.spec
        child = prefix + "base_laser_link" + ending
        self.frame = _transform(prefix + "base_link", child, laser.spec.pose, LASER_HEIGHT)
        self._message = numpy_msg(LaserScan)(header=Header(frame_id=child))
        self._message.angle_min, self._message.angle_max = float(laser.angles[0]), float(laser.angles[-1])
        self._message.angle_increment = math.radians(laser.spec.angle) / (laser.spec.beams - 1)
        self._message.range_min, self._message.range_max = laser.spec.min_range, laser.spec.range
        self._publisher = prompt_publisher(prefix + "base_scan" + ending, numpy_msg(LaserScan))
        self._next = 0.0

    def due(self, now: float) -> bool:
        """Return whether a scan is due at a time (s) and has a subscriber."""
        if now < self._next - 1e-6:
            return False
        self._next = max(now, self._next + 1.0 / self._spec.rate)
        return bool(self._publisher.get_num_connections())

    def publish(self, stamp: rospy.Time, ranges: np.ndarray) -> None:
        """Publish a scan. As in Stage, the intensity is 1 for a hit and 0 otherwise."""
        self._message.header.stamp = stamp
        self._message.ranges = sendable(ranges)
        self._message.intensities = sendable((ranges < self._spec.range).astype(np.float32))
        self._publisher.publish(self._message)


def _transform(parent: str, child: str, pose: Pose2D = IDENTITY, height: float = 0.0) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = parent, child
    fill_transform(message.transform, pose)
    message.transform.translation.z = height
    return message


def prefixes(names: Sequence[str], use_names: bool) -> Tuple[str, ...]:
    """Return the prefixes of each robot's topics, as in stage_ros: empty for one robot, else ``robot_0/`` ...

    Raises ParameterError for the name of a robot that is not valid in a topic.
    """
    if len(names) == 1 and not use_names:
        return ("",)
    for name in names if use_names else ():
        if not is_legal_name(name + "/odom") or name.startswith(("/", "~")):
            raise ParameterError(
                f"the robot's name {name!r} is not valid in a topic, as ~use_model_names requires: "
                "use letters, digits, _ and /, beginning with a letter"
            )
    return tuple("{}/".format(name if use_names else f"robot_{i}") for i, name in enumerate(names))
