"""Simulator node, with the topics of stage_ros."""

import sys
import time
from functools import partial
from typing import Any, Callable, Dict, Optional

import rospy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from std_srvs.srv import Empty, EmptyResponse, SetBool, SetBoolResponse
from tf2_msgs.msg import TFMessage

from rosoclingo.common.parameters import Parameters
from rosoclingo.common.persisted_state import PersistedState
from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.reading import Reader
from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.nodes.compiling import compile_once
from rosoclingo.robot.nodes.stage.robot_topics import RobotTopics, prefixes
from rosoclingo.robot.simulation.simulation import Simulation, load_simulation
from rosoclingo.robot.simulation.spec import Box, ObstacleSpec, WorldError
from rosoclingo.robot.simulation.world_file import DELAY_LIMIT
from rosoclingo.srv import (
    PutObstacle,
    PutObstacleResponse,
    RemoveObstacle,
    RemoveObstacleResponse,
    SetDoor,
    SetDoorResponse,
    SetRobotPose,
    SetRobotPoseResponse,
    SetSpeed,
    SetSpeedResponse,
    StepSimulation,
    StepSimulationResponse,
)

# Maximum lag (s of wall time) behind the pace that the simulator tries to catch up with.
LAG_LIMIT = 0.5
# With speed 0, a step that would trigger the watchdog of a commanded robot waits up to COMMAND_WAIT (s of wall time)
# for a command. A robot counts as commanded until COMMANDED_TIME (simulated s) after its watchdog has stopped it.
COMMAND_WAIT, COMMANDED_TIME = 0.05, 0.3
# Limit for a call of ~step, which blocks all other services.
STEP_LIMIT = 10000
# Period (s of wall time) for persisting the state while robots move; otherwise it is persisted at once.
PERSIST_PERIOD = 0.5


