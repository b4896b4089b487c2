"""What the simulator publishes for one robot, as stage_ros does."""

import math
from typing import Callable, List, Optional, Sequence, Tuple

import numpy as np
import rospy
from geometry_msgs.msg import Pose, Quaternion, TransformStamped, Twist
from nav_msgs.msg import Odometry
from rosgraph.names import is_legal_name
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan

from rosoclingo.navigation.geometry import Pose2D, yaw_to_quaternion
from rosoclingo.nodes.parameters import ParameterError
from rosoclingo.nodes.prompt_publisher import prompt_publisher
from rosoclingo.simulation import Robot

# stage_ros mounts the laser there; a planar world has no use for it.
LASER_HEIGHT = 0.25


class RobotTopics:
    """Publishers and the command subscriber of one robot; messages are built only for those who listen.

    ``prefix`` is put before topics and frames: empty for the only robot, else ``robot_0/`` and so on.
    """

    def __init__(self, robot: Robot, prefix: str, on_command: Callable[[float, float], None]) -> None:
        self._robot = robot
        self._odom = prompt_publisher(prefix + "odom", Odometry)
        self._truth = prompt_publisher(prefix + "base_pose_ground_truth", Odometry)
        self._odom_message = _odometry(prefix + "odom", prefix + "base_footprint")
        self._truth_message = _odometry(prefix + "odom", "")
        self._frames = _frames(prefix)
        self._scan: Optional[rospy.Publisher] = None
        if robot.laser:
            spec = robot.laser.spec
            self._frames.append(_transform(prefix + "base_link", prefix + "base_laser_link"))
            _set_transform(self._frames[-1], spec.pose)
            self._frames[-1].transform.translation.z = LASER_HEIGHT
            self._scan = prompt_publisher(prefix + "base_scan", numpy_msg(LaserScan))
            self._scan_message = _scan(prefix + "base_laser_link", robot)
            self._scans, self._next_scan = 0, 0.0
        self._command = rospy.Subscriber(
            prefix + "cmd_vel", Twist, lambda twist: on_command(twist.linear.x, twist.angular.z), tcp_nodelay=True
        )

    def frames(self, stamp: rospy.Time) -> List[TransformStamped]:
        """Return the robot's transforms at a time: odom to base_footprint to base_link to base_laser_link."""
        _set_transform(self._frames[0], self._robot.odometry)
        for frame in self._frames:
            frame.header.stamp = stamp
        return self._frames

    def publish(self, stamp: rospy.Time, now: float, scan: Callable[[], np.ndarray]) -> None:
        """Publish odometry, truth and, at the laser's rate, what ``scan`` returns."""
        robot = self._robot
        for publisher, message, pose, axes in (
            (self._odom, self._odom_message, robot.odometry, 0.0),
            (self._truth, self._truth_message, robot.pose, robot.pose.yaw),  # stage_ros: along the world's axes
        ):
            if publisher.get_num_connections():
                message.header.stamp = stamp
                _set_pose(message.pose.pose, pose)
                twist = message.twist.twist
                twist.linear.x, twist.linear.y = robot.v * math.cos(axes), robot.v * math.sin(axes)
                twist.angular.z = robot.w
                publisher.publish(message)
        if self._scan is not None and robot.laser is not None and now >= self._next_scan - 1e-6:
            self._next_scan = max(now, self._next_scan + 1.0 / robot.laser.spec.rate)
            if self._scan.get_num_connections():
                self._scan_message.header.stamp = stamp
                self._scan_message.ranges = scan()
                self._scan.publish(self._scan_message)


def _frames(prefix: str) -> List[TransformStamped]:
    return [
        _transform(prefix + "odom", prefix + "base_footprint"),
        _transform(prefix + "base_footprint", prefix + "base_link"),
    ]


def _transform(parent: str, child: str) -> TransformStamped:
    message = TransformStamped()
    message.header.frame_id, message.child_frame_id = parent, child
    message.transform.rotation.w = 1.0
    return message


def _odometry(frame: str, child: str) -> Odometry:
    message = Odometry()
    message.header.frame_id, message.child_frame_id = frame, child
    return message


def _scan(frame: str, robot: Robot) -> LaserScan:
    message = numpy_msg(LaserScan)()
    if robot.laser is not None:
        spec, angles = robot.laser.spec, robot.laser.angles
        message.angle_min, message.angle_max = float(angles[0]), float(angles[-1])
        message.angle_increment = math.radians(spec.angle) / (spec.beams - 1)
        message.range_min, message.range_max = spec.min_range, spec.range
        message.intensities = np.zeros(spec.beams, dtype=np.float32)
    message.header.frame_id = frame
    return message


def _set_transform(message: TransformStamped, pose: Pose2D) -> None:
    message.transform.translation.x, message.transform.translation.y = pose.x, pose.y
    _, _, message.transform.rotation.z, message.transform.rotation.w = yaw_to_quaternion(pose.yaw)


def _set_pose(message: Pose, pose: Pose2D) -> None:
    message.position.x, message.position.y = pose.x, pose.y
    message.orientation = Quaternion(*yaw_to_quaternion(pose.yaw))


def prefixes(names: Sequence[str], use_names: bool) -> Tuple[str, ...]:
    """Return what stage_ros puts before the topics of each robot: nothing for one, ``robot_0/`` .. for several.

    Raises ParameterError for a robot's name that cannot be a topic's.
    """
    if len(names) == 1 and not use_names:
        return ("",)
    for name in names if use_names else ():
        if not is_legal_name(name + "/odom") or name.startswith(("/", "~")):
            raise ParameterError(
                f"the robot's name {name!r} cannot begin the names of topics, as ~use_model_names has it: "
                "only letters, digits, _ and /, beginning with a letter"
            )
    return tuple("{}/".format(name if use_names else f"robot_{i}") for i, name in enumerate(names))
