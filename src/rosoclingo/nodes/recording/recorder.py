"""The recorder: records a run up to its last message."""

import os
import threading
import time
from collections import deque
from datetime import datetime
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any, Deque, Iterable, List, Tuple

import genpy
import rospy
from diagnostic_msgs.msg import DiagnosticStatus
from std_msgs.msg import Float64

from rosoclingo.common.connections import connected_nodes, is_delivered_to, readers
from rosoclingo.common.diagnostics import Diagnostics, Findings
from rosoclingo.common.parameters import Parameters
from rosoclingo.nodes.recording.bag_file import BagError, BagFile, repair, unfinished_path

PERIOD = 0.1  # s of wall time between two writes
FLUSH = 1.0  # s of wall time between two flushes, the loss if the recorder is killed
NOTES = "~notes"  # the topic of notes about the bag
WALL_TIME = "~wall_time"  # the topic of wall time, which shows the pace of simulated time
RETRY = 2.0  # s of wall time between a failed write and the next attempt
LINGER = 0.5  # s of wall time for messages in transit when only the recorder is shut down

#: Topics of all nodes, also of other systems: the recorder does not wait for their publishers to end.
OF_ALL = ("/rosout",)

#: The topics that are recorded by default.
TOPICS = (
    *("/rosout", "/diagnostics", "clock", "tf", "tf_static"),
    *("map", "amcl_pose", "odom", "base_pose_ground_truth", "cmd_vel"),
    *("out_rosoclingo", "in_rosoclingo", "packages"),
    *(f"rosoclingo/{name}" for name in ("goal", "cancel", "status", "feedback", "result")),
    *(f"rosoclingo/{name}" for name in ("task_plan", "updates", "program", "state", "goals", "mode")),
    *(f"move_base/{name}/plan" for name in ("GridPlanner", "NavfnROS", "GlobalPlanner")),
    *(f"move_base/{name}" for name in ("goal", "cancel", "status", "result")),
    *(f"{server}/{name}" for server in ("pickup", "deliver") for name in ("goal", "cancel", "result")),
)

#: Topics that a recorder of the case study has to be connected to before a scenario begins.
RECORDED = (
    "/rosoclingo/program",
    "/rosoclingo/updates",
    "/rosoclingo/task_plan",
    "/rosoclingo/result",
    "/out_rosoclingo",
    "/in_rosoclingo",
    "/packages",
)


