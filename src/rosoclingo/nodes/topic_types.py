"""The types of the topics of a run, for nodes that subscribe to them."""

from typing import Any, Dict

from actionlib_msgs.msg import GoalID, GoalStatusArray
from geometry_msgs.msg import PoseWithCovarianceStamped
from nav_msgs.msg import OccupancyGrid, Odometry, Path
from rosgraph_msgs.msg import Log
from std_msgs.msg import String
from tf2_msgs.msg import TFMessage

from rosoclingo.msg import (
    GoalStates,
    InterfaceIO,
    PackageStates,
    ROSoClingoActionFeedback,
    ROSoClingoActionGoal,
    ROSoClingoActionResult,
    State,
    TaskPlan,
)
from rosoclingo.nodes.run_topics import PATHS

__all__ = ["TYPES"]

#: Message types by the topic names of :class:`RunTopics`.
TYPES: Dict[str, Any] = {
    "~program": String,
    "~goals": GoalStates,
    "~state": State,
    "~mode": String,
    "out_rosoclingo": InterfaceIO,
    "in_rosoclingo": InterfaceIO,
    "rosoclingo/goal": ROSoClingoActionGoal,
    "rosoclingo/cancel": GoalID,
    "rosoclingo/status": GoalStatusArray,
    "rosoclingo/feedback": ROSoClingoActionFeedback,
    "rosoclingo/result": ROSoClingoActionResult,
    "~updates": String,
    "~task_plan": TaskPlan,
    "packages": PackageStates,
    "map": OccupancyGrid,
    **dict.fromkeys(PATHS, Path),
    "base_pose_ground_truth": Odometry,
    "amcl_pose": PoseWithCovarianceStamped,
    "/tf": TFMessage,
    "/tf_static": TFMessage,
    "/rosout": Log,
}
