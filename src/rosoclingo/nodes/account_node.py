"""The account of a run as a node: it listens to public topics only."""

import threading
from contextlib import suppress
from typing import Any, Callable, Collection, Dict, List, Mapping, Optional, Sequence

import rospy
from actionlib_msgs.msg import GoalID, GoalStatusArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import Odometry
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from rosoclingo.common.connections import comes_to
from rosoclingo.common.labels import LabelError, LabelTable
from rosoclingo.msg import GoalStates, InterfaceIO, PackageStates, ROSoClingoActionGoal, State, TaskPlan
from rosoclingo.nodes.pose_topics import PoseTopics
from rosoclingo.reasoning.keywords import CORE
from rosoclingo.runs.account import Account, Summary
from rosoclingo.runs.believed_places import believed_places
from rosoclingo.runs.drawing import Drawings, drawings_of
from rosoclingo.runs.planar_frames import Pose
from rosoclingo.runs.recorded_run import RecordingError, RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of
from rosoclingo.runs.topic_atoms import run_in
from rosoclingo.runs.topic_names import USUAL, full_name

#: Topics of an account, named as :func:`full_name` takes them, and their types.
TOPICS = {
    "~program": String,
    "~goals": GoalStates,
    "~state": State,
    "out_rosoclingo": InterfaceIO,
    "in_rosoclingo": InterfaceIO,
    "rosoclingo/goal": ROSoClingoActionGoal,
    "rosoclingo/cancel": GoalID,
    "rosoclingo/status": GoalStatusArray,
    "~updates": String,
    "~task_plan": TaskPlan,
    "packages": PackageStates,
    "base_pose_ground_truth": Odometry,
    "amcl_pose": PoseWithCovarianceStamped,
    "/tf": TFMessage,
    "/tf_static": TFMessage,
}

#: Metres from a label in which the robot is there.
TOLERANCE = 0.5

#: Statuses of goals that have ended.
ENDS = ("succeeded", "canceled", "rejected", "aborted")

#: Those of them that the core publishes.
CORE_TOPICS = ("out_rosoclingo", "rosoclingo/status", "~updates", "~task_plan")


