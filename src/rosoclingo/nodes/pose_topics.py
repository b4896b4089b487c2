"""Poses on the map: the robot's from the most exact topic, those of several robots from tf, and points of scans."""

import math
import re
from typing import Any, Callable, Dict, Iterable, List, Set, Tuple

from rosoclingo.common.labels import DEFAULT_FRAME
from rosoclingo.runs.planar_frames import PlanarFrames, Pose

#: Frames of a robot, the most common first.
BASES = ("base_link", "base_footprint")

_BASE_OF_ROBOT = re.compile(rf"(.+)[/_]({'|'.join(BASES)})\Z")

#: Topics with the robot's pose, the most exact first.
EXACT = "base_pose_ground_truth"
POSES = (EXACT, "/tf", "amcl_pose")

#: Minimum interval in seconds between two messages of a pose topic; messages in between are skipped.
OFTEN = 0.1

#: Limit of points of a scan.
MOST_POINTS = 180

#: Seconds of silence after which a less exact topic is used.
SILENT = 2.0


class PoseTopics:
    """Reads messages of POSES and ``/tf_static``; calls ``on_pose`` with the time and each pose in the frame ``map``.

    The last argument of ``on_pose`` is the name of one of several robots, else it is empty. A robot r1 has a frame
    r1/base_link, r1_base_link, or the same with base_footprint; a robot of :meth:`name_robots` also a frame r1.
    ``takes`` maps each topic to a function of the time and a message.
    """

    def __init__(self, on_pose: Callable[[float, Pose, str], None]) -> None:
        self._on_pose = on_pose
        self._frames = PlanarFrames()
        self._exact, self._heard = len(POSES), 0.0
        self._read: Dict[str, float] = {}  # time of the last message that was read, by topic or robot
        self._robots: Dict[str, Set[str]] = {}  # the frames of each robot
        self._named: Set[str] = set()
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
        self._at(topic, time, Pose.of(pose.position, pose.orientation))

    def _transforms(self, time: float, message: Any) -> None:
        for one in message.transforms:
            pose = Pose.of(one.transform.translation, one.transform.rotation)
            self._frames.place(one.header.frame_id, one.child_frame_id, pose)
            frame = one.child_frame_id.lstrip("/")
            prefixed = _BASE_OF_ROBOT.match(frame)
            if prefixed or frame in self._named:
                self._robots.setdefault(prefixed.group(1) if prefixed else frame, set()).add(frame)
        pose = next(filter(None, (self._frames.find(DEFAULT_FRAME, base) for base in BASES)), None)
        if pose is not None:
            self._at("/tf", time, pose)
        for robot, frames in self._robots.items():
            poses = (self._frames.find(DEFAULT_FRAME, frame) for frame in sorted(frames, key=_preference))
            pose = next(filter(None, poses), None)
            if pose is not None and not self._was_read(f"{robot}/", time):
                self._on_pose(time, pose, robot)

    def name_robots(self, names: Iterable[str]) -> None:
        """Add robots of the program, each of which can have a frame of its name."""
        self._named.update(names)

    def points_of(self, scan: Any) -> List[Tuple[float, float]]:
        """Return at most MOST_POINTS points of a sensor_msgs/LaserScan in the frame ``map``; none without its pose."""
        pose = self._frames.find(DEFAULT_FRAME, scan.header.frame_id.lstrip("/"))
        if pose is None:
            return []
        every = max(1, math.ceil(len(scan.ranges) / MOST_POINTS))
        found = enumerate(scan.ranges)
        hits = [(n, far) for n, far in found if n % every == 0 and scan.range_min <= far < scan.range_max]
        turns = [(pose.yaw + scan.angle_min + n * scan.angle_increment, far) for n, far in hits]
        return [(pose.x + far * math.cos(turn), pose.y + far * math.sin(turn)) for turn, far in turns]

    def _at(self, topic: str, time: float, pose: Pose) -> None:
        """Report a pose unless a more exact topic is available."""
        exact = POSES.index(topic)
        if exact <= self._exact or not 0.0 <= time - self._heard <= SILENT:
            self._exact, self._heard = exact, time
            self._on_pose(time, pose, "")


def _preference(frame: str) -> int:
    """Return the position of a robot's frame among BASES, after them for any other frame."""
    return next((number for number, base in enumerate(BASES) if frame.endswith(base)), len(BASES))
