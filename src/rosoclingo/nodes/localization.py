"""Localisation from the ground truth, as the package fake_localization has it."""

from collections import deque
from typing import Any, Deque, Optional

import rospy
import tf2_ros
from geometry_msgs.msg import PoseArray, PoseWithCovarianceStamped, TransformStamped
from nav_msgs.msg import Odometry
from tf2_msgs.msg import TFMessage

from rosoclingo.navigation.geometry import Pose2D, quaternion_to_yaw, yaw_to_quaternion
from rosoclingo.nodes.parameters import not_negative, parameter
from rosoclingo.nodes.prompt_publisher import prompt_publisher
from rosoclingo.nodes.worker import Worker


def to_pose2d(pose: Any) -> Optional[Pose2D]:
    """Return a geometry_msgs/Pose in the plane; None where its orientation is none."""
    yaw = quaternion_to_yaw(pose.orientation.x, pose.orientation.y, pose.orientation.z, pose.orientation.w)
    return None if yaw is None else Pose2D(pose.position.x, pose.position.y, yaw)


def from_transform(transform: Any) -> Pose2D:
    """Return a geometry_msgs/Transform in the plane; yaw 0 where its rotation is none."""
    rotation = transform.rotation
    yaw = quaternion_to_yaw(rotation.x, rotation.y, rotation.z, rotation.w)
    return Pose2D(transform.translation.x, transform.translation.y, yaw or 0.0)


def fill_pose(message: Any, pose: Pose2D) -> None:
    """Write a pose into a geometry_msgs/Pose."""
    message.position.x, message.position.y = pose.x, pose.y
    quaternion = yaw_to_quaternion(pose.yaw)
    message.orientation.x, message.orientation.y, message.orientation.z, message.orientation.w = quaternion


class FakeLocalizationNode:
    """Knows where the robot is because the simulator says so, and publishes it like amcl.

    Parameters
    ----------
        ~odom_frame_id (string, "odom"), ~base_frame_id (string, "base_link"), ~global_frame_id (string, "map")
        ~delta_x, ~delta_y, ~delta_yaw (float, 0.0): the map's frame in the world's (m, rad).
        ~transform_tolerance (float, 0.1): map -> odom is dated that far (s) into the future.
    Subscribes:
        base_pose_ground_truth (nav_msgs/Odometry)
        initialpose (geometry_msgs/PoseWithCovarianceStamped): moves the map so that the robot is there.
        /tf, /tf_static
    Publishes:
        amcl_pose (geometry_msgs/PoseWithCovarianceStamped), particlecloud (geometry_msgs/PoseArray)
        /tf (tf2_msgs/TFMessage): global_frame_id -> odom_frame_id

    """

    def __init__(self) -> None:
        self._odom = parameter("~odom_frame_id", str, "odom").lstrip("/")
        self._base = parameter("~base_frame_id", str, "base_link").lstrip("/")
        self._global = parameter("~global_frame_id", str, "map").lstrip("/")
        delta = (float(parameter("~delta_" + axis, float, 0.0)) for axis in ("x", "y", "yaw"))
        self._world_in_map = Pose2D(*delta).inverse()
        self._tolerance = rospy.Duration(not_negative("~transform_tolerance", 0.1))
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._pose = prompt_publisher("amcl_pose", PoseWithCovarianceStamped, 10)
        self._cloud = prompt_publisher("particlecloud", PoseArray, 10)
        self._tf = prompt_publisher("/tf", TFMessage)
        # When tf lags behind, the newest truth is not the one to use; so some are kept.
        self._waiting: Deque[Odometry] = deque(maxlen=200)
        self._truth: Optional[Pose2D] = None
        self._worker = Worker(settle=self._settle)
        self._worker.start()
        self._subscribers = (
            rospy.Subscriber("base_pose_ground_truth", Odometry, self._on_truth, queue_size=10, tcp_nodelay=True),
            rospy.Subscriber("initialpose", PoseWithCovarianceStamped, self._on_initial_pose),
        )
        rospy.on_shutdown(lambda: self._worker.stop(2.0))

    def _on_truth(self, message: Odometry) -> None:
        self._worker.put(lambda: self._take(message))

    def _on_initial_pose(self, message: PoseWithCovarianceStamped) -> None:
        self._worker.put(lambda: self._move_map(message))

    def _take(self, message: Odometry) -> None:
        self._waiting.append(message)

    def _move_map(self, message: PoseWithCovarianceStamped) -> None:
        pose = to_pose2d(message.pose.pose)
        if pose is None or self._truth is None:
            rospy.logwarn("initialpose: not taken, %s", "its orientation is invalid" if pose is None else "no pose yet")
            return
        # A pose in another frame (odom) is taken as it is, as fake_localization does where it cannot transform.
        self._world_in_map = pose.compose(self._truth.inverse())

    def _settle(self) -> None:
        """Publish where the newest truth puts the robot for whose time odometry is known."""
        for message in reversed(self._waiting):
            stamp = message.header.stamp
            try:
                odometry = from_transform(self._buffer.lookup_transform_core(self._odom, self._base, stamp).transform)
                break
            except tf2_ros.TransformException:
                continue
        else:
            return
        while self._waiting and self._waiting.popleft() is not message:
            pass
        truth = to_pose2d(message.pose.pose)
        if truth is None:
            return
        self._truth = truth
        pose = self._world_in_map.compose(truth)
        self._publish_transform(stamp, pose.compose(odometry.inverse()))
        self._publish_pose(stamp, pose)

    def _publish_transform(self, stamp: rospy.Time, map_to_odom: Pose2D) -> None:
        transform = TransformStamped()
        transform.header.stamp, transform.header.frame_id = stamp + self._tolerance, self._global
        transform.child_frame_id = self._odom
        transform.transform.translation.x, transform.transform.translation.y = map_to_odom.x, map_to_odom.y
        _, _, transform.transform.rotation.z, transform.transform.rotation.w = yaw_to_quaternion(map_to_odom.yaw)
        self._tf.publish(TFMessage([transform]))

    def _publish_pose(self, stamp: rospy.Time, pose: Pose2D) -> None:
        if self._pose.get_num_connections():
            message = PoseWithCovarianceStamped()
            message.header.stamp, message.header.frame_id = stamp, self._global
            fill_pose(message.pose.pose, pose)
            self._pose.publish(message)
        if self._cloud.get_num_connections():
            cloud = PoseArray()
            cloud.header.stamp, cloud.header.frame_id = stamp, self._global
            particle = PoseWithCovarianceStamped().pose.pose
            fill_pose(particle, pose)
            cloud.poses = [particle]
            self._cloud.publish(cloud)