class TopicAccount:
    """An Account that takes ROS messages.

    The robot's place is the program's label within TOLERANCE of its pose, or the shown place if there is no pose.
    Places of things come from the topic ``packages``, else from shown atoms. ``with_state`` adds the program's
    beliefs.
    """

    def __init__(self, say: Callable[[str], None], with_state: bool = False) -> None:
        self.account = Account(say, with_state=with_state)
        self._labels = LabelTable()
        self._drawings: Optional[Drawings] = None  # of the program, once received
        self._atoms: Sequence[str] = ()
        self._pose: Optional[Pose] = None
        self._poses = PoseTopics(self._posed)
        self._has_packages = False
        self._lock = threading.Lock()
        self._readers: Dict[str, Callable[[float, Any], None]] = {
            "~program": self._program,
            "~goals": self._goals,
            "~state": self._state,
            "out_rosoclingo": self._dispatched,
            "in_rosoclingo": lambda time, message: self.account.returned(time, message.interface, message.facts),
            "rosoclingo/goal": lambda time, message: self.account.goal(time, message.goal_id.id, message.goal.request),
            "rosoclingo/cancel": lambda time, message: self.account.cancel(time, message.id),
            "rosoclingo/status": self._statuses,
            "~updates": lambda time, message: self.account.update(time, message.data),
            "~task_plan": lambda time, message: self.account.plan(time, message.cycle, message.actions),
            "packages": self._packages,
            **self._poses.takes,
        }

    def take(self, topic: str, message: Any, time: float) -> None:
        """Enter a message of one of TOPICS; callable from any thread."""
        with self._lock:
            if not self._poses.is_too_soon(topic, time):
                self._readers[topic](time, message)

    def tick(self, time: float) -> None:
        """Time passes: what waited for what belongs before it is told; callable from any thread."""
        with self._lock:
            self.account.pass_time(time)

    def ended(self, keys: Collection[str]) -> bool:
        """Whether the account has heard of the end of the goals with these keys."""
        with self._lock:
            return {one.key for one in self.account.summary.goals if one.status in ENDS}.issuperset(keys)

    def differences(
        self, expect: Mapping[str, Any], before: int = 0, sent: Optional[Collection[str]] = None
    ) -> List[str]:
        """Return the differences from a scenario's ``expect``, see :meth:`Summary.differences`."""
        with self._lock:
            return self.account.summary.differences(expect, before, sent)

    def finish(self) -> Summary:
        """End the account: print what was held back, and the summary."""
        with self._lock:
            self.account.finish()
            return self.account.summary

    def _program(self, _time: float, message: String) -> None:
        with suppress(RecordingError, LabelError):
            program = RunProgram.parse(message.data)
            self.account.sentences, self._drawings = sentences_of(program), drawings_of(program)
            self._labels = LabelTable.from_mapping(program.settings.get("labels", {}))
        self._place()

    def _state(self, time: float, message: State) -> None:
        self._atoms = message.atoms
        self.account.state(time, message.atoms)
        self._place()

    def _goals(self, time: float, message: GoalStates) -> None:
        self.account.goals(time, [(one.id.id, one.request, one.status, one.reason) for one in message.goals])

    def _dispatched(self, time: float, message: InterfaceIO) -> None:
        if message.interface != CORE:
            self.account.dispatched(time, message.facts)
            return
        for run in filter(None, map(run_in, message.facts)):  # the core tells of itself
            self.account.begin(run)

    def _statuses(self, time: float, message: GoalStatusArray) -> None:
        for one in message.status_list:
            self.account.status(time, one.goal_id.id, one.status, one.text)

    def _packages(self, _time: float, message: PackageStates) -> None:
        self._has_packages = True
        self.account.packages((one.id, "carried" if one.carried else one.location) for one in message.packages)

    def _posed(self, _time: float, pose: Pose) -> None:
        self._pose = pose
        self._place()

    def _place(self) -> None:
        """Enter the places of robot and things from the latest messages."""
        if self._drawings is None:
            return
        labels = {label.name for label in self._labels}
        believed = believed_places(self._atoms, self._drawings, labels)
        if not self._has_packages:
            self.account.packages(believed.things.items())
        if self._pose is None or not labels:
            self.account.robot(believed.robot)
        else:
            label = self._labels.nearest(self._pose.x, self._pose.y, TOLERANCE)
            self.account.robot("away from every label" if label is None else label.name)


class AccountNode(TopicAccount):
    """Prints the account of what happens from now on, around the core of some name; ``words`` are its program's.

    Subscribes:
        CORE/program (std_msgs/String), CORE/goals (rosoclingo/GoalStates), CORE/state (rosoclingo/State)
        out_rosoclingo, in_rosoclingo (rosoclingo/InterfaceIO), CORE/task_plan (rosoclingo/TaskPlan)
        rosoclingo/goal (rosoclingo/ROSoClingoActionGoal), rosoclingo/cancel (actionlib_msgs/GoalID)
        rosoclingo/status (actionlib_msgs/GoalStatusArray), CORE/updates (std_msgs/String)
        packages (rosoclingo/PackageStates), base_pose_ground_truth (nav_msgs/Odometry)
        amcl_pose (geometry_msgs/PoseWithCovarianceStamped), /tf, /tf_static (tf2_msgs/TFMessage)
    """

    def __init__(
        self,
        say: Callable[[str], None],
        with_state: bool = False,
        core: str = USUAL,
        words: Optional[Sentences] = None,
    ) -> None:
        super().__init__(say, with_state)
        if words is not None:
            self.account.sentences = words  # before anything can be heard
        self._subscribers = {
            topic: rospy.Subscriber(
                full_name(topic, core), kind, self._on_message, callback_args=topic, queue_size=None
            )
            for topic, kind in TOPICS.items()
        }

    @property
    def connected(self) -> bool:
        """Whether all that the core publishes comes to this node, and what others publish of the rest."""
        found = self._subscribers.items()
        return all(comes_to(rospy.get_name(), one.name, none_will_do=topic not in CORE_TOPICS) for topic, one in found)

    def _on_message(self, message: Any, topic: str) -> None:
        self.take(topic, message, rospy.get_time())
