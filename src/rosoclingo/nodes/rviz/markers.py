"""The node that shows labels, packages, robot, plan, goals and the program's drawings in rviz."""

import functools
from typing import Any, Dict, List, Optional, Tuple

import rospy
from nav_msgs.msg import OccupancyGrid
from std_msgs.msg import String
from visualization_msgs.msg import Marker, MarkerArray

from rosoclingo.common.labels import LabelTable
from rosoclingo.common.parameters import Parameters
from rosoclingo.common.robot_pose import RobotPose
from rosoclingo.common.worker import Worker
from rosoclingo.msg import GoalStates, PackageStates, State, TaskPlan
from rosoclingo.nodes.rviz.canvas import Canvas, Point
from rosoclingo.nodes.rviz.map_view import Bounds, bounds_of, text_factor
from rosoclingo.nodes.rviz.panel import draw_panel, goals_text, plan_text
from rosoclingo.nodes.rviz.scene import draw_drawings, draw_labels, draw_packages, draw_plan, draw_robot, things_in
from rosoclingo.planning.history import robots_of
from rosoclingo.runs.drawing import Drawings, drawings_of
from rosoclingo.runs.recorded_run import RecordingError, RunProgram
from rosoclingo.runs.sentences import Sentences, sentences_of
from rosoclingo.runs.topic_atoms import action_in

HEIGHT = 0.3  # m above the floor
NOWHERE = (0.0, -2.0, HEIGHT)  # place of the panel before the map arrives

PROGRAM, STATE, PLAN, GOALS = (f"rosoclingo/{name}" for name in ("program", "state", "task_plan", "goals"))
TOPICS = {"packages": PackageStates, PROGRAM: String, STATE: State, PLAN: TaskPlan, GOALS: GoalStates}


class MarkersNode:
    """Draws the state of the core into the map.

    Parameters
    ----------
        ~labels (map, required): named locations, `{office1: {x: 1.0, y: 2.0, yaw: 0.0}}`.
        ~map_frame (str, default "map"), ~base_frame (str, default "base_link"): the tf frames of the map and the robot.
        ~robots (list of str, default []): the names of several robots, the prefixes of their frames (r1/base_link).
        ~pose_max_age (float, default 5.0): seconds of ROS time after which a pose is too old.
        ~robot_radius (float, default 0.18): metres.
        ~panel (list, default []): x and y in metres of the centre of the upper edge of title, plan and goals; empty:
            below the map.
        ~title (str, default ""): the title above plan and goals.
        ~size (float, default 0.0): scale of texts and arrows, 1 for a map of 16 m; 0: by the size of the map.
    Subscribes:
        map (nav_msgs/OccupancyGrid): for panel and size, unless both are given.
        packages (rosoclingo/PackageStates): the places of the packages.
        rosoclingo/task_plan (rosoclingo/TaskPlan): the current plan.
        rosoclingo/goals (rosoclingo/GoalStates): the goals, with their reasons.
        rosoclingo/program (std_msgs/String), rosoclingo/state (rosoclingo/State): the program's sentences, and its
            drawings, for example blocked ways.
        /tf, /tf_static (tf2_msgs/TFMessage)
    Publishes:
        ~markers (visualization_msgs/MarkerArray, latched): all markers, after each change.

    """

    def __init__(self) -> None:
        given = Parameters()
        self._pose = RobotPose(given)
        self._labels = LabelTable.read(given.at("labels"), self._pose.map_frame)
        panel = given.at("panel").numbers((0, 2), (), "[x, y] in metres")
        self._top: Optional[Point] = (*panel, HEIGHT) if panel else None  # type: ignore[assignment]
        self._size = given.at("size").number(0.0, low=0.0)
        self._title = given.at("title").text("")
        self._radius = given.at("robot_radius").number(0.18, low=0.0)
        self._robots = given.at("robots").texts(()) or ("",)
        given.check()
        self._latest: Dict[str, Any] = {}  # messages by topic
        self._bounds: Optional[Bounds] = None  # of the map
        self._starts: Dict[str, Optional[Tuple[float, float]]] = {}  # positions of the robots at the latest plan
        self._drawings, self._sentences = Drawings(), Sentences()
        self._changed = True
        self._shown: Optional[List[Marker]] = None
        self._publisher = rospy.Publisher("~markers", MarkerArray, queue_size=1, latch=True)
        self._worker = Worker(settle=self._draw, period=0.2)
        rospy.on_shutdown(lambda: self._worker.stop(2.0))
        self._worker.start()
        fits = self._top is None or not self._size
        for name, kind in {**TOPICS, **({"map": OccupancyGrid} if fits else {})}.items():
            rospy.Subscriber(name, kind, self._on_message, callback_args=name, queue_size=1)

    def _on_message(self, message: Any, name: str) -> None:
        self._worker.put(functools.partial(self._take, name, message))

    def _take(self, name: str, message: Any) -> None:
        self._latest[name], self._changed = message, True
        if name == "map":
            self._bounds = bounds_of(message)
        elif name == PLAN:
            self._starts = {one: self._pose.look_up(_prefix(one)) for one in self._robots if message.actions}
        elif name == PROGRAM:
            self._take_program(message.data)

    def _take_program(self, text: str) -> None:
        try:
            program = RunProgram.parse(text)
            self._drawings, self._sentences = drawings_of(program), sentences_of(program)
            for fault in self._drawings.faults:
                rospy.logwarn("%s", fault)
        except RecordingError as error:
            rospy.logwarn("the program's sentences and drawings are not shown: %s", error)

    def _draw(self) -> None:
        if not self._changed:
            return
        self._changed = False
        markers = self._markers()
        if markers != self._shown:
            self._shown = markers
            self._publisher.publish(MarkerArray(markers=[Marker(action=Marker.DELETEALL), *markers]))

    def _markers(self) -> List[Marker]:
        """Return all markers; things drawn by the program are shown only without the topic of packages.

        The panel is below the map, with texts that are readable in a view of the whole map.
        """
        below, factor = NOWHERE, 1.0
        if self._bounds is not None:
            left, lower, right, _ = self._bounds
            below, factor = ((left + right) / 2.0, lower, HEIGHT), text_factor(self._bounds)
        canvas = Canvas(self._size or factor)
        state, plan, goals = (self._latest.get(name) for name in (STATE, PLAN, GOALS))
        drawn = self._drawings.of(state.atoms if state is not None else (), frozenset(self._labels.names))
        things, packages = things_in(drawn), self._latest.get("packages")
        if packages is not None:
            things = [(one.id, one.location, one.carried) for one in packages.packages]
        draw_labels(canvas, self._labels)
        for robot in self._robots:
            draw_robot(canvas, _prefix(robot) + self._pose.base_frame, self._radius, robot)
        draw_drawings(canvas, drawn, self._labels)
        draw_packages(canvas, things, self._labels, self._pose.base_frame)
        texts = {"title": self._title}
        if plan is not None:
            actions = [one for one in map(action_in, plan.actions) if one is not None]
            texts["plan"] = plan_text(actions, plan.cycle, self._sentences)
            for robot in self._robots:
                own = [one for one in actions if not robot or robot in map(str, robots_of(one.interface))]
                draw_plan(canvas, own, self._labels, plan.cycle, self._starts.get(robot))
        if goals is not None:
            rows = [(one.request, one.status, one.reason) for one in goals.goals]
            texts["goals"] = goals_text(rows, self._sentences)
        draw_panel(canvas, self._top or below, self._pose.map_frame, **texts)
        return canvas.markers


def _prefix(robot: str) -> str:
    return f"{robot}/" if robot else ""
