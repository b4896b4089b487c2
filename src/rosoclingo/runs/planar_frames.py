"""Transforms between frames on the floor: a planar tf buffer without ROS."""

import math
from typing import Dict, NamedTuple, Optional, Tuple

#: Limit of transforms between two frames.
DEEP = 50


class Pose(NamedTuple):
    """A pose on the floor: metres, and radians counter-clockwise from the x axis."""

    x: float
    y: float
    yaw: float


def yaw_of(x: float, y: float, z: float, w: float) -> float:
    """Return the heading (rad) of a unit quaternion."""
    return math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))


class PlanarFrames:
    """The latest transform of each frame to its parent."""

    def __init__(self) -> None:
        self._parents: Dict[str, Tuple[str, Pose]] = {}

    def place(self, parent: str, child: str, pose: Pose) -> None:
        """Set the pose of a frame in its parent."""
        self._parents[child.lstrip("/")] = (parent.lstrip("/"), pose)

    def find(self, frame: str, child: str) -> Optional[Pose]:
        """Return the pose of ``child`` in ``frame``, one of its ancestors; None if it is unknown."""
        pose, here = Pose(0.0, 0.0, 0.0), child
        for _ in range(DEEP):
            if here == frame:
                return pose
            if here not in self._parents:
                return None
            here, outer = self._parents[here]
            c, s = math.cos(outer.yaw), math.sin(outer.yaw)
            pose = Pose(outer.x + c * pose.x - s * pose.y, outer.y + s * pose.x + c * pose.y, outer.yaw + pose.yaw)
        return None
