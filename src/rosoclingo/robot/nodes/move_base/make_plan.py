"""The service of the move_base node that plans without driving."""

import traceback
from typing import Any, Callable, Optional, Tuple

import rospy
from geometry_msgs.msg import PoseStamped
from nav_msgs.srv import GetPlan, GetPlanResponse

from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation import Costmap, GlobalPlanner, PlanOutcome, Pose2D
from rosoclingo.robot.nodes.array_messages import PlanResponse, path_message
from rosoclingo.robot.nodes.localization import to_pose2d
from rosoclingo.robot.nodes.move_base.plugins import global_planner_namespace
from rosoclingo.robot.nodes.move_base.sensing import Sensing


class PlanService:
    """Plans in the worker's thread; the answer is an empty path where there is none.

    ``place`` tells the costmap and the robot's pose, None for what is not known yet.

    Services:
        ~make_plan, ~PLANNER/make_plan (nav_msgs/GetPlan): from a start, or where the robot is if the start names no
            frame, to a goal.
    """

    def __init__(
        self,
        worker: Worker,
        sensing: Sensing,
        planner: GlobalPlanner,
        place: Callable[[], Tuple[Optional[Costmap], Optional[Pose2D]]],
    ) -> None:
        self._sensing, self._planner, self._place = sensing, planner, place
        self.services = tuple(
            rospy.Service(name, GetPlan, lambda request: worker.ask(lambda: self._plan(request)))
            for name in ("~make_plan", f"~{global_planner_namespace()}/make_plan")
        )

    def _plan(self, request: Any) -> GetPlanResponse:
        response = GetPlanResponse()
        response.plan.header.frame_id = self._sensing.map_frame
        costmap, pose = self._place()
        goal = self._in_map(request.goal)
        start = self._in_map(request.start) if request.start.header.frame_id else pose
        if costmap is None or goal is None or start is None:
            rospy.logerr("make_plan: no map yet, or start or goal is in a frame that tf does not know")
            return response
        try:
            plan = self._planner.plan(costmap, start, goal, request.tolerance)
        except Exception:  # noqa: BLE001 a user's planner may raise anything
            rospy.logerr("make_plan: the planner failed:\n%s", traceback.format_exc())
            return response
        if plan.outcome is PlanOutcome.FOUND:
            return PlanResponse(path_message(plan.points, self._sensing.map_frame, rospy.Time.now(), goal.yaw))
        rospy.logwarn("make_plan: %s", plan.outcome.value)
        return response

    def _in_map(self, message: PoseStamped) -> Optional[Pose2D]:
        """Return a pose in the map; a missing orientation is fine, only a position is asked for."""
        position = message.pose.position
        pose = to_pose2d(message.pose) or Pose2D(position.x, position.y, 0.0)
        frame = self._sensing.to_map(message.header.frame_id, message.header.stamp)
        return frame.compose(pose) if frame else None
