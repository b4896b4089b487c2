"""Localisation node from the ground truth, with the interface of fake_localization."""

import contextlib
import math
from collections import deque
from functools import partial
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

EXACT_COVARIANCE = [0.0] * 36  # covariance of an exact pose


class FakeLocalizationNode:
    """Publishes the ground truth of the simulator as a localisation, as amcl would.

    Parameters
    ----------
        ~odom_frame_id (str, default "odom"), ~base_frame_id (str, default "base_link"),
            ~global_frame_id (str, default "map"): the frames of odometry, robot and map.
        ~delta_x, ~delta_y, ~delta_yaw (float, default 0.0): offset (m, rad) between world and map. A point of the
            world is rotated by -yaw, then moved by -x and -y.
        ~transform_tolerance (float, default 0.1): seconds by which map -> odom is dated into the future.
    Subscribes:
        base_pose_ground_truth (nav_msgs/Odometry)
        initialpose (geometry_msgs/PoseWithCovarianceStamped): moves the map so that the robot has this pose, which can
            be in any frame.
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
        # tf can lag behind: keep some messages, to use one whose time tf knows.
        self._waiting: Deque[Odometry] = deque(maxlen=200)
        self._truth: Optional[Pose2D] = None
        self._odom_in_map = Pose2D(0.0, 0.0)
        self._worker = Worker(settle=self._settle)
        self._worker.start()
        self._subscribers = (
            rospy.Subscriber(
                "base_pose_ground_truth",
                Odometry,
                partial(self._worker.put, self._waiting.append),
                queue_size=10,
                tcp_nodelay=True,
            ),
            rospy.Subscriber("initialpose", PoseWithCovarianceStamped, partial(self._worker.put, self._move_map)),
        )
        rospy.on_shutdown(lambda: self._worker.stop(2.0))

    def _move_map(self, message: PoseWithCovarianceStamped) -> None:
        pose, frame = to_pose2d(message.pose.pose), message.header.frame_id.lstrip("/")
        if pose is None or not all(map(math.isfinite, pose)):
            rospy.logwarn("initialpose ignored: its position is not finite, or its rotation is not about the z axis")
            return
        if self._truth is None:
            rospy.logwarn("initialpose ignored: there is no base_pose_ground_truth yet")
            return
        in_map = self._in_map(frame)
        if in_map is None:
            rospy.logwarn("initialpose ignored: tf does not know frame %r; use the frame %s", frame, self._global)
            return
        self._world_in_map = in_map.compose(pose).compose(self._truth.inverse())

    def _in_map(self, frame: str) -> Optional[Pose2D]:
        """Return the newest pose of a frame in the map, or None. An empty name is the map frame."""
        if frame in ("", self._global):
            return Pose2D(0.0, 0.0)
        # Frames of the robot go through the odometry frame: map -> odom is dated into the future, and tf only uses
        # times at which both transforms are known.
        for parent, known in ((self._odom, self._odom_in_map), (self._global, Pose2D(0.0, 0.0))):
            with contextlib.suppress(tf2_ros.TransformException):
                found = self._buffer.lookup_transform_core(parent, frame, rospy.Time(0))
                return known.compose(from_transform(found.transform))
        return None

    def _settle(self) -> None:
        """Publish the pose of the newest ground truth whose odometry is known."""
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
            rospy.logwarn_throttle(10.0, "base_pose_ground_truth: pose ignored: it is not a finite pose in the plane")
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
        self._pose.publish(PoseWithCovarianceStamped(header, PoseWithCovariance(place, EXACT_COVARIANCE)))
        self._cloud.publish(PoseArray(header, [place]))
