"""The simulator as a ROS node, with stage_ros's topics."""

import functools
import sys
import time
from typing import Any, Callable, Dict, Optional

import rospy
from rosgraph_msgs.msg import Clock
from std_msgs.msg import String
from std_srvs.srv import Empty, EmptyResponse, SetBool, SetBoolResponse
from tf2_msgs.msg import TFMessage

from rosoclingo.common.kept_state import KeptState
from rosoclingo.common.parameters import Parameters
from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.reading import Reader
from rosoclingo.common.worker import Worker
from rosoclingo.robot.navigation.geometry import Pose2D
from rosoclingo.robot.nodes.compiling import compile_once
from rosoclingo.robot.nodes.stage.robot_topics import RobotTopics, prefixes
from rosoclingo.robot.simulation.simulation import Simulation, load_simulation
from rosoclingo.robot.simulation.spec import Box, ObstacleSpec, WorldError
from rosoclingo.robot.simulation.world_file import MOST_DELAY
from rosoclingo.robot.simulation.world_state import resume_world, world_state
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

# Behind by more than that (s of wall time), the simulator stops trying to catch up with its pace.
LATE = 0.5
# Free running, a step that would leave a commanded robot to its watchdog waits so long (s of wall time) for a command;
# commanded is whom the watchdog has stopped no longer than ACTIVE simulated s ago.
HEED, ACTIVE = 0.05, 0.3
# A call of ~step that asks for more would leave all other services without an answer for too long.
MOST_STEPS = 10000
# So often (s of wall time) the place of robots that move is kept; of those that stand it is at once.
KEEPING = 0.5