class RecorderNode:
    """Records topics into a bag up to the end of the run.

    When a launch ends, the recorder shuts down last: it waits until all publishers of its topics have ended (except
    those of ``/rosout``, which every node publishes), and records their last messages. A second signal ends it
    immediately. A killed recorder leaves ``FILE.active``, which lacks only the last second; the next recorder repairs
    it under another name. After a disk failure, recording resumes as soon as the disk has space. If simulated time goes
    back, the bag's time continues forward, which preserves the order of messages. The topic ``~notes`` of the bag
    reports gaps, and ``~wall_time`` has the wall time (s) of each second, by a clock that never goes back.

    Parameters
    ----------
        ~topics (list of str, optional): topics to record. Default: the topics that ``watch``, ``replay`` and ``report``
            read of a core called rosoclingo, and the topics of the shipped robots: /rosout, /diagnostics, clock, tf,
            tf_static, map, amcl_pose, odom, base_pose_ground_truth, cmd_vel, out_rosoclingo, in_rosoclingo, packages;
            goal, cancel, status, feedback, result, task_plan, updates, program, state, goals and mode of rosoclingo/;
            the plans of its planners, goal, cancel, status and result of move_base/; goal, cancel and result of
            pickup/ and deliver/.
        ~bag (str, default ""): the bag's file; empty: rosoclingo_DATE.bag in the working directory, which is ~/.ros
            for roslaunch.
        ~patience (float, default 10.0): seconds of wall time to wait for other nodes to end; roslaunch kills after 15.
    Subscribes:
        TOPIC: each of ~topics, of any type.
    Publishes:
        /diagnostics (diagnostic_msgs/DiagnosticArray): whether the bag can be written, once a second and on change.

    Raises ParameterError and BagError.

    """

    def __init__(self) -> None:
        given = Parameters()
        topics = given.at("topics").texts(TOPICS, "a list of topics", some=True)
        self._patience = given.at("patience").number(10.0, low=0.0)
        path = _path(given.at("bag").text(""))
        given.check()
        self._signals = 0
        self._ending = threading.Event()
        self._clock = _OnwardClock()
        self._come: Deque[Tuple[str, Any, genpy.Time]] = deque()
        self._flushed = time.monotonic()
        self._fault = ""  # why the bag cannot be written
        self._retry_at, self._gaps = 0.0, 0
        self._kept_until = self._clock.now()  # all messages before this time are in the bag
        self._bag = _open_bag(path, rospy.resolve_name(NOTES))
        self._diagnostics = Diagnostics("rosoclingo: recorder", self._describe)
        self._subscribers = [self._subscribe(rospy.resolve_name(topic)) for topic in topics]
        rospy.on_shutdown(self._linger)

    def _subscribe(self, topic: str) -> rospy.Subscriber:
        subscriber = rospy.Subscriber(topic, rospy.AnyMsg, partial(self._take, topic), tcp_nodelay=True)
        subscriber.impl.set_queue_size(None)  # rospy's own subscription to /clock, which is shared, drops messages
        return subscriber

    def _take(self, topic: str, message: Any) -> None:
        self._come.append((topic, message, self._clock.now()))

    def _linger(self) -> None:
        if not self._signals:  # rosnode kill: rospy closes all connections after this
            time.sleep(LINGER)

    def end(self, *_signal: Any) -> None:
        """Stop when the publishers have ended; on the second call, stop immediately."""
        self._signals += 1
        self._ending.set()

    def run(self) -> None:
        """Record until the end of the run; raises BagError."""
        try:
            while not (self._ending.is_set() or rospy.is_shutdown()):
                self._turn()
                self._ending.wait(PERIOD)
            last = time.monotonic() + self._patience
            while self._open_topics() and self._signals < 2 and time.monotonic() < last and not rospy.is_shutdown():
                self._turn()
                time.sleep(PERIOD)
        finally:
            self._close()

    def _turn(self) -> None:
        self._diagnostics.tick()
        if self._fault and time.monotonic() < self._retry_at:
            self._come.clear()
            return
        try:
            if self._fault:
                self._resume()
            self._write()
        except BagError as error:
            self._fail(error)

    def _write(self) -> None:
        while self._come:
            topic, message, moment = self._come.popleft()
            self._bag.write(topic, _bytes(message), message._connection_header, moment)
        if time.monotonic() - self._flushed >= FLUSH:
            self._flushed, before = time.monotonic(), self._clock.now()
            self._bag.add(rospy.resolve_name(WALL_TIME), Float64(self._flushed), before)
            self._bag.flush()
            self._kept_until = before

    def _fail(self, error: BagError) -> None:
        if not self._fault:
            rospy.logerr("%s: recording resumes when the disk can be written again", error)
        self._fault, self._retry_at = str(error), time.monotonic() + RETRY
        self._come.clear()

    def _resume(self) -> None:
        self._come.clear()
        since, now = self._kept_until.to_sec(), self._clock.now()
        self._bag.resume(f"messages from {since:.3f} s to {now.to_sec():.3f} s are missing: {self._fault}", now)
        rospy.logwarn("recording resumes; messages from %.3f s to %.3f s are missing", since, now.to_sec())
        self._fault, self._kept_until, self._gaps = "", now, self._gaps + 1

    def _describe(self) -> Findings:
        level = DiagnosticStatus.ERROR if self._fault else DiagnosticStatus.OK
        return level, self._fault or "recording", {"bag": self._bag.path}

    def _open_topics(self) -> List[str]:
        """Return the topics with a running publisher; all messages of other topics have been received."""
        me, own = rospy.get_name(), (one for one in self._subscribers if one.resolved_name not in OF_ALL)
        return [one.resolved_name for one in own if connected_nodes(one.impl) - {me}]

    def _close(self) -> None:
        going_on = self._open_topics()
        if self._fault:
            self._resume()
        self._write()
        whole = "with the gaps noted before" if self._gaps else "complete"
        lacks = f"later messages are missing on {' '.join(going_on)}" if going_on else f"with the run: {whole}"
        self._bag.note(f"ends, {lacks}", self._clock.now())
        self._bag.close()


class _OnwardClock:
    """ROS time that never goes back, for all threads: each step back is added to later times."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last, self._ahead = rospy.Time(), rospy.Duration()

    def now(self) -> genpy.Time:
        """Return a time that is not earlier than the previous time."""
        with self._lock:
            now = rospy.Time.now()
            if now < self._last:
                self._ahead += self._last - now
            self._last = now
            return now + self._ahead


def is_recording(topics: Iterable[str]) -> bool:
    """Return whether the node ``/record`` is up, and all messages on some topics (absolute names) arrive at it."""
    return readers("/record") is not None and all(is_delivered_to("/record", topic) for topic in topics)


def _bytes(message: Any) -> bytes:
    if isinstance(message, rospy.AnyMsg):
        return bytes(message._buff)
    buffer = BytesIO()  # a topic that this node reads itself
    message.serialize(buffer)
    return buffer.getvalue()


def _path(name: str) -> Path:
    name = name or datetime.now().strftime("rosoclingo_%Y-%m-%d-%H-%M-%S.bag")
    return Path(os.path.abspath(os.path.expanduser(name)))


def _open_bag(path: Path, notes: str) -> BagFile:
    """Create a bag; an unfinished bag of a killed recorder at the same path is repaired under another name."""
    if unfinished_path(path).exists():
        other = _free_name(path)
        try:
            repair(path, other, notes)
        except BagError as error:
            rospy.logwarn("%s; it is overwritten", error)
        else:
            rospy.logwarn("an earlier recorder of %s was killed; its repaired bag is %s", path, other)
    bag = BagFile(path, notes)
    bag.note("begins", rospy.Time.now())
    return bag


def _free_name(path: Path) -> Path:
    number = 1
    while path.with_name(f"{path.stem}_{number}{path.suffix}").exists():
        number += 1
    return path.with_name(f"{path.stem}_{number}{path.suffix}")
