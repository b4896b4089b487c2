"""Navigation as a ROS node, with move_base's action, topics, services and parameters."""

import math
import traceback
from typing import Any, Callable, List, Optional, Tuple

import numpy as np
import rospy
from actionlib import SimpleActionServer
from actionlib_msgs.msg import GoalStatusArray
from geometry_msgs.msg import PoseStamped, Twist
from move_base_msgs.msg import (
    MoveBaseAction,
    MoveBaseActionFeedback,
    MoveBaseActionGoal,
    MoveBaseFeedback,
    MoveBaseResult,
)
from nav_msgs.msg import OccupancyGrid as OccupancyGridMessage
from std_srvs.srv import Empty, EmptyResponse

from rosoclingo.common.action_servers import forget_cancels, start_server
from rosoclingo.common.parameters import Parameters
from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation import Costmap, MapError, Navigator, Outcome, PatienceClock, Pose2D, Result, Velocity
from rosoclingo.robot.nodes.compiling import compile_once
from rosoclingo.robot.nodes.localization import to_pose2d
from rosoclingo.robot.nodes.map_server import grid_from_message
from rosoclingo.robot.nodes.move_base.display import Display, View
from rosoclingo.robot.nodes.move_base.make_plan import PlanService
from rosoclingo.robot.nodes.move_base.navigation_settings import read_settings
from rosoclingo.robot.nodes.move_base.plugins import global_planner, local_planner, prepare, recoveries
from rosoclingo.robot.nodes.move_base.reports import Reports, stamped_pose
from rosoclingo.robot.nodes.move_base.sensing import Located, Sensing

INVALID_QUATERNION = "Aborting on goal because it was sent with an invalid quaternion"


