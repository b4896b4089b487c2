"""Planning services of the move_base node, which do not move the robot."""

import traceback
from concurrent import futures
from typing import Any, Callable, Optional, Tuple

import rospy
from geometry_msgs.msg import PoseStamped
from nav_msgs.srv import GetPlan, GetPlanResponse

from rosoclingo.common.worker import Worker, ending
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid_planner import PlanOutcome
from rosoclingo.robot.nodes.messages import path_message, to_pose2d
from rosoclingo.robot.nodes.move_base.planning_thread import PlanningThread
from rosoclingo.robot.nodes.move_base.plugins import global_planner_namespace
from rosoclingo.robot.nodes.move_base.sensing import Sensing


class PlanService:
    """Serves plans, computed in the planning thread. The response is an empty path if there is none.

    ``place`` returns the costmap and the pose of the robot, None if unknown.

    Services:
        ~make_plan, ~PLANNER/make_plan (nav_msgs/GetPlan): a path from a start to a goal. If the frame of the start is
            empty, the path starts at the robot.
    """

    def __init__(
        self,
        worker: Worker,
        sensing: Sensing,
        planning: PlanningThread,
        place: Callable[[], Tuple[Optional[Costmap], Optional[Pose2D]]],
    ) -> None:
        self._worker, self._sensing, self._planning, self._place = worker, sensing, planning, place
        self.services = tuple(
            rospy.Service(name, GetPlan, self._answer)
            for name in ("~make_plan", f"~{global_planner_namespace()}/make_plan")
        )

    def _answer(self, request: Any) -> GetPlanResponse:
        """Wait for the plan, in the thread of the call."""
        response = GetPlanResponse()
        response.plan.header.frame_id = self._sensing.map_frame
        asked = self._worker.ask(lambda: self._ask(request))
        if asked is None:
            rospy.logerr("make_plan: there is no map yet, or tf does not know the frame of start or goal")
            return response
        future, yaw = asked
        while not futures.wait([future], 0.5).done:
            if ending():
                raise rospy.ServiceException(f"{rospy.get_name()} is shutting down")
        try:
            plan = future.result()
        except Exception:  # noqa: BLE001 a user's planner can raise any exception
            rospy.logerr("make_plan: the planner failed:\n%s", traceback.format_exc())
            return response
        if plan.outcome is PlanOutcome.FOUND:
            return GetPlanResponse(path_message(plan.points, self._sensing.map_frame, yaw))
        rospy.logwarn("make_plan: %s", plan.outcome.value)
        return response

    def _ask(self, request: Any) -> Optional[Tuple[futures.Future, float]]:
        """Request a plan, in the thread of the worker.

        Return its future and its final yaw, or None if the map or a pose is unknown.
        """
        costmap, pose = self._place()
        goal = self._in_map(request.goal)
        start = self._in_map(request.start) if request.start.header.frame_id else pose
        if costmap is None or goal is None or start is None:
            return None
        return self._planning.submit(costmap, start, goal, request.tolerance), goal.yaw

    def _in_map(self, message: PoseStamped) -> Optional[Pose2D]:
        """Return a pose in the map frame. The orientation is optional, since planning only needs the position."""
        position = message.pose.position
        pose = to_pose2d(message.pose) or Pose2D(position.x, position.y, 0.0)
        frame = self._sensing.to_map(message.header.frame_id, message.header.stamp)
        return frame.compose(pose) if frame else None
