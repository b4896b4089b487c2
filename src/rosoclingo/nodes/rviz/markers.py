"""The node that shows labels, packages, robot, plan, goals and what the program has drawn in rviz."""

import functools
from typing import Any, Callable, Dict, List, Optional, Sequence, Tuple

import rospy
from geometry_msgs.msg import Point
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import ColorRGBA, String
from visualization_msgs.msg import Marker, MarkerArray

from rosoclingo.common.labels import LabelTable
from rosoclingo.common.parameters import Parameters
from rosoclingo.common.robot_pose import RobotPose
from rosoclingo.common.worker import Worker
from rosoclingo.msg import GoalStates, PackageStates, State, TaskPlan
from rosoclingo.nodes.rviz.map_view import bounds_of, text_factor
from rosoclingo.nodes.rviz.panel import GoalRow, Panel, goals_text, plan_text
from rosoclingo.nodes.rviz.plain_shapes import Shape, larger, plated
from rosoclingo.nodes.rviz.scene import (
    drawn_shapes,
    label_shapes,
    package_shapes,
    plan_shapes,
    plan_steps,
    robot_shapes,
    things_in,
)
from rosoclingo.oclingo import ProgressionError, parse_atom
from rosoclingo.reasoning.keywords import Action, KeywordError, action_of
from rosoclingo.runs.drawing import Drawings, drawings_of
from rosoclingo.runs.recorded_run import RecordingError, RunProgram

HEIGHT = 0.3  # m above the floor
NOWHERE = (0.0, -2.0, HEIGHT)  # while there is no map
_KINDS = {
    "cylinder": Marker.CYLINDER,
    "cube": Marker.CUBE,
    "arrow": Marker.ARROW,
    "line": Marker.LINE_STRIP,
    "text": Marker.TEXT_VIEW_FACING,
}


