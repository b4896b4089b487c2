"""Transforms between frames on the floor: a planar tf buffer without ROS."""

import math
from typing import Any, Dict, NamedTuple, Optional, Tuple

#: Limit of transforms between two frames.
DEEP = 50


class Pose(NamedTuple):
    """A pose on the floor: metres, and radians counter-clockwise from the x axis."""

    x: float
    y: float
    yaw: float

    @classmethod
    def of(cls, position: Any, turn: Any) -> "Pose":
        """Return the pose of a position and a unit quaternion, objects with ``x``, ``y``, ``z`` and ``w``."""
        x, y, z, w = turn.x, turn.y, turn.z, turn.w
        return cls(position.x, position.y, math.atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)))

    def outward(self, x: Any, y: Any) -> Tuple[Any, Any]:
        """Return a point, or arrays of coordinates, in the frame of this pose as seen from outside."""
        c, s = math.cos(self.yaw), math.sin(self.yaw)
        return self.x + c * x - s * y, self.y + s * x + c * y


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
            pose = Pose(*outer.outward(pose.x, pose.y), outer.yaw + pose.yaw)
        return None