class SimulatorNode:
    """Steps a simulated world at a pace and publishes it like stage_ros.

    With several robots the topics and frames of each get the prefix ``robot_0/``, ``robot_1/`` ... (or their names).

    Parameters
    ----------
        ~world (str, required): the world file (YAML).
        ~map (str, default ""): a map file (YAML of map_server) instead of the one that the world file names.
        ~speed (float, default 1.0): simulated seconds per second; 0: as fast as it goes and those who command can
            follow.
        ~base_watchdog_timeout (float, default 0.2): a robot without a command for that long (simulated s) stops; 0:
            never.
        ~scan_delay (float, optional): s by which scans are older than they say, in place of what the world file says.
            Those of Stage are a step late.
        ~paused (bool, default false): start paused.
        ~use_model_names (bool, default false): several robots: prefix with their names in the world file.
        ~kept (map, optional): set by the node, where robots, doors and obstacles are. One that was killed and is
            started again goes on with it, at time 0, as the world has not ended; a node that ends removes it.
    Subscribes:
        cmd_vel (geometry_msgs/Twist): velocity, one for each robot.
    Publishes:
        /clock (rosgraph_msgs/Clock): simulated time, one message a step.
        /tf (tf2_msgs/TFMessage): odom -> base_footprint -> base_link -> base_laser_link of each robot.
        odom, base_pose_ground_truth (nav_msgs/Odometry), base_scan (sensor_msgs/LaserScan): for each robot;
            base_scan_0, base_scan_1 ... for one with several lasers.
        ~collisions (std_msgs/String): which robot ran into what, and where.
    Services:
        reset_positions (std_srvs/Empty): put the robots back to where they started.
        ~pause (std_srvs/SetBool), ~step (rosoclingo/StepSimulation): hold on; go on by some steps.
        ~set_speed (rosoclingo/SetSpeed): change the pace.
        ~set_door (rosoclingo/SetDoor): open or close a door.
        ~put_obstacle (rosoclingo/PutObstacle), ~remove_obstacle (rosoclingo/RemoveObstacle)
        ~set_pose (rosoclingo/SetRobotPose): carry a robot to a pose.

    """

    def __init__(self) -> None:
        given = Parameters()
        world, map_file = given.at("world").text(), given.at("map").text("")
        late = given.at("scan_delay")
        delay = late.number(0.0, low=0.0, high=MOST_DELAY) if late.given else None
        watchdog = given.at("base_watchdog_timeout").number(0.2, low=0.0)
        self._speed = given.at("speed").number(1.0, low=0.0)
        self._paused = given.at("paused").flag(False)
        use_names = given.at("use_model_names").flag(False)
        kept = given.at("kept")
        given.check()
        compile_once("simulation", rospy.loginfo)
        self._simulation = _begin(lambda: load_simulation(world, map_file, watchdog, delay), kept)
        self._kept = KeptState("~kept", "the world begins anew when this node is killed")
        self._unkept, self._keep_at = True, 0.0  # whether all is not where it is kept, and the next time for that
        self._worker = Worker(self._go_on)
        self._clock = prompt_publisher("/clock", Clock)
        self._tf = prompt_publisher("/tf", TFMessage)
        self._collisions = rospy.Publisher("~collisions", String, queue_size=10)
        self._clock_message, self._tf_message = Clock(), TFMessage()
        names = tuple(self._simulation.robots)
        self._topics = {
            name: RobotTopics(self._simulation.robots[name], prefix, self._commander(name))
            for name, prefix in zip(names, prefixes(names, use_names))
        }
        self._services = self._serve()
        self._commanded_at: Dict[str, float] = {}  # each robot's last command, in simulated time
        self._stepped_at = 0.0  # in wall time
        self._origin = (0.0, 0.0)  # wall and simulated time from which the pace counts

    def start(self) -> None:
        """Begin. Other threads of this process get their turn often, as a step is shorter than Python's usual turn."""
        sys.setswitchinterval(0.0005)
        self._restart_pace()
        rospy.on_shutdown(self._end)
        self._worker.start()

    def _end(self) -> None:
        self._worker.stop()
        self._kept.end()

    # ---- ROS callbacks: they only enqueue -------------------------------------------------------------------------

    def _commander(self, name: str) -> Callable[[float, float], None]:
        return lambda v, w: self._worker.put(lambda: self._command(name, v, w))

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
        """Serve a request by work between two steps; a WorldError is a failure with its text."""

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
        """Have the worker do something; return why it could not, None if it could."""

        def job() -> Optional[str]:
            """Do the work; return its fault or None."""
            self._unkept = True
            try:
                work()
            except WorldError as error:
                return str(error)
            return None

        return self._worker.ask(job)

    # ---- the worker -----------------------------------------------------------------------------------------------

    def _go_on(self) -> Optional[float]:
        """Step if that is due; return how long (s of wall time) the next one has to wait."""
        self._keep()
        if self._paused:
            return None
        wait = self._until_next()
        if wait <= 0.0:
            self._step()
        return wait

    def _keep(self) -> None:
        """Have a successor know where all is."""
        moving = any(robot.v or robot.w for robot in self._simulation.robots.values())
        self._unkept |= moving
        if self._unkept and not (moving and time.monotonic() < self._keep_at):
            self._unkept, self._keep_at = moving, time.monotonic() + KEEPING
            self._kept.keep(world_state(self._simulation))

    def _until_next(self) -> float:
        """Return how long (s of wall time) the next step has to wait."""
        if self._speed <= 0.0:
            return self._until_heeded()
        wall, simulated = self._origin
        wait = wall + (self._simulation.time - simulated) / self._speed - time.monotonic()
        if wait < -LATE:
            self._restart_pace()
        return wait

    def _until_heeded(self) -> float:
        """Return how long (s of wall time) a free running simulation waits for who commands its robots."""
        ages = (self._simulation.time - at for at in self._commanded_at.values())
        watchdog = self._simulation.watchdog
        starved = watchdog > 0.0 and any(watchdog - 1e-6 < age < watchdog + ACTIVE for age in ages)
        return HEED - (time.monotonic() - self._stepped_at) if starved else 0.0

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
            topics.publish(stamp, now, functools.partial(self._simulation.scan, name))
        self._clock_message.clock = stamp  # last, as in stage_ros: it wakes every node
        self._clock.publish(self._clock_message)

    def _pause(self, paused: bool) -> None:
        self._paused = paused
        self._restart_pace()

    def _steps(self, count: int) -> None:
        if not self._paused:
            raise WorldError("only a paused simulation can be stepped: call pause with true first")
        if count > MOST_STEPS:
            raise WorldError(f"{count} steps are too many for one call: ask for {MOST_STEPS} or less, several times")
        for _ in range(count):
            self._step()

    def _set_speed(self, speed: float) -> None:
        if not 0.0 <= speed < float("inf"):
            raise WorldError(f"the speed must be a number from 0 on, not {speed}")
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
            raise WorldError("there are several robots, say which: {}".format(", ".join(names)))
        self._simulation.place(r.robot or names[0], Pose2D(r.x, r.y, r.yaw))


def _begin(load: Callable[[], Simulation], kept: Reader) -> Simulation:
    """Return a world as a predecessor that was killed has left it, else as it begins."""
    simulation = load()
    if kept.given:
        try:
            resume_world(simulation, kept)
        except WorldError as error:
            rospy.logwarn("what an earlier simulator has left is none of this world, which begins anew: %s", error)
            return load()
        rospy.loginfo("an earlier simulator was killed: the world goes on where it was, at time 0")
    return simulation


def _ros_time(seconds: float) -> rospy.Time:
    """Return a time to the nearest ns; rospy's own from_sec cuts off, so that 8.1 s would come short of it."""
    return rospy.Time(*divmod(round(seconds * 1e9), 10**9))