class MarkersNode:
    """Draws what the reasoner knows into the map.

    Parameters
    ----------
        ~labels (map, required): named locations, `{office1: {x: 1.0, y: 2.0, yaw: 0.0}}`.
        ~map_frame (str, default "map"), ~base_frame (str, default "base_link"): tf frames between which the robot is
            looked up.
        ~pose_max_age (float, default 5.0): seconds of ROS time after which a pose is too old to be believed.
        ~robot_radius (float, default 0.18): metres.
        ~panel (list, default []): x and y in metres of the upper edge's middle of title, plan and goals; empty: below
            the map.
        ~title (str, default ""): words above plan and goals.
        ~size (float, default 0.0): by how much texts and arrows are larger than for a map of 16 m; 0: by the size of
            the map.
    Subscribes:
        map (nav_msgs/OccupancyGrid): for panel and size, where one of them is not given.
        packages (rosoclingo/PackageStates): where the packages are.
        rosoclingo/task_plan (rosoclingo/TaskPlan): the current plan.
        rosoclingo/goals (rosoclingo/GoalStates): the goals, with their reasons.
        rosoclingo/program (std_msgs/String), rosoclingo/state (rosoclingo/State): what the program wants to have drawn,
            ways that are blocked above all.
        /tf, /tf_static (tf2_msgs/TFMessage)
    Publishes:
        ~markers (visualization_msgs/MarkerArray, latched): all of them after each change.

    """

    def __init__(self) -> None:
        given = Parameters()
        self._pose = RobotPose(given)
        self._map_frame, self._base_frame = self._pose.map_frame, self._pose.base_frame
        self._labels = LabelTable.read(given.at("labels"), self._map_frame)
        panel = given.at("panel").numbers((0, 2), (), "[x, y] in metres")
        self._given = (*panel, HEIGHT) if panel else None, given.at("size").number(0.0, low=0.0)
        self._title = given.at("title").text("")
        radius = given.at("robot_radius").number(0.18, low=0.0)
        given.check()
        self._panel = Panel(self._given[0] or NOWHERE, self._map_frame, self._given[1] or 1.0)
        self._groups: Dict[str, List[Shape]] = {
            "robot": robot_shapes(self._base_frame, radius),
            "labels": label_shapes(self._labels),
        }
        self._plan: Optional[TaskPlan] = None
        self._goals: Optional[List[GoalRow]] = None
        self._drawings, self._told_packages = Drawings(), False
        self._state: Sequence[str] = ()
        self._lay_out()
        self._changed = True
        self._publisher = rospy.Publisher("~markers", MarkerArray, queue_size=1, latch=True)
        self._worker = Worker(settle=self._draw, period=0.2)
        rospy.on_shutdown(lambda: self._worker.stop(2.0))
        self._worker.start()
        if not all(self._given):
            rospy.Subscriber("map", OccupancyGrid, self._enqueue(self._take_map), queue_size=1)
        rospy.Subscriber("packages", PackageStates, self._enqueue(self._take_packages))
        rospy.Subscriber("rosoclingo/task_plan", TaskPlan, self._enqueue(self._take_plan))
        rospy.Subscriber("rosoclingo/goals", GoalStates, self._enqueue(self._take_goals))
        rospy.Subscriber("rosoclingo/program", String, self._enqueue(self._take_program))
        rospy.Subscriber("rosoclingo/state", State, self._enqueue(self._take_state))

    def _enqueue(self, take: Callable[[Any], None]) -> Callable[[Any], None]:
        return lambda message: self._worker.put(functools.partial(take, message))

    def _take_packages(self, message: PackageStates) -> None:
        self._told_packages = True
        self._show_things([(package.id, package.location, package.carried) for package in message.packages])

    def _take_map(self, message: OccupancyGrid) -> None:
        """Put the panel below the map, and have texts that can be read when all of it is seen."""
        bounds = bounds_of(message)
        panel, size = self._given
        top = panel or ((bounds[0] + bounds[2]) / 2.0, bounds[1], HEIGHT)
        self._panel = Panel(top, self._map_frame, size or text_factor(bounds))
        self._lay_out()

    def _lay_out(self) -> None:
        """Put words where they belong."""
        self._set("title", self._panel.title(self._title))
        if self._plan is not None:
            self._take_plan(self._plan)
        self._lay_out_goals()

    def _lay_out_goals(self) -> None:
        if self._goals is not None:
            self._set("goals", [self._panel.goals(goals_text(self._goals))])

    def _take_plan(self, message: TaskPlan) -> None:
        self._plan = message
        steps = plan_steps(_actions(message.actions), self._labels)
        words = self._panel.plan(plan_text([step.action for step in steps], message.cycle))
        self._set("plan", [words, *plan_shapes(steps, message.cycle, self._pose.look_up() if steps else None)])

    def _take_goals(self, message: GoalStates) -> None:
        self._goals = [(goal.request, goal.status, goal.reason) for goal in message.goals]
        self._lay_out_goals()

    def _take_program(self, message: String) -> None:
        try:
            self._drawings = drawings_of(RunProgram.parse(message.data))
            for fault in self._drawings.faults:
                rospy.logwarn("%s", fault)
        except RecordingError as error:
            rospy.logwarn("the program's drawings are not shown: %s", error)
        self._show_drawn()

    def _take_state(self, message: State) -> None:
        self._state = message.atoms
        self._show_drawn()

    def _show_drawn(self) -> None:
        """Show what the program wants to have drawn; its things where nobody else tells of any."""
        drawn = self._drawings.of(self._state, frozenset(self._labels.names))
        self._set("drawn", drawn_shapes(drawn, self._labels))
        if not self._told_packages:
            self._show_things(things_in(drawn))

    def _show_things(self, places: List[Tuple[str, str, bool]]) -> None:
        self._set("packages", package_shapes(places, self._labels, self._base_frame))

    def _set(self, group: str, shapes: List[Shape]) -> None:
        if self._groups.get(group) != shapes:
            self._groups[group] = shapes
            self._changed = True

    def _draw(self) -> None:
        if not self._changed:
            return
        self._changed = False
        fitting = (larger(shape, self._panel.factor) for group in self._groups.values() for shape in group)
        shapes = [one for shape in fitting for one in plated(shape)]
        markers = [
            Marker(action=Marker.DELETEALL),
            *(_marker(shape, index) for index, shape in enumerate(shapes)),
        ]
        self._publisher.publish(MarkerArray(markers=markers))


def _actions(texts: List[str]) -> List[Action]:
    actions = []
    for text in texts:
        try:
            actions.append(action_of(parse_atom(text)))
        except (ProgressionError, KeywordError) as error:
            rospy.logwarn("not shown: %s", error)
    return actions


def _marker(shape: Shape, index: int) -> Marker:
    marker = Marker(ns=shape.group, id=index, type=_KINDS[shape.kind], action=Marker.ADD, text=shape.text)
    marker.header.frame_id = shape.frame
    marker.frame_locked = True
    marker.pose.position = Point(*shape.position)
    marker.pose.orientation.w = 1.0
    marker.scale.x, marker.scale.y, marker.scale.z = shape.scale
    marker.color = ColorRGBA(*shape.colour)
    marker.points = [Point(*point) for point in shape.points]
    return marker
