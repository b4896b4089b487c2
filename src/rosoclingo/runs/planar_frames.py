"""Where frames are to each other, seen from above: what tf tells, without tf."""

import math
from typing import Dict, NamedTuple, Optional, Tuple

#: Frames between two of which one asks for the pose, at most.
DEEP = 50


class Pose(NamedTuple):
    """A pose on the floor: m, and rad counter-clockwise from the x axis."""

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
        """Take where a frame is in its parent."""
        self._parents[child.lstrip("/")] = (parent.lstrip("/"), pose)

    def find(self, frame: str, child: str) -> Optional[Pose]:
        """Return where ``child`` is in ``frame``, one of the frames above it; None where that is not known."""
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
