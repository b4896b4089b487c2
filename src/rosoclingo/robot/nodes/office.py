"""Action servers of the simulated office, with which the robot picks up and puts down packages."""

import functools
import time
from collections import deque
from typing import Any, Callable, Deque, List, NamedTuple, Optional, Tuple

import rospy
from actionlib.action_server import ActionServer
from actionlib_msgs.msg import GoalStatus

from rosoclingo.common.action_servers import forget_cancels, start_server
from rosoclingo.common.labels import LabelTable
from rosoclingo.common.parameters import Parameters
from rosoclingo.common.persisted_state import PersistedState
from rosoclingo.common.robot_pose import RobotPose
from rosoclingo.common.worker import Worker
from rosoclingo.msg import (
    DeliverAction,
    DeliverFeedback,
    DeliverResult,
    PackageState,
    PackageStates,
    PickupAction,
    PickupFeedback,
    PickupResult,
)
from rosoclingo.robot.simulation.office_packages import (
    DEFAULT_CAPACITY,
    PREEMPTED,
    ROBOT,
    HandlingResult,
    PackageError,
    PackageOffice,
    PackagePlace,
    words_for,
)
from rosoclingo.srv import PutPackage, PutPackageResponse

POSE_TIMEOUT = 10.0  # s of wall time after the start in which actions wait for the first pose of the robot
PERSIST_TIMEOUT = 5.0  # s of wall time to wait for the master to store the state


class _Kind(NamedTuple):
    """One of the two actions: its operation on the office, its message types, and its description for feedback."""

    handle: Callable[[PackageOffice, str, Optional[str], str], HandlingResult]
    result: type
    feedback: type
    doing: str


_PICKUP = _Kind(PackageOffice.pickup, PickupResult, PickupFeedback, "picking up")
_DELIVER = _Kind(PackageOffice.deliver, DeliverResult, DeliverFeedback, "putting down")


class _Job:
    """A goal that is being executed or waits for the arm."""

    def __init__(self, kind: _Kind, goal_handle: Any) -> None:
        self.kind = kind
        self.goal_handle = goal_handle
        self.package = goal_handle.get_goal().package
        self.since: Optional[float] = None  # ROS time (s) at which the arm started

    @property
    def cancelled(self) -> bool:
        """Whether a client has cancelled the goal."""
        return self.goal_handle.get_goal_status().status in (GoalStatus.RECALLING, GoalStatus.PREEMPTING)

    def end(self, result: HandlingResult) -> None:
        """Set the terminal status of the goal."""
        message = self.kind.result(outcome=result.outcome, message=result.message, location=result.location)
        if result.outcome == PREEMPTED:
            self.goal_handle.set_canceled(message, result.message)
        elif result.succeeded:
            self.goal_handle.set_succeeded(message, result.message)
        else:
            self.goal_handle.set_aborted(message, result.message)


