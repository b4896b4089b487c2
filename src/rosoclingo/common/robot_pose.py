"""The positions of robots, from tf."""

from typing import Optional, Tuple

import rospy
import tf2_ros

from rosoclingo.common.labels import DEFAULT_FRAME
from rosoclingo.common.parameters import Parameters


class RobotPose:
    """Looks up the robot's position in tf, or that of one of several robots by the prefix of its frames.

    Parameters
    ----------
        ~map_frame (str, default "map"), ~base_frame (str, default "base_link"): the tf frames of the map and the robot.
        ~pose_max_age (float, default 5.0): seconds of ROS time after which a pose is too old.
    Subscribes:
        /tf, /tf_static (tf2_msgs/TFMessage)

    """

    def __init__(self, given: Parameters) -> None:
        self.map_frame = given.at("map_frame").text(DEFAULT_FRAME)
        self.base_frame = given.at("base_frame").text("base_link")
        self._max_age = given.at("pose_max_age").number(5.0, low=0.0)
        self._buffer = tf2_ros.Buffer()
        self._listener = tf2_ros.TransformListener(self._buffer)

    def is_known(self, prefix: str = "") -> bool:
        """Return whether tf has any pose of the robot, of any age: there is none while a system starts."""
        return bool(self._buffer.can_transform(self.map_frame, prefix + self.base_frame, rospy.Time(0)))

    def look_up(self, prefix: str = "") -> Optional[Tuple[float, float]]:
        """Return the robot's x and y in metres in the map frame; None, with a warning, if unknown or too old."""
        try:
            transform = self._buffer.lookup_transform(self.map_frame, prefix + self.base_frame, rospy.Time(0))
        except tf2_ros.TransformException as error:
            rospy.logwarn("no pose of the robot: %s", error)
            return None
        stamp = transform.header.stamp
        age = (rospy.get_rostime() - stamp).to_sec()
        if not stamp.is_zero() and age > self._max_age:
            rospy.logwarn("the robot's pose is too old: %.1f s", age)
            return None
        return (transform.transform.translation.x, transform.transform.translation.y)
