"""Inputs of the move_base node: tf, laser and odometry."""

import math
from functools import partial
from typing import Any, NamedTuple, Optional, Tuple

import numpy as np
import rospy
import tf2_ros
from nav_msgs.msg import Odometry
from rospy.numpy_msg import numpy_msg
from sensor_msgs.msg import LaserScan

from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D, normalize_angle
from rosoclingo.robot.navigation.local_planner import Velocity
from rosoclingo.robot.nodes.messages import from_transform
from rosoclingo.robot.nodes.move_base.navigation_settings import Settings

# Maximum lead (s) of time stamps over this node's clock. Beyond it, time has gone back.
STAMP_LEAD_LIMIT = 0.3
# Assumed delay (s) of scans against their stamps, with an uncertainty of the same size: Stage stamps them a step late.
SCAN_DELAY = 0.05
NEWEST = rospy.Time(0)


class LocatedRobot(NamedTuple):
    """Pose of the robot. ``fault``: why the pose is unknown (None) or too old to drive."""

    pose: Optional[Pose2D]
    fault: str = ""


class Sensing:
    """Stores the latest scan and odometry, and looks up poses.

    The transform map -> base is looked up in two parts: the newest map -> odom, which changes slowly, and odom -> base
    at the requested time. A localisation that lags a little therefore does no harm.
    """

    def __init__(self, settings: Settings, worker: Worker) -> None:
        self._settings, self._map_frame = settings, settings.map_frame
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)
        self._odom_frame = "odom"
        self._odom_in_map: Optional[Pose2D] = None  # as of the last localisation
        self._scan: Optional[Any] = None
        self.velocity = Velocity()
        self.scanned_at = -math.inf
        self._since = rospy.get_time()
        self._stamped = 0.0
        self._subscribers = [
            rospy.Subscriber(
                "odom",
                Odometry,
                partial(worker.put, self._take_odom),
                queue_size=1,
                tcp_nodelay=True,
                buff_size=1 << 17,
            )
        ]
        if settings.obstacles:
            self._subscribers.append(
                rospy.Subscriber(
                    settings.scan_topic, numpy_msg(LaserScan), partial(worker.put, self._take_scan), queue_size=1,
                    tcp_nodelay=True, buff_size=1 << 17,
                )
            )  # fmt: skip

    def _take_odom(self, message: Odometry) -> None:
        self._odom_frame = message.header.frame_id.lstrip("/") or self._odom_frame
        self._stamped = message.header.stamp.to_sec()
        velocity = Velocity(message.twist.twist.linear.x, message.twist.twist.angular.z)
        self.velocity = velocity if all(map(math.isfinite, velocity)) else Velocity()

    def _take_scan(self, message: LaserScan) -> None:
        if not (
            math.isfinite(message.angle_min) and math.isfinite(message.angle_increment) and message.range_max > 0.0
        ):
            rospy.logwarn_throttle(10.0, "scan ignored: its angles or its range_max are invalid")
            return
        self._scan = message
        self.scanned_at = message.header.stamp.to_sec()

    def now(self) -> float:
        """Return the present time (s). The stamp of the odometry is used while its clock message has not arrived yet.

        Otherwise a simulator that runs as fast as it can would wait for a command that waits for the clock.
        """
        clock = rospy.get_time()
        return self._stamped if clock < self._stamped < clock + STAMP_LEAD_LIMIT else clock

    def locate(self, now: float) -> LocatedRobot:
        """Return the pose of the robot in the map at the present time (s)."""
        pose, late = Pose2D(0.0, 0.0), ""
        for parent, child in ((self._map_frame, self._odom_frame), (self._odom_frame, self._settings.base_frame)):
            found = self._stamped_lookup(parent, child, NEWEST)
            if found is None:
                self._odom_in_map = None
                return LocatedRobot(None, f"there is no transform from {parent} to {child}")
            part, stamp = found
            if child == self._odom_frame:
                self._odom_in_map = part
            pose = pose.compose(part)
            if not late and stamp > 0.0 and now - stamp > self._settings.transform_tolerance:
                late = f"the transform from {parent} to {child} is {now - stamp:.1f} s old"
        return LocatedRobot(pose, late)

    def laser_age(self, now: float) -> float:
        """Return the age (s) of the newest scan."""
        return now - max(self.scanned_at, self._since)

    def time_went_back(self, now: float) -> None:
        """Drop messages and transforms with stamps in the future."""
        self._buffer.clear()
        self._scan, self.scanned_at, self._since = None, -math.inf, now

    def observe(self, costmap: Costmap) -> bool:
        """Enter a new scan into the costmap. Return whether that changed it."""
        scan = self._scan
        if scan is None:
            return False
        frame, stamp = scan.header.frame_id.lstrip("/"), scan.header.stamp
        earlier = rospy.Time.from_sec(max(0.0, stamp.to_sec() - SCAN_DELAY))
        newest, pose = self._laser_pose(frame, stamp), self._laser_pose(frame, earlier)
        if newest is None:  # odometry of that time can still arrive
            return False
        self._scan = None
        ranges = np.asarray(scan.ranges, dtype=np.float64)
        angles = scan.angle_min + scan.angle_increment * np.arange(len(ranges))
        ranges = np.where(ranges < scan.range_min, np.nan, ranges)
        pose = pose or newest
        smear = abs(normalize_angle(newest.yaw - pose.yaw))
        return costmap.observe(pose, angles, ranges, scan.range_max, smear)

    def _laser_pose(self, frame: str, stamp: rospy.Time) -> Optional[Pose2D]:
        """Return the pose of a laser in the map at a time, or None if unknown."""
        in_odom = self._lookup(self._odom_frame, frame, stamp)
        return self._odom_in_map.compose(in_odom) if self._odom_in_map is not None and in_odom else None

    def to_map(self, frame: str, stamp: rospy.Time) -> Optional[Pose2D]:
        """Return the pose of a frame in the map, or None if unknown. An empty name is the map frame."""
        frame = frame.lstrip("/")
        if frame in ("", self._map_frame):
            return Pose2D(0.0, 0.0, 0.0)
        return self._lookup(self._map_frame, frame, stamp) or self._lookup(self._map_frame, frame, NEWEST)

    def local_frame(self) -> Tuple[str, Pose2D]:
        """Return the frame of the local costmap and its pose in the map; the map frame if that is unknown."""
        frame = self._settings.local_frame or self._odom_frame
        known = self._odom_in_map if frame == self._odom_frame else None
        pose = known or self._lookup(self._map_frame, frame, NEWEST)
        return (frame, pose) if pose else (self._map_frame, Pose2D(0.0, 0.0, 0.0))

    def _lookup(self, parent: str, child: str, stamp: rospy.Time) -> Optional[Pose2D]:
        found = self._stamped_lookup(parent, child, stamp)
        return found and found[0]

    def _stamped_lookup(self, parent: str, child: str, stamp: rospy.Time) -> Optional[Tuple[Pose2D, float]]:
        """Return a transform and its time (s), 0 for a static one. For stamp 0 it is the newest."""
        try:
            found = self._buffer.lookup_transform_core(parent, child, stamp)
        except tf2_ros.TransformException:
            return None
        return from_transform(found.transform), found.header.stamp.to_sec()