class _Arm:
    """The arm of a robot: its action servers, and the goals in the order of their arrival."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.prefix = f"{robot}/" if robot else ""
        self.jobs: Deque[_Job] = deque()
        self.servers: Tuple[ActionServer, ...] = ()


class OfficeNode:
    """Serves the actions `pickup` and `deliver` with a simulated arm, which handles one package at a time.

    Each of several robots has an arm of its own, with the servers `r1/pickup` and so on, and the frame `r1/base_link`.

    A goal succeeds only if robot and package are at the right place when the arm is done. Otherwise nothing moves, and
    the goal is aborted with an outcome code and a reason. Goals that arrive while the arm is busy are queued.

    Parameters
    ----------
        ~robots (list of str, default []): the names of several robots, as in the prefixes of their frames.
        ~labels (map, required): named locations, `{office1: {x: 1.0, y: 2.0, yaw: 0.0}}`.
        ~packages (map, default {}): initial places of the packages, `{office3: [1, 2]}`.
        ~kept (map, optional): persisted state, set by the node at each change before a goal ends: `{lying: {office3:
            ["1"]}, carried: ["2"]}`, with several robots `carried: {r1: ["2"]}`. A node that restarts after a crash
            uses it in place of ~packages; a regular shutdown removes it.
        ~appear (bool, default false): an unknown package appears where the robot first tries to pick it up.
        ~capacity (int, default 3): maximum number of packages that the robot can carry.
        ~duration (float, default 3.0): seconds of ROS time that the arm needs.
        ~tolerance (float, default 0.5): distance in metres within which the robot counts as being at a label.
        ~map_frame (str, default "map"), ~base_frame (str, default "base_link"): tf frames of the robot's pose.
        ~pose_max_age (float, default 5.0): seconds of ROS time after which a pose is too old.
    Publishes:
        packages (rosoclingo/PackageStates, latched): the place of each package.
    Subscribes:
        /tf, /tf_static (tf2_msgs/TFMessage)
    Services:
        ~put_package (rosoclingo/PutPackage): put a package at a label, or remove it from the office.
    Actions served:
        pickup (rosoclingo/PickupAction), deliver (rosoclingo/DeliverAction): for each robot.

    """

    def __init__(self) -> None:
        given = Parameters()
        self._pose, self._starts_until = RobotPose(given), time.monotonic() + POSE_TIMEOUT
        self._arms = tuple(_Arm(robot) for robot in given.at("robots").texts(()) or (ROBOT,))
        self._labels = LabelTable.read(given.at("labels"), self._pose.map_frame)
        capacity = given.at("capacity").whole(DEFAULT_CAPACITY, low=1)
        self._office = PackageOffice(self._labels.names, capacity, given.at("appear").flag(False))
        kept, packages = given.at("kept"), given.at("packages")
        if kept.given:
            self._office.read(kept.at("lying"), kept.at("carried"))
        else:
            self._office.read(packages)
        self._duration = given.at("duration").number(3.0, low=0.0)
        self._tolerance = given.at("tolerance").number(0.5, low=0.0)
        given.check()
        self._kept = PersistedState("~kept", "the places of the packages are lost if this node crashes")
        self._known: List[PackagePlace] = []  # places of the packages in the persisted state
        self._last_time = 0.0
        self._worker = Worker(settle=self._tick, period=0.02)
        self._states = rospy.Publisher("packages", PackageStates, queue_size=10, latch=True)
        self._publish()
        self._worker.start()
        for arm in self._arms:
            pickup = self._serve(arm, "pickup", PickupAction, _PICKUP)
            arm.servers = (pickup, self._serve(arm, "deliver", DeliverAction, _DELIVER))
        self._service = rospy.Service("~put_package", PutPackage, self._on_put)
        rospy.on_shutdown(self._end)

    def _end(self) -> None:
        self._worker.stop(2.0)
        self._kept.remove()

    def _serve(self, arm: _Arm, name: str, action: type, kind: _Kind) -> ActionServer:
        on_goal = functools.partial(self._on_goal, arm, kind)
        server = ActionServer(arm.prefix + name, action, on_goal, self._on_cancel, auto_start=False)
        start_server(server)
        return server

    # ---- ROS callbacks: they only enqueue -------------------------------------------------------------------------

    def _on_goal(self, arm: _Arm, kind: _Kind, goal_handle: Any) -> None:
        self._worker.put(lambda: arm.jobs.append(_Job(kind, goal_handle)))

    def _on_cancel(self, goal_handle: Any) -> None:
        self._worker.put(lambda: None)  # wakes the worker, which checks the status of the goals

    def _on_put(self, request: Any) -> PutPackageResponse:
        return self._worker.ask(lambda: self._put(request.package, request.location))

    # ---- the arms -------------------------------------------------------------------------------------------------

    def _tick(self) -> None:
        now = rospy.get_time()
        for arm in self._arms:
            if now < self._last_time:
                for server in arm.servers:
                    forget_cancels(server)
            for job in [job for job in arm.jobs if job.cancelled]:
                arm.jobs.remove(job)
                job.end(HandlingResult(PREEMPTED, f"cancelled before {words_for(job.package)} was moved"))
            if arm.jobs:
                self._work(arm, arm.jobs[0], now)
        self._last_time = now

    def _work(self, arm: _Arm, job: _Job, now: float) -> None:
        if job.since is None:
            job.goal_handle.set_accepted(f"{job.kind.doing} {words_for(job.package)}")
            job.goal_handle.publish_feedback(job.kind.feedback(state=job.kind.doing))
        if job.since is None or now < job.since:  # new job, or simulated time was reset
            job.since = now
        starting = time.monotonic() < self._starts_until and not self._pose.is_known(arm.prefix)
        if now - job.since >= self._duration and not starting:
            arm.jobs.popleft()
            result = job.kind.handle(self._office, job.package, self._label_of(arm), arm.robot)
            self._publish()
            job.end(result)
            rospy.loginfo("%s", result.message)

    def _label_of(self, arm: _Arm) -> Optional[str]:
        position = self._pose.look_up(arm.prefix)
        label = self._labels.nearest(position[0], position[1], self._tolerance) if position is not None else None
        return label.name if label is not None else None

    # ---- packages -------------------------------------------------------------------------------------------------

    def _put(self, package: str, location: str) -> PutPackageResponse:
        try:
            if location:
                self._office.put(package, location)
            else:
                self._office.remove(package)
        except PackageError as error:
            return PutPackageResponse(success=False, message=str(error))
        self._publish()
        done = f"is at {location}" if location else "is removed"
        return PutPackageResponse(success=True, message=f"{words_for(package)} {done}")

    def _publish(self) -> None:
        """Publish the places of the packages, persisted before."""
        if self._office.places != self._known:
            self._known = self._office.places
            carried: Any = {arm.robot: self._office.carried_by(arm.robot) for arm in self._arms}
            state = {"lying": self._office.lying, "carried": carried.get(ROBOT, carried)}
            self._kept.store(state, PERSIST_TIMEOUT)
        message = PackageStates()
        message.header.stamp = rospy.get_rostime()
        message.packages = [PackageState(*place) for place in self._office.places]
        self._states.publish(message)
