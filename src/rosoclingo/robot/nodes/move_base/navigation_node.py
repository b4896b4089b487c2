"""Navigation node, with the action, topics, services and parameters of move_base."""

import math
import traceback
from concurrent import futures
from functools import partial
from typing import Any, Optional, Tuple

import numpy as np
import rospy
from actionlib import SimpleActionServer
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import (
    MoveBaseAction,
    MoveBaseActionGoal,
    MoveBaseFeedback,
    MoveBaseResult,
)
from nav_msgs.msg import OccupancyGrid as OccupancyGridMessage
from nav_msgs.srv import GetPlan, GetPlanResponse
from rospy.numpy_msg import numpy_msg
from std_srvs.srv import Empty, EmptyResponse

from rosoclingo.common.action_servers import announce_server, forget_goal_times, start_server
from rosoclingo.common.parameters import Parameters
from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.worker import Worker, ending
from rosoclingo.robot.navigation.costmap import Costmap
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.navigation.grid import MapError
from rosoclingo.robot.navigation.grid_planner import PlanOutcome
from rosoclingo.robot.navigation.local_planner import Velocity
from rosoclingo.robot.navigation.navigation_types import NavigationOutcome, Result
from rosoclingo.robot.navigation.navigator import Navigator
from rosoclingo.robot.navigation.patience import PatienceClock
from rosoclingo.robot.nodes.compiling import compile_once
from rosoclingo.robot.nodes.messages import grid_from_message, path_message, stamped_pose, to_pose2d
from rosoclingo.robot.nodes.move_base.command_watch import CommandWatch
from rosoclingo.robot.nodes.move_base.display import Display
from rosoclingo.robot.nodes.move_base.navigation_settings import Settings
from rosoclingo.robot.nodes.move_base.planning_thread import PlanningThread
from rosoclingo.robot.nodes.move_base.plugins import (
    global_planner,
    global_planner_namespace,
    local_planner,
    recoveries,
)
from rosoclingo.robot.nodes.move_base.sensing import LocatedRobot, Sensing

INVALID_QUATERNION = "Aborting on goal because it was sent with an invalid quaternion"