class SimulatorNode:
    """Simulates a world at a given speed, and publishes it as stage_ros does.

    With several robots, topics and frames have the prefix ``robot_0/``, ``robot_1/`` ... or the name of the robot.

    Parameters
    ----------
        ~world (str, required): the world file (YAML).
        ~map (str, default ""): a map file (YAML of map_server) that replaces the one of the world file.
        ~speed (float, default 1.0): simulated seconds per second; 0: as fast as the simulation and its controllers can
            go.
        ~base_watchdog_timeout (float, default 0.2): simulated seconds without a command after which a robot stops; 0:
            no limit.
        ~scan_delay (float, optional): seconds by which scans are older than their stamps; overrides the world file.
            Scans of Stage are a step late.
        ~paused (bool, default false): start paused.
        ~robots (int, default 0): use the first robots of the world file; 0: all.
        ~use_model_names (bool, default false): with several robots, use their names in the world file as prefixes.
        ~kept (map, optional): persisted state of robots, doors and obstacles, set by the node. A node that restarts
            after a crash resumes from it, at time 0; a regular shutdown removes it.
    Subscribes:
        cmd_vel (geometry_msgs/Twist): velocity, one for each robot.
    Publishes:
        /clock (rosgraph_msgs/Clock): simulated time, one message a step.
        /tf (tf2_msgs/TFMessage): odom -> base_footprint -> base_link -> base_laser_link of each robot.
        odom, base_pose_ground_truth (nav_msgs/Odometry), base_scan (sensor_msgs/LaserScan): for each robot;
            base_scan_0, base_scan_1 ... for one with several lasers.
        ~collisions (std_msgs/String): collisions of the robots, with obstacle and position.
    Services:
        reset_positions (std_srvs/Empty): move the robots to their initial poses.
        ~pause (std_srvs/SetBool), ~step (rosoclingo/StepSimulation): pause or resume; advance by some steps.
        ~set_speed (rosoclingo/SetSpeed): change the speed.
        ~set_door (rosoclingo/SetDoor): open or close a door.
        ~put_obstacle (rosoclingo/PutObstacle), ~remove_obstacle (rosoclingo/RemoveObstacle)
        ~set_pose (rosoclingo/SetRobotPose): move a robot to a pose.

    """

    def __init__(self) -> None:
        given = Parameters()
        world, map_file = given.at("world").text(), given.at("map").text("")
        late = given.at("scan_delay")
        delay = late.number(0.0, low=0.0, high=DELAY_LIMIT) if late.given else None
        watchdog = given.at("base_watchdog_timeout").number(0.2, low=0.0)
        self._speed = given.at("speed").number(1.0, low=0.0)
        self._paused = given.at("paused").flag(False)
        number, use_names = given.at("robots").whole(0, low=0), given.at("use_model_names").flag(False)
        kept = given.at("kept")
        given.check()
        compile_once("simulation", rospy.loginfo)
        self._simulation = load_simulation(world, map_file, watchdog, delay, number)
        _resume(self._simulation, kept)
        self._kept = PersistedState("~kept", "the world is reset if this node crashes")
        self._unkept, self._keep_at = True, 0.0  # whether the state has to be persisted, and when next
        self._worker = Worker(self._advance)
        self._clock = prompt_publisher("/clock", Clock)
        self._tf = prompt_publisher("/tf", TFMessage)
        self._collisions = rospy.Publisher("~collisions", String, queue_size=10)
        self._clock_message, self._tf_message = Clock(), TFMessage()
        names = tuple(self._simulation.robots)
        self._topics = {
            name: RobotTopics(self._simulation.robots[name], prefix, partial(self._worker.put, self._command, name))
            for name, prefix in zip(names, prefixes(names, use_names))
        }
        self._services = self._serve()
        self._commanded_at: Dict[str, float] = {}  # simulated time of each robot's last command
        self._stepped_at = 0.0  # wall time of the last step
        self._origin = (0.0, 0.0)  # wall time and simulated time from which the pace is measured

    def start(self) -> None:
        """Start the simulation. A short switch interval gives the other threads their turn between two steps."""
        sys.setswitchinterval(0.0005)
        self._restart_pace()
        rospy.on_shutdown(self._end)
        self._worker.start()

    def _end(self) -> None:
        self._worker.stop()
        self._kept.remove()

    # ---- ROS callbacks: they only enqueue -------------------------------------------------------------------------

    def _serve(self) -> tuple:
        simulation = self._simulation
        return (
            rospy.Service("reset_positions", Empty, self._on_reset),
            self._service("~pause", SetBool, SetBoolResponse, lambda r: self._pause(r.data)),
            self._service("~set_speed", SetSpeed, SetSpeedResponse, lambda r: self._set_speed(r.speed)),
            self._service("~set_door", SetDoor, SetDoorResponse, lambda r: simulation.set_door(r.door, r.open)),
            self._service("~put_obstacle", PutObstacle, PutObstacleResponse, self._put_obstacle),
            self._service(
                "~remove_obstacle", RemoveObstacle, RemoveObstacleResponse, lambda r: simulation.remove_obstacle(r.name)
            ),
            self._service("~set_pose", SetRobotPose, SetRobotPoseResponse, self._set_pose),
            rospy.Service("~step", StepSimulation, self._on_step),
        )

    def _service(self, name: str, kind: Any, response: Any, work: Callable[[Any], None]) -> rospy.Service:
        """Return a service whose ``work`` runs between two steps; a WorldError makes it fail with that text."""

        def answer(request: Any) -> Any:
            fault = self._between_steps(lambda: work(request))
            return response(success=fault is None, message=fault or "")

        return rospy.Service(name, kind, answer)

    def _on_reset(self, _: Any) -> EmptyResponse:
        fault = self._between_steps(self._simulation.reset)
        if fault is not None:
            raise rospy.ServiceException(fault)
        return EmptyResponse()

    def _on_step(self, request: Any) -> StepSimulationResponse:
        fault = self._between_steps(lambda: self._steps(request.steps))
        time = _ros_time(self._simulation.time)
        return StepSimulationResponse(success=fault is None, message=fault or "", time=time)

    def _between_steps(self, work: Callable[[], None]) -> Optional[str]:
        """Run ``work`` in the worker. Return the error message, None on success."""

        def job() -> Optional[str]:
            """Run ``work``; return its error message or None."""
            self._unkept = True
            try:
                work()
            except WorldError as error:
                return str(error)
            return None

        return self._worker.ask(job)

    # ---- the worker -----------------------------------------------------------------------------------------------

    def _advance(self) -> Optional[float]:
        """Step if a step is due. Return the time (s of wall time) until the next one, None when paused."""
        self._keep()
        if self._paused:
            return None
        wait = self._until_next()
        if wait <= 0.0:
            self._step()
        return wait

    def _keep(self) -> None:
        """Persist the state for a restart after a crash."""
        moving = any(robot.v or robot.w for robot in self._simulation.robots.values())
        self._unkept |= moving
        if self._unkept and not (moving and time.monotonic() < self._keep_at):
            self._unkept, self._keep_at = moving, time.monotonic() + PERSIST_PERIOD
            self._kept.store(self._simulation.state())

    def _until_next(self) -> float:
        """Return the time (s of wall time) until the next step."""
        if self._speed <= 0.0:
            return self._command_wait()
        wall, simulated = self._origin
        wait = wall + (self._simulation.time - simulated) / self._speed - time.monotonic()
        if wait < -LAG_LIMIT:
            self._restart_pace()
        return wait

    def _command_wait(self) -> float:
        """Return how long (s of wall time) a simulation with speed 0 waits for commands."""
        ages = (self._simulation.time - at for at in self._commanded_at.values())
        watchdog = self._simulation.watchdog
        starved = watchdog > 0.0 and any(watchdog - 1e-6 < age < watchdog + COMMANDED_TIME for age in ages)
        return COMMAND_WAIT - (time.monotonic() - self._stepped_at) if starved else 0.0

    def _command(self, name: str, v: float, w: float) -> None:
        self._simulation.command(name, v, w)
        self._commanded_at[name] = self._simulation.time

    def _restart_pace(self) -> None:
        self._origin = (time.monotonic(), self._simulation.time)

    def _step(self) -> None:
        for collision in self._simulation.step():
            text = "{} ran into {} at ({:.2f}, {:.2f})".format(collision.robot, collision.what, *collision.pose[:2])
            rospy.logwarn(text)
            self._collisions.publish(text)
        self._publish()
        self._stepped_at = time.monotonic()

    def _publish(self) -> None:
        now = self._simulation.time
        stamp = _ros_time(now)
        if self._tf.get_num_connections():
            self._tf_message.transforms = [t for topics in self._topics.values() for t in topics.frames(stamp)]
            self._tf.publish(self._tf_message)
        for name, topics in self._topics.items():
            topics.publish(stamp, now, partial(self._simulation.scan, name))
        self._clock_message.clock = stamp  # last, as in stage_ros, since the clock wakes all nodes
        self._clock.publish(self._clock_message)

    def _pause(self, paused: bool) -> None:
        self._paused = paused
        self._restart_pace()

    def _steps(self, count: int) -> None:
        if not self._paused:
            raise WorldError("the simulation is not paused: call ~pause with true first")
        if count > STEP_LIMIT:
            raise WorldError(f"{count} steps are too many for one call: at most {STEP_LIMIT} are allowed")
        for _ in range(count):
            self._step()

    def _set_speed(self, speed: float) -> None:
        if not 0.0 <= speed < float("inf"):
            raise WorldError(f"the speed must be at least 0, not {speed}")
        self._speed = speed
        self._restart_pace()

    def _put_obstacle(self, r: Any) -> None:
        if not r.name:
            raise WorldError("an obstacle needs a name")
        box = Box(r.width, r.depth, r.yaw) if r.width or r.depth else None
        self._simulation.put_obstacle(ObstacleSpec(r.name, (r.x, r.y), r.radius, box))

    def _set_pose(self, r: Any) -> None:
        names = list(self._simulation.robots)
        if not r.robot and len(names) > 1:
            raise WorldError("there are several robots; name one of {}".format(", ".join(names)))
        self._simulation.place(r.robot or names[0], Pose2D(r.x, r.y, r.yaw))


def _resume(simulation: Simulation, kept: Reader) -> None:
    """Restore a new world to its persisted state, if there is one that fits."""
    if kept.given:
        try:
            simulation.resume(kept)
            rospy.loginfo("resuming the world from its persisted state, at time 0")
        except WorldError as error:
            rospy.logwarn("the persisted state does not fit this world, which starts from its initial state: %s", error)


def _ros_time(seconds: float) -> rospy.Time:
    """Convert a time (s) to ROS time, rounded to ns.

    rospy's from_sec truncates, so that the stamp of a step could precede the step.
    """
    return rospy.Time(*divmod(round(seconds * 1e9), 10**9))
