"""Converts the messages of a core's topics, live or from a bag, to the events of a run."""

from typing import Any, Callable, Dict, Optional, Tuple

from rosoclingo.nodes.pose_topics import PoseTopics
from rosoclingo.reasoning.keywords import CORE
from rosoclingo.runs.events import GoalReport
from rosoclingo.runs.planar_frames import Pose
from rosoclingo.runs.recorded_run import problem_in
from rosoclingo.runs.run_view import RunEvents
from rosoclingo.runs.sentences import actors_of
from rosoclingo.runs.topic_atoms import action_in, run_in
from rosoclingo.runs.topic_names import full_name

#: Topics with the robot's planned path.
PATHS = ("move_base/GridPlanner/plan", "move_base/NavfnROS/plan", "move_base/GlobalPlanner/plan")

#: The types of the topics of a run, by name for :func:`full_name`.
TYPES = {
    "~program": "std_msgs/String",
    "~goals": "rosoclingo/GoalStates",
    "~state": "rosoclingo/State",
    "~mode": "std_msgs/String",
    "out_rosoclingo": "rosoclingo/InterfaceIO",
    "in_rosoclingo": "rosoclingo/InterfaceIO",
    "rosoclingo/cancel": "actionlib_msgs/GoalID",
    "~updates": "std_msgs/String",
    "~task_plan": "rosoclingo/TaskPlan",
    "packages": "rosoclingo/PackageStates",
    "map": "nav_msgs/OccupancyGrid",
    **dict.fromkeys(PATHS, "nav_msgs/Path"),
    "base_pose_ground_truth": "nav_msgs/Odometry",
    "amcl_pose": "geometry_msgs/PoseWithCovarianceStamped",
    "/tf": "tf2_msgs/TFMessage",
    "/tf_static": "tf2_msgs/TFMessage",
    "/rosout": "rosgraph_msgs/Log",
}

#: Topics whose last message is a part of the present state.
STATE = ("~program", "~goals", "~state", "~mode", "~task_plan", "packages")


class RunTopics:
    """Passes messages of a core's topics to ``events``.

    ``takes`` maps each topic, with a name for :func:`full_name`, to a function of the time and a message.
    """

    def __init__(self, events: RunEvents, core: str = "/rosoclingo") -> None:
        self.events = events
        self._core = core
        self._latest: Dict[str, Tuple[float, Any]] = {}  # the last message of each topic of STATE, with its time
        self._pose = PoseTopics(lambda time, pose, robot: self.events.pose(time, *pose, robot))
        self.takes: Dict[str, Callable[[float, Any], None]] = {
            "~program": lambda time, message: self.events.program(time, message.data),
            "rosoclingo/cancel": lambda time, message: self.events.cancel(time, message.id),
            "~updates": lambda time, message: self.events.update(time, message.data),
            "~task_plan": self._plan,
            "~goals": self._goals,
            "~state": lambda time, message: self.events.beliefs(time, message.cycle, message.atoms),
            "~mode": lambda time, message: self.events.mode(time, message.data),
            "out_rosoclingo": self._dispatched,
            "in_rosoclingo": lambda time, message: self.events.returned(time, message.interface, message.facts),
            "packages": self._packages,
            "map": lambda _time, message: self.events.floor(_image(message)),
            **dict.fromkeys(PATHS, self._path),
            **self._pose.takes,
            "/rosout": self._log,
            "record/wall_time": lambda time, message: self.events.wall(time, message.data),
        }

    def full(self, name: str) -> str:
        """Return the absolute name of a topic of ``takes``."""
        return full_name(name, self._core)

    def pass_on(self, name: str, time: float, message: Any) -> None:
        """Pass on a message of a topic of ``takes``."""
        if name in STATE:
            self._latest[name] = time, message
        self.takes[name](time, message)

    def restart(self, events: RunEvents) -> None:
        """Pass the present state, and all further messages, to other ``events``."""
        self.events = events
        for name, (time, message) in self._latest.items():
            self.takes[name](time, message)

    def is_too_soon(self, name: str, time: float) -> bool:
        """Return whether to skip a message of a pose topic, soon after the previous one."""
        return self._pose.is_too_soon(name, time)

    def _goals(self, time: float, message: Any) -> None:
        reports = [
            GoalReport(one.id.id, one.request, one.status, one.reason, one.came.to_sec()) for one in message.goals
        ]
        self.events.goals(time, reports)

    def _plan(self, time: float, message: Any) -> None:
        times = (message.ground_time, message.solve_time)
        self._pose.name_robots(robot for one in map(action_in, message.actions) if one for robot in actors_of(one))
        self.events.plan(time, message.cycle, message.horizon, message.actions, times)

    def _dispatched(self, time: float, message: Any) -> None:
        if message.interface != CORE:
            self.events.dispatched(time, message.facts)
            return
        for run in filter(None, map(run_in, message.facts)):  # the core announces its run
            self.events.begin(run)

    def scan(self, time: float, topic: str, message: Any) -> None:
        """Pass on a scan of a laser (sensor_msgs/LaserScan)."""
        self.events.scan(time, topic, self._pose.points_of(message))

    def _packages(self, time: float, message: Any) -> None:
        self.events.packages(time, ((one.id, one.location) for one in message.packages))

    def _path(self, time: float, message: Any) -> None:
        self.events.path(time, [(one.pose.position.x, one.pose.position.y) for one in message.poses])

    def _log(self, time: float, message: Any) -> None:
        cycle, problem = problem_in(message.msg)
        if cycle is not None and message.name == self._core:
            self.events.problem(time, cycle, problem)


def _image(message: Any) -> Optional[Dict[str, Any]]:
    """Return the image of a nav_msgs/OccupancyGrid, None for a grid without cells."""
    from rosoclingo.runs.map_image import map_image  # noqa: PLC0415 accounts have no map, and need no numpy

    info, origin = message.info, message.info.origin
    if not message.data or len(message.data) != info.height * info.width:
        return None
    return map_image(message.data, info.width, info.resolution, Pose.of(origin.position, origin.orientation))