class MoveBaseNode:
    """Drives the robot to poses: a replacement for the package move_base.

    The action server starts once there are a map and a pose of the robot, and all loops are compiled; its status topic
    exists before that. Parameters have the names of move_base and costmap_2d. doc/simulator_and_navigation.md lists
    the differences.

    Parameters
    ----------
        ~base_global_planner (str, default "rosoclingo.robot.navigation.grid_planner.GridPlanner"): the class path of a
            GlobalPlanner.
        ~base_local_planner (str, default "rosoclingo.robot.navigation.follower.RolloutFollower"): that of a
            LocalPlanner.
        ~recovery_behaviors (list, optional): mappings with name and type, the class path of a RecoveryBehavior.
            Default: the four of move_base.
        ~controller_frequency (float, default 20.0): commands per second.
        ~planner_frequency (float, default 1.0): plans per second; 0: plan only for a new goal and when the path is
            blocked.
        ~planner_patience (float, default 5.0), ~controller_patience (float, default 15.0): seconds without a plan, or a
            command, before a recovery behavior starts.
        ~max_planning_retries (int, default -1): -1: limited only by ~planner_patience.
        ~oscillation_timeout (float, default 0.0), ~oscillation_distance (float, default 0.5): seconds in which the
            robot must move by that distance in metres; 0: no limit.
        ~progress_timeout (float, default 60.0): seconds in which the remaining path must become shorter; 0: no limit.
        ~recovery_behavior_enabled (bool, default true), ~clearing_rotation_allowed (bool, default true): enable
            recovery behaviors, and those that rotate the robot.
        ~conservative_reset_dist (float, default 3.0), ~aggressive_reset/reset_distance (float, default 1.84): metres;
            edge of the square around the robot outside which the costmap is cleared. The default of the latter is four
            times ~local_costmap/robot_radius.
        ~shutdown_costmaps (bool, default false): read scans only while there is a goal.
        ~footprint (list, optional), ~global_costmap/footprint (list, default []): corners [x, y] in metres. The latter
            takes precedence; empty: a disc.
        ~global_costmap/robot_radius (float, default 0.18), ~local_costmap/robot_radius (float, default 0.46): metres.
            The latter is only used for the default of ~aggressive_reset/reset_distance.
        ~global_costmap/global_frame (str, default "map"), ~global_costmap/robot_base_frame (str, default "base_link")
        ~global_costmap/transform_tolerance (float, default 0.5): maximum age of a transform in seconds.
        ~local_costmap/global_frame (str, default ""): empty: the frame of the odometry.
        ~local_costmap/width, ~local_costmap/height (float, default 6.0): metres.
        ~global_costmap/publish_frequency (float, default 0.0), ~local_costmap/publish_frequency (float, default 2.0):
            Hz; 0: publish only to new subscribers.
        ~global_costmap/update_frequency, ~local_costmap/update_frequency (float, default 5.0): rate of the footprint
            in Hz.
        ~global_costmap/always_send_full_costmap, ~local_costmap/always_send_full_costmap (bool, default false)
        ~global_costmap/plugins (list, default []): mappings with name and type, which define the names of the layers
            below.
        ~global_costmap/static_layer/map_topic (str, default "map")
        ~global_costmap/static_layer/lethal_cost_threshold (int, default 100): minimum occupancy of an occupied cell.
        ~global_costmap/inflation_layer/inflation_radius (float, default 0.55): metres.
        ~global_costmap/inflation_layer/cost_scaling_factor (float, default 10.0)
        ~global_costmap/obstacle_layer/enabled (bool, default true)
        ~global_costmap/obstacle_layer/observation_sources (str, default "base_scan"): the name of a laser, SOURCE
            below.
        ~global_costmap/obstacle_layer/SOURCE/topic (str, default "base_scan"): defaults to the source's name.
        ~global_costmap/obstacle_layer/SOURCE/data_type (str, default "LaserScan")
        ~global_costmap/obstacle_layer/SOURCE/expected_update_rate (float, default 1.0): maximum age of a scan in
            seconds; the robot stops if the scan is older. 0: no limit.
        ~global_costmap/obstacle_layer/obstacle_range (float, default 5.0),
            ~global_costmap/obstacle_layer/raytrace_range (float, default 6.0): maximum ranges in metres for marking and
            for clearing.
        ~global_costmap/obstacle_layer/static_tolerance (float, default 0.04),
            ~global_costmap/obstacle_layer/most_tolerance (float, default 0.1): metres. A hit within the first distance
            of a mapped obstacle belongs to it; the second is the maximum addition while the robot turns.
        ~GridPlanner/allow_unknown (bool, default false): plan through unknown cells.
        ~GridPlanner/default_tolerance (float, default 0.0): maximum distance in metres between an unreachable goal and
            the end of the path.
        ~GridPlanner/comfort_weight (float, default 0.15), ~GridPlanner/comfort_distance (float, default 0.45): a path
            next to a wall costs up to (1 + weight) times one that keeps the distance (m).
        ~GridPlanner/escape_distance (float, default 0.5): maximum distance in metres from the robot to the nearest free
            space at the start.
        ~GridPlanner/spacing (float, default 0.25): metres between the points of a path.
        ~RolloutFollower/max_vel_x (float, default 0.65), ~RolloutFollower/max_vel_theta (float, default 1.2),
            ~RolloutFollower/acc_lim_x (float, default 1.0), ~RolloutFollower/acc_lim_theta (float, default 3.2): m/s,
            rad/s, m/s^2, rad/s^2.
        ~RolloutFollower/xy_goal_tolerance, ~RolloutFollower/yaw_goal_tolerance (float, default 0.1): m, rad.
        ~RolloutFollower/sim_time (float, default 1.2): duration of a rollout in seconds.
        ~RolloutFollower/vx_samples (int, default 7), ~RolloutFollower/vtheta_samples (int, default 21)
        ~RolloutFollower/lookahead (float, default 0.7): distance in metres along the path to the point it aims at.
        ~RolloutFollower/margin (float, default 0.02), ~RolloutFollower/creep_vel_x (float, default 0.15): clearance in
            metres; maximum speed in m/s with less clearance.
        ~RolloutFollower/comfort (float, default 0.15): clearance in metres up to which more room gives a better score.
        ~RolloutFollower/turn_gain (float, default 1.8): 1/s; slows a turn towards its end.
        ~rotate_recovery/max_vel_theta (float, default 1.0), ~rotate_recovery/patience (float, default 20.0): rad/s, s.
    Subscribes:
        map (nav_msgs/OccupancyGrid), base_scan (sensor_msgs/LaserScan), odom (nav_msgs/Odometry)
        /tf, /tf_static (tf2_msgs/TFMessage)
        move_base_simple/goal (geometry_msgs/PoseStamped): a goal without an action client.
    Publishes:
        cmd_vel (geometry_msgs/Twist)
        move_base/goal (move_base_msgs/MoveBaseActionGoal): goals from move_base_simple/goal.
        ~current_goal (geometry_msgs/PoseStamped), ~recovery_status (move_base_msgs/RecoveryStatus)
        ~GridPlanner/plan, ~RolloutFollower/global_plan, ~RolloutFollower/local_plan (nav_msgs/Path)
        ~global_costmap/costmap, ~local_costmap/costmap (nav_msgs/OccupancyGrid): the full costmap, for new subscribers.
        ~global_costmap/costmap_updates, ~local_costmap/costmap_updates (map_msgs/OccupancyGridUpdate): changed
            rectangles.
        ~global_costmap/footprint, ~local_costmap/footprint (geometry_msgs/PolygonStamped)
    Services:
        ~make_plan, ~GridPlanner/make_plan (nav_msgs/GetPlan), ~clear_costmaps (std_srvs/Empty)
    Actions served:
        move_base (move_base_msgs/MoveBaseAction)

    """

    def __init__(self) -> None:
        given = Parameters()
        self._settings = Settings(given)
        plan = global_planner(given)
        follow = local_planner(given, self._settings.costmap.robot_radius, self._settings.footprint)
        recover = recoveries(given)
        given.check()
        self._planner, self._follower, self._recoveries = plan(), follow(), recover()
        self._navigator: Optional[Navigator] = None
        self._ready = False
        self._last_tick = -float("inf")
        self._patience = PatienceClock()
        self._pose: Optional[Pose2D] = None
        self._worker = Worker(settle=self._settle, period=0.02)
        self._sensing = Sensing(self._settings, self._worker)
        self._display = Display(self._settings, self._worker)
        self._planning = PlanningThread(self._planner)
        self._commands = CommandWatch(prompt_publisher("cmd_vel", Twist, 1).publish, self._settings.controller_period)
        self._server = SimpleActionServer("move_base", MoveBaseAction, auto_start=False)
        self._server.register_goal_callback(partial(self._worker.put, self._take_goal))
        self._server.register_preempt_callback(partial(self._worker.put, self._take_preempt))
        announce_server(self._server.action_server)  # clients wait during compilation
        self._goals = rospy.Publisher("move_base/goal", MoveBaseActionGoal, queue_size=1)
        self._subscribers = (
            rospy.Subscriber(
                self._settings.map_topic,
                numpy_msg(OccupancyGridMessage),
                partial(self._worker.put, self._take_map),
                queue_size=1,
            ),
            rospy.Subscriber("move_base_simple/goal", PoseStamped, self._on_simple_goal, queue_size=1),
        )
        self._services = (
            rospy.Service("~make_plan", GetPlan, self._on_make_plan),
            rospy.Service(f"~{global_planner_namespace()}/make_plan", GetPlan, self._on_make_plan),
            rospy.Service("~clear_costmaps", Empty, self._on_clear),
        )
        self._worker.put(compile_once, "navigation", rospy.loginfo)
        self._worker.start()
        self._commands.start()
        rospy.on_shutdown(self._stop)

    # ---- ROS callbacks: they only enqueue -------------------------------------------------------------------------

    def _on_simple_goal(self, message: PoseStamped) -> None:
        goal = MoveBaseActionGoal()
        goal.header.stamp = rospy.Time.now()
        goal.goal.target_pose = message
        self._goals.publish(goal)

    def _on_clear(self, _: Any) -> EmptyResponse:
        self._worker.ask(self._clear)
        return EmptyResponse()

    def _on_make_plan(self, request: Any) -> GetPlanResponse:
        """Wait for the plan, in the thread of the call. The response is an empty path if there is none."""
        response = GetPlanResponse()
        response.plan.header.frame_id = self._settings.map_frame
        asked = self._worker.ask(lambda: self._ask_plan(request))
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
            return GetPlanResponse(path_message(plan.points, self._settings.map_frame, yaw))
        rospy.logwarn("make_plan: %s", plan.outcome.value)
        return response

    def _stop(self) -> None:
        self._worker.stop(2.0)
        self._commands.end()

    # ---- the worker -----------------------------------------------------------------------------------------------

    def _take_map(self, message: OccupancyGridMessage) -> None:
        try:
            grid = grid_from_message(message)
        except MapError as error:
            rospy.logerr("map ignored: %s", error)
            return
        costmap = Costmap(grid, self._settings.costmap)
        if self._navigator is None:
            navigator = Navigator(
                costmap, self._planner, self._follower, self._recoveries, self._settings.navigator, self._planning
            )
            navigator.on_plan = lambda points: self._display.plan(points, navigator.goal.yaw)
            navigator.on_recovery = self._display.recovery
            navigator.on_log = rospy.logwarn
            self._navigator = navigator
        else:
            self._navigator.take_map(costmap)
        self._display.new_map(costmap)

    def _settle(self) -> None:
        """Run a control period if one is due."""
        now = self._sensing.now()
        if self._navigator is None or now <= 0.0:
            return
        self._planning.log_delays()
        self._observe(self._navigator)
        if now < self._last_tick:
            self._sensing.time_went_back(now)
            forget_goal_times(self._server)
        elif now - self._last_tick < self._settings.controller_period - 1e-6:
            return
        self._last_tick = now
        self._patience.update(now)
        located = self._sensing.locate(now)
        if located.pose is not None:
            self._pose = located.pose
            if not self._ready:
                self._ready = True
                start_server(self._server.action_server)
            if self._watchful(self._navigator):
                frame = self._sensing.local_frame()
                self._display.update(self._navigator.costmap, located.pose, *frame)
        if self._navigator.active:
            try:
                self._control(now, located)
            except Exception as error:  # noqa: BLE001 a plugin can raise any exception, which only aborts the goal
                rospy.logerr("a plugin failed:\n%s", traceback.format_exc())
                self._abort(f"A planner or recovery plugin failed: {error!r}")
        self._display.costmaps(now)  # after the command, which other nodes wait for

    def _watchful(self, navigator: Navigator) -> bool:
        return navigator.active or not self._settings.rest_when_idle

    def _observe(self, navigator: Navigator) -> None:
        """Enter a new scan into the costmap before the next control period needs it."""
        if self._watchful(navigator) and self._sensing.observe(navigator.costmap):
            navigator.obstacles_changed()

    def _control(self, now: float, located: LocatedRobot) -> None:
        """Publish the command of a control period, and end the goal if it is done."""
        navigator = self._navigator
        assert navigator is not None
        period, patience = self._settings.controller_period, self._patience.now
        laser_age = self._sensing.laser_age(now)
        if located.pose is None or located.fault:
            tick = navigator.stop_blind(patience, NavigationOutcome.LOCALISATION_LOST, located.fault)
        elif self._settings.obstacles and laser_age > self._settings.scan_timeout > 0.0:
            text = f"no scan on {self._settings.scan_topic} for {laser_age:.1f} s"
            tick = navigator.stop_blind(patience, NavigationOutcome.LASER_LOST, text)
        else:
            tick = navigator.tick(patience, located.pose, self._sensing.velocity, max(period, 0.05))
        self._drive(tick.velocity)
        if located.pose is not None:
            self._server.publish_feedback(MoveBaseFeedback(stamped_pose(located.pose, self._settings.map_frame)))
            self._display.trajectory(lambda: self._follower.trajectory(located.pose, tick.velocity))
        if tick.result is not None:
            self._end(tick.result)

    def _drive(self, velocity: Velocity) -> None:
        if not all(map(math.isfinite, velocity)):
            raise ValueError(f"the velocity is not finite: {tuple(velocity)}")
        message = Twist()
        message.linear.x, message.angular.z = velocity
        self._commands.command(message)

    def _end(self, result: Result) -> None:
        if result.outcome is NavigationOutcome.REACHED:
            self._server.set_succeeded(MoveBaseResult(), result.message)
        else:
            self._abort(result.message)

    def _take_goal(self) -> None:
        """Accept the newest goal, which preempts the previous one."""
        if not self._server.is_new_goal_available() or self._navigator is None:
            return
        target = self._server.accept_new_goal().target_pose
        if self._server.is_preempt_requested():
            self._take_preempt()
            return
        fault = self._drive_to(target)
        if fault:
            self._abort(fault)

    def _abort(self, fault: str) -> None:
        """Stop the robot and abort the goal."""
        self._navigator.cancel()
        self._drive(Velocity())
        rospy.logerr("%s", fault)
        if self._server.is_active():
            self._server.set_aborted(MoveBaseResult(), fault)

    def _drive_to(self, target: PoseStamped) -> str:
        """Start to drive to a pose in any frame. Return an error message, or an empty text."""
        assert self._navigator is not None
        pose = to_pose2d(target.pose)
        if pose is None:
            return INVALID_QUATERNION
        if not all(np.isfinite(pose)):
            return "Aborting on goal because its position is not finite"
        frame = self._sensing.to_map(target.header.frame_id, target.header.stamp)
        if frame is None:
            name, known = target.header.frame_id, self._settings.map_frame
            return f"Aborting on goal because its frame {name!r} is unknown to tf, or not connected to {known}"
        goal = frame.compose(pose)
        self._navigator.set_goal(self._patience.now, goal)
        self._display.goal(goal)
        return ""

    def _take_preempt(self) -> None:
        """End a cancelled goal. A goal that is replaced by a newer one is ended by the action server."""
        if self._server.is_new_goal_available() or not self._server.is_preempt_requested():
            return
        if self._server.is_active() and self._navigator is not None:
            self._navigator.cancel()
            self._drive(Velocity())
            self._server.set_preempted(MoveBaseResult(), "The goal was cancelled.")

    def _ask_plan(self, request: Any) -> Optional[Tuple[futures.Future, float]]:
        """Request a plan for a service. Return its future and its final yaw, or None if the map or a pose is unknown.

        A start without a frame is the robot.
        """
        goal = self._in_map(request.goal)
        start = self._in_map(request.start) if request.start.header.frame_id else self._pose
        if self._navigator is None or goal is None or start is None:
            return None
        return self._planning.submit(self._navigator.costmap, start, goal, request.tolerance), goal.yaw

    def _in_map(self, message: PoseStamped) -> Optional[Pose2D]:
        """Return a pose in the map frame. The orientation is optional, since planning only needs the position."""
        position = message.pose.position
        pose = to_pose2d(message.pose) or Pose2D(position.x, position.y, 0.0)
        frame = self._sensing.to_map(message.header.frame_id, message.header.stamp)
        return frame.compose(pose) if frame else None

    def _clear(self) -> None:
        if self._navigator is not None and self._pose is not None:
            self._navigator.costmap.forget(self._pose.x, self._pose.y)
            self._navigator.obstacles_changed()
