"""The node that shows labels, packages, robot and plan in rviz."""

import functools
from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy
from geometry_msgs.msg import Point
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

from rosoclingo.common.labels import LabelTable
from rosoclingo.common.parameters import Parameters
from rosoclingo.common.robot_pose import RobotPose
from rosoclingo.common.worker import Worker
from rosoclingo.msg import PackageStates, TaskPlan
from rosoclingo.nodes.rviz.map_view import bounds_of, text_factor
from rosoclingo.nodes.rviz.scene import (
    PlanStep,
    Shape,
    label_shapes,
    larger,
    package_shapes,
    plan_shapes,
    plan_steps,
    robot_shapes,
    title_shapes,
)
from rosoclingo.oclingo import ProgressionError, parse_atom
from rosoclingo.reasoning.keywords import Action, KeywordError, action_of

HEIGHT = 0.3  # m above the floor
NOWHERE = (0.0, -2.0, HEIGHT)  # while there is no map
_KINDS = {"cylinder": Marker.CYLINDER, "cube": Marker.CUBE, "arrow": Marker.ARROW, "text": Marker.TEXT_VIEW_FACING}


class MarkersNode:
    """Draws what the reasoner knows into the map.

    Parameters
    ----------
        ~labels (map, required): named locations, `{office1: {x: 1.0, y: 2.0, yaw: 0.0}}`.
        ~map_frame (str, default "map"), ~base_frame (str, default "base_link"): tf frames between which the robot is
            looked up.
        ~pose_max_age (float, default 5.0): seconds of ROS time after which a pose is too old to be believed.
        ~robot_radius (float, default 0.18): metres.
        ~panel (list, default []): x and y in metres of the upper edge's middle of the plan's text; empty: below the
            map.
        ~title (str, default ""): words to the left of the plan's text.
        ~size (float, default 0.0): by how much texts and arrows are larger than for a map of 16 m; 0: by the size of
            the map.
    Subscribes:
        map (nav_msgs/OccupancyGrid): for panel and size, where one of them is not given.
        packages (rosoclingo/PackageStates): where the packages are.
        rosoclingo/task_plan (rosoclingo/TaskPlan): the current plan.
        /tf, /tf_static (tf2_msgs/TFMessage)
    Publishes:
        ~markers (visualization_msgs/MarkerArray, latched): everything anew whenever something has changed.

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
        self._panel, self._size = self._given[0] or NOWHERE, self._given[1] or 1.0
        self._groups: Dict[str, List[Shape]] = {
            "robot": robot_shapes(self._base_frame, radius),
            "labels": label_shapes(self._labels),
        }
        self._plan: Optional[TaskPlan] = None
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

    def _enqueue(self, take: Callable[[Any], None]) -> Callable[[Any], None]:
        return lambda message: self._worker.put(functools.partial(take, message))

    def _take_packages(self, message: PackageStates) -> None:
        places = [(package.id, package.location, package.carried) for package in message.packages]
        self._set("packages", package_shapes(places, self._labels, self._base_frame))

    def _take_map(self, message: OccupancyGrid) -> None:
        """Put the panel below the map, and have texts that can be read when all of it is seen."""
        bounds = bounds_of(message)
        panel, size = self._given
        self._size = size or text_factor(bounds)
        self._panel = panel or ((bounds[0] + bounds[2]) / 2.0, bounds[1], HEIGHT)
        self._lay_out()
        if self._plan is not None:
            self._take_plan(self._plan)

    def _lay_out(self) -> None:
        self._set("title", title_shapes(self._title, self._panel, self._map_frame, self._size))

    def _take_plan(self, message: TaskPlan) -> None:
        self._plan = message
        steps: List[PlanStep] = plan_steps(_actions(message.actions), self._labels)
        shapes = plan_shapes(steps, message.cycle, self._start(steps), self._panel, self._map_frame)
        self._set("plan", shapes)

    def _start(self, steps: List[PlanStep]) -> Optional[Tuple[float, float]]:
        return self._pose.look_up() if steps else None

    def _set(self, group: str, shapes: List[Shape]) -> None:
        self._groups[group] = shapes
        self._changed = True

    def _draw(self) -> None:
        if not self._changed:
            return
        self._changed = False
        shapes = [shape for group in self._groups.values() for shape in group]
        markers = [
            Marker(action=Marker.DELETEALL),
            *(_marker(larger(shape, self._size), index) for index, shape in enumerate(shapes)),
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
