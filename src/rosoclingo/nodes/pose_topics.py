"""The robot's pose on the map, from the most exact topic available; those of several robots from tf."""

from typing import Any, Callable, Dict, Set

from rosoclingo.common.labels import DEFAULT_FRAME
from rosoclingo.runs.planar_frames import PlanarFrames, Pose, yaw_of

__all__ = ["EXACT", "PoseTopics"]

#: Frames of a robot, the most common first.
BASES = ("base_link", "base_footprint")

#: Topics with the robot's pose, the most exact first.
EXACT = "base_pose_ground_truth"
POSES = (EXACT, "/tf", "amcl_pose")

#: Minimum interval in seconds between two messages of a pose topic; messages in between are skipped.
OFTEN = 0.1

#: Seconds of silence after which a less exact topic is used.
SILENT = 2.0


class PoseTopics:
    """Reads messages of POSES and ``/tf_static``; calls ``on_pose`` with the time and each pose in the frame ``map``.

    The last argument of ``on_pose`` is the name of one of several robots, the prefix of its frames (r1/base_link), else
    it is empty. ``takes`` maps each topic to a function of the time and a message.
    """

    def __init__(self, on_pose: Callable[[float, Pose, str], None]) -> None:
        self._on_pose = on_pose
        self._frames = PlanarFrames()
        self._exact, self._heard = len(POSES), 0.0
        self._read: Dict[str, float] = {}  # time of the last message that was read, by topic or robot
        self._robots: Set[str] = set()
        self.takes: Dict[str, Callable[[float, Any], None]] = {
            EXACT: lambda time, message: self._pose(EXACT, time, message),
            "amcl_pose": lambda time, message: self._pose("amcl_pose", time, message),
            "/tf": self._transforms,
            "/tf_static": self._transforms,
        }

    def is_too_soon(self, name: str, time: float) -> bool:
        """Return whether to skip a message of a pose topic, less than OFTEN seconds after the previous one."""
        return name in POSES and name != "/tf" and self._was_read(name, time)  # messages of tf differ in their frames

    def _was_read(self, name: str, time: float) -> bool:
        if 0.0 <= time - self._read.get(name, -OFTEN) < OFTEN:
            return True
        self._read[name] = time
        return False

    def _pose(self, topic: str, time: float, message: Any) -> None:
        pose = message.pose.pose
        turn = pose.orientation
        self._at(topic, time, Pose(pose.position.x, pose.position.y, yaw_of(turn.x, turn.y, turn.z, turn.w)))

    def _transforms(self, time: float, message: Any) -> None:
        for one in message.transforms:
            move, turn = one.transform.translation, one.transform.rotation
            pose = Pose(move.x, move.y, yaw_of(turn.x, turn.y, turn.z, turn.w))
            self._frames.place(one.header.frame_id, one.child_frame_id, pose)
            robot, slash, base = one.child_frame_id.lstrip("/").rpartition("/")
            if slash and base == BASES[0]:
                self._robots.add(robot)
        pose = next(filter(None, (self._frames.find(DEFAULT_FRAME, base) for base in BASES)), None)
        if pose is not None:
            self._at("/tf", time, pose)
        for robot in self._robots:
            pose = self._frames.find(DEFAULT_FRAME, f"{robot}/{BASES[0]}")
            if pose is not None and not self._was_read(f"{robot}/", time):
                self._on_pose(time, pose, robot)

    def _at(self, topic: str, time: float, pose: Pose) -> None:
        """Report a pose unless a more exact topic is available."""
        exact = POSES.index(topic)
        if exact <= self._exact or not 0.0 <= time - self._heard <= SILENT:
            self._exact, self._heard = exact, time
            self._on_pose(time, pose, "")