class MoveBaseNode:
    """Drives the robot to poses: a stand-in for the package move_base.

    The action server appears when there are a map and the robot's pose, and all is compiled; its status topic is
    there before.

    Parameters
    ----------
        As move_base and costmap_2d name them; the page doc/simulator_and_navigation.md lists each with its default:
        ~base_global_planner, ~base_local_planner, ~recovery_behaviors and what is below the names of these plugins,
        ~controller_frequency and the other limits, ~footprint, ~global_costmap/..., ~local_costmap/...
    Subscribes:
        map (nav_msgs/OccupancyGrid), base_scan (sensor_msgs/LaserScan), odom (nav_msgs/Odometry), /tf, /tf_static
        move_base_simple/goal (geometry_msgs/PoseStamped): a goal without an action client.
    Publishes:
        cmd_vel (geometry_msgs/Twist)
        ~current_goal (geometry_msgs/PoseStamped), ~recovery_status (move_base_msgs/RecoveryStatus)
        ~GridPlanner/plan, ~RolloutFollower/global_plan, ~RolloutFollower/local_plan (nav_msgs/Path)
        ~global_costmap/costmap, ~local_costmap/costmap (nav_msgs/OccupancyGrid), their costmap_updates and footprint
    Services:
        ~make_plan, ~GridPlanner/make_plan (nav_msgs/GetPlan), ~clear_costmaps (std_srvs/Empty)
    Actions served:
        move_base (move_base_msgs/MoveBaseAction)

    """

    def __init__(self) -> None:
        given = Parameters()
        self._settings = read_settings(given)
        plan = global_planner(given)
        follow = local_planner(given, self._settings.costmap.robot_radius, self._settings.footprint)
        recover = recoveries(given)
        given.check()
        self._planner, self._follower, self._recoveries = plan(), follow(), recover()
        self._navigator: Optional[Navigator] = None
        self._ready = False
        self._prepares = True  # until it is done, or fails, which costs nothing but its gain
        self._last_tick = -float("inf")
        self._patience = PatienceClock()
        self._pose: Optional[Pose2D] = None
        self._worker = Worker(settle=self._settle, period=0.02)
        self._sensing = Sensing(self._settings.frames, self._worker, self._settings.obstacles)
        self._display = Display(self._settings, self._worker)
        self._reports = Reports(self._settings.frames.map)
        self._cmd_vel = prompt_publisher("cmd_vel", Twist, 1)
        self._server = SimpleActionServer("move_base", MoveBaseAction, auto_start=False)
        self._server.register_goal_callback(lambda: self._worker.put(self._take_goal))
        self._server.register_preempt_callback(lambda: self._worker.put(self._take_preempt))
        # The action server's own publishers of these topics share what these have set up.
        self._prompt = (
            prompt_publisher("move_base/status", GoalStatusArray, latch=True),
            prompt_publisher("move_base/feedback", MoveBaseActionFeedback),
        )
        self._goals = rospy.Publisher("move_base/goal", MoveBaseActionGoal, queue_size=1)
        self._subscribers = (
            rospy.Subscriber(self._settings.map_topic, OccupancyGridMessage, self._on_map, queue_size=1),
            rospy.Subscriber("move_base_simple/goal", PoseStamped, self._on_simple_goal, queue_size=1),
        )
        self._services = (
            *PlanService(self._worker, self._sensing, self._planner, self._place).services,
            rospy.Service("~clear_costmaps", Empty, self._on_clear),
        )
        self._worker.put(lambda: compile_once("navigation", rospy.loginfo))
        self._worker.start()
        rospy.on_shutdown(self._stop)

    # ---- ROS callbacks: they only enqueue -------------------------------------------------------------------------

    def _on_map(self, message: OccupancyGridMessage) -> None:
        self._worker.put(lambda: self._take_map(message))

    def _on_simple_goal(self, message: PoseStamped) -> None:
        goal = MoveBaseActionGoal()
        goal.header.stamp = rospy.Time.now()
        goal.goal.target_pose = message
        self._goals.publish(goal)

    def _on_clear(self, _: Any) -> EmptyResponse:
        self._worker.ask(self._clear)
        return EmptyResponse()

    def _stop(self) -> None:
        self._worker.stop(2.0)
        self._cmd_vel.publish(Twist())

    # ---- the worker -----------------------------------------------------------------------------------------------

    def _take_map(self, message: OccupancyGridMessage) -> None:
        try:
            grid = grid_from_message(message)
        except MapError as error:
            rospy.logerr("the map is not taken: %s", error)
            return
        costmap = Costmap(grid, self._settings.costmap)
        if self._navigator is None:
            navigator = Navigator(costmap, self._planner, self._follower, self._recoveries, self._settings.navigator)
            navigator.on_plan = lambda points: self._display.plan(points, navigator.goal.yaw)
            navigator.on_recovery = self._reports.recovery
            navigator.on_log = rospy.logwarn
            self._navigator = navigator
            self._guarded(lambda: prepare(self._planner, costmap))
        else:
            self._navigator.costmap = costmap
            self._navigator.obstacles_changed()
        self._prepares = True
        self._display.new_map(costmap)

    def _settle(self) -> None:
        """Tick when a control period has passed."""
        now = self._sensing.now()
        if self._navigator is None or now <= 0.0:
            return
        self._prepare(self._navigator)
        self._look(self._navigator)
        if now < self._last_tick:
            self._sensing.time_went_back(now)
            forget_cancels(self._server.action_server)
        elif now - self._last_tick < self._settings.controller_period - 1e-6:
            return
        self._last_tick = now
        self._patience.see(now)
        located = self._sensing.locate(now)
        if located.pose is not None:
            self._pose = located.pose
            if not self._ready:
                self._ready = True
                start_server(self._server.action_server)
            if self._watchful(self._navigator):
                frame = self._sensing.local_frame(self._settings.local_frame)
                self._display.see(View(self._navigator.costmap, located.pose, *frame))
        if self._navigator.active:
            fault = self._guarded(lambda: self._control(now, located))
            if fault:
                self._abort(f"A planner or recovery plugin failed: {fault}")
        self._display.costmaps(now)  # last, as the command is what others wait for

    def _watchful(self, navigator: Navigator) -> bool:
        return navigator.active or not self._settings.rest_when_idle

    def _look(self, navigator: Navigator) -> None:
        """Enter a scan as soon as it is there, before the next control period needs it."""
        if self._watchful(navigator) and self._sensing.observe(navigator.costmap):
            navigator.obstacles_changed()

    def _prepare(self, navigator: Navigator) -> None:
        """Have the planner use the time while nothing is driven."""
        if self._prepares and not (navigator.active or self._worker.waiting):
            more: List[bool] = []
            self._guarded(lambda: more.append(self._planner.prepare(navigator.costmap)))
            self._prepares = any(more)

    def _guarded(self, work: Callable[[], None]) -> str:
        """Do what calls plugins, which may be anybody's; return what one of them raised, empty for nothing."""
        try:
            work()
        except Exception as error:  # noqa: BLE001 a plugin may raise anything, and costs its goal only
            rospy.logerr("a plugin failed:\n%s", traceback.format_exc())
            return repr(error)
        return ""

    def _control(self, now: float, located: Located) -> None:
        """Give the command of this control period, and the goal's end when it has come."""
        navigator = self._navigator
        assert navigator is not None
        period, patience = self._settings.controller_period, self._patience.now
        laser_age = self._sensing.laser_age(now)
        if located.pose is None or located.fault:
            tick = navigator.blind(patience, Outcome.LOCALISATION_LOST, "Localisation is lost: " + located.fault)
        elif self._settings.obstacles and laser_age > self._settings.frames.scan_timeout > 0.0:
            text = f"The laser is lost: no scan on {self._settings.frames.scan_topic} for {laser_age:.1f} s"
            tick = navigator.blind(patience, Outcome.LASER_LOST, text)
        else:
            tick = navigator.tick(patience, located.pose, self._sensing.velocity, max(period, 0.05))
        self._drive(tick.velocity)
        if located.pose is not None:
            self._feed_back(located.pose, tick.velocity)
        if tick.result is not None:
            self._end(tick.result)

    def _drive(self, velocity: Velocity) -> None:
        if not all(map(math.isfinite, velocity)):
            raise ValueError(f"the velocity is not finite: {tuple(velocity)}")
        message = Twist()
        message.linear.x, message.angular.z = velocity
        self._cmd_vel.publish(message)

    def _feed_back(self, pose: Pose2D, velocity: Velocity) -> None:
        self._server.publish_feedback(MoveBaseFeedback(stamped_pose(pose, self._settings.frames.map)))
        self._display.trajectory(lambda: self._follower.trajectory(pose, velocity))

    def _end(self, result: Result) -> None:
        if result.outcome is Outcome.REACHED:
            self._server.set_succeeded(MoveBaseResult(), result.message)
        else:
            self._abort(result.message)

    def _take_goal(self) -> None:
        """Accept the newest goal, which ends the one before."""
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
        """Stop, and end the goal."""
        self._navigator.cancel()
        self._drive(Velocity())
        rospy.logerr("%s", fault)
        if self._server.is_active():
            self._server.set_aborted(MoveBaseResult(), fault)

    def _drive_to(self, target: PoseStamped) -> str:
        """Start to drive to a pose in any frame; return why that is impossible, empty if it is not."""
        assert self._navigator is not None
        pose = to_pose2d(target.pose)
        if pose is None:
            return INVALID_QUATERNION
        if not all(np.isfinite(pose)):
            return "Aborting on goal because its position is not finite"
        frame = self._sensing.to_map(target.header.frame_id, target.header.stamp)
        if frame is None:
            name, known = target.header.frame_id, self._settings.frames.map
            return f"Aborting on goal because its frame {name!r} is unknown to tf, or not connected to {known}"
        goal = frame.compose(pose)
        self._navigator.set_goal(self._patience.now, goal)
        self._reports.goal(goal)
        return ""

    def _take_preempt(self) -> None:
        """End the goal that its client has cancelled; a newer goal ends it by itself."""
        if self._server.is_new_goal_available() or not self._server.is_preempt_requested():
            return
        if self._server.is_active() and self._navigator is not None:
            self._navigator.cancel()
            self._drive(Velocity())
            self._server.set_preempted(MoveBaseResult(), "The goal was cancelled.")

    def _place(self) -> Tuple[Optional[Costmap], Optional[Pose2D]]:
        """Return the costmap and where the robot is, as far as they are known."""
        return (self._navigator.costmap if self._navigator else None), self._pose

    def _clear(self) -> None:
        if self._navigator is not None and self._pose is not None:
            self._navigator.costmap.forget(self._pose.x, self._pose.y)
            self._navigator.obstacles_changed()
