"""Localisation from the ground truth, as the package fake_localization has it."""

import contextlib
import math
from collections import deque
from typing import Deque, Optional

import rospy
import tf2_ros
from geometry_msgs.msg import (
    Pose,
    PoseArray,
    PoseWithCovariance,
    PoseWithCovarianceStamped,
    TransformStamped,
)
from nav_msgs.msg import Odometry
from std_msgs.msg import Header
from tf2_msgs.msg import TFMessage

from rosoclingo.common.parameters import Parameters
from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.nodes.messages import fill_pose, fill_transform, from_transform, to_pose2d

SURE = [0.0] * 36  # the covariance of what is known


class FakeLocalizationNode:
    """Knows where the robot is because the simulator says so, and publishes it like amcl.

    Parameters
    ----------
        ~odom_frame_id (str, default "odom"), ~base_frame_id (str, default "base_link"),
            ~global_frame_id (str, default "map"): the frames of odometry, robot and map.
        ~delta_x, ~delta_y, ~delta_yaw (float, default 0.0): a point of the world is turned back by the yaw (rad), then
            moved back by x and y (m), and so has its place in the map.
        ~transform_tolerance (float, default 0.1): map -> odom is dated that far (s) into the future.
    Subscribes:
        base_pose_ground_truth (nav_msgs/Odometry)
        initialpose (geometry_msgs/PoseWithCovarianceStamped): moves the map so that the robot is there; in any frame.
        /tf, /tf_static (tf2_msgs/TFMessage)
    Publishes:
        amcl_pose (geometry_msgs/PoseWithCovarianceStamped, latched), particlecloud (geometry_msgs/PoseArray, latched)
        /tf (tf2_msgs/TFMessage): global_frame_id -> odom_frame_id

    """

    def __init__(self) -> None:
        given = Parameters()
        self._odom = given.at("odom_frame_id").text("odom").lstrip("/")
        self._base = given.at("base_frame_id").text("base_link").lstrip("/")
        self._global = given.at("global_frame_id").text("map").lstrip("/")
        self._world_in_map = Pose2D(*(-given.at("delta_" + axis).number(0.0) for axis in ("x", "y", "yaw")))
        self._tolerance = rospy.Duration(given.at("transform_tolerance").number(0.1, low=0.0))
        given.check()
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._pose = prompt_publisher("amcl_pose", PoseWithCovarianceStamped, 10, latch=True)
        self._cloud = prompt_publisher("particlecloud", PoseArray, 10, latch=True)
        self._tf = prompt_publisher("/tf", TFMessage)
        # When tf lags behind, the newest truth is not the one to use; so some are kept.
        self._waiting: Deque[Odometry] = deque(maxlen=200)
        self._truth: Optional[Pose2D] = None
        self._odom_in_map = Pose2D(0.0, 0.0)
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
        pose, frame = to_pose2d(message.pose.pose), message.header.frame_id.lstrip("/")
        if pose is None or not all(map(math.isfinite, pose)):
            rospy.logwarn("initialpose: not taken, its position is not finite or its orientation no turn about z")
            return
        if self._truth is None:
            rospy.logwarn("initialpose: not taken, there is no base_pose_ground_truth yet")
            return
        in_map = self._in_map(frame)
        if in_map is None:
            rospy.logwarn("initialpose: not taken, tf does not know %r; give it in the frame %s", frame, self._global)
            return
        self._world_in_map = in_map.compose(pose).compose(self._truth.inverse())

    def _in_map(self, frame: str) -> Optional[Pose2D]:
        """Return the newest pose of a frame in the map, None where there is none; an empty name is the map itself."""
        if frame in ("", self._global):
            return Pose2D(0.0, 0.0)
        # The robot's frames by way of odometry's: map to odom is dated ahead, and tf looks for times that both have.
        for parent, known in ((self._odom, self._odom_in_map), (self._global, Pose2D(0.0, 0.0))):
            with contextlib.suppress(tf2_ros.TransformException):
                found = self._buffer.lookup_transform_core(parent, frame, rospy.Time(0))
                return known.compose(from_transform(found.transform))
        return None

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
        if truth is None or not all(map(math.isfinite, truth)):
            rospy.logwarn_throttle(10.0, "base_pose_ground_truth: a pose is left out, as it is none in the plane")
            return
        self._truth = truth
        pose = self._world_in_map.compose(truth)
        self._odom_in_map = pose.compose(odometry.inverse())
        self._publish_transform(stamp, self._odom_in_map)
        self._publish_pose(stamp, pose)

    def _publish_transform(self, stamp: rospy.Time, odom_in_map: Pose2D) -> None:
        transform = TransformStamped()
        transform.header.stamp, transform.header.frame_id = stamp + self._tolerance, self._global
        transform.child_frame_id = self._odom
        fill_transform(transform.transform, odom_in_map)
        self._tf.publish(TFMessage([transform]))

    def _publish_pose(self, stamp: rospy.Time, pose: Pose2D) -> None:
        header = Header(0, stamp, self._global)
        place = Pose()
        fill_pose(place, pose)
        self._pose.publish(PoseWithCovarianceStamped(header, PoseWithCovariance(place, SURE)))
        self._cloud.publish(PoseArray(header, [place]))
