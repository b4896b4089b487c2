"""Recording a run to its last message."""

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

from rosoclingo.common.connections import comes_to, readers
from rosoclingo.common.diagnostics import Diagnostics, Findings
from rosoclingo.common.parameters import Parameters
from rosoclingo.nodes.recording.bag_file import BagError, BagFile, active, mend

__all__ = ["RECORDED", "TOPICS", "RecorderNode", "is_recording"]

PERIOD = 0.1  # s of wall time between two writings
FLUSH = 1.0  # s of wall time between two flushes: so much is lost with a recorder that is killed
NOTES = "~notes"  # the topic of what a bag says about itself
RETRY = 2.0  # s of wall time after which a bag that could not be written is tried again
LINGER = 0.5  # s of wall time for what is on its way when the recorder alone is ended

#: What every node says, those of others too: nobody's end is waited for because of it.
OF_ALL = ("/rosout",)

#: The topics that are recorded by default.
TOPICS = (
    *("/rosout", "/diagnostics", "clock", "tf", "tf_static"),
    *("map", "amcl_pose", "odom", "base_pose_ground_truth", "cmd_vel"),
    *("out_rosoclingo", "in_rosoclingo", "packages"),
    *(f"rosoclingo/{name}" for name in ("goal", "cancel", "status", "feedback", "result")),
    *(f"rosoclingo/{name}" for name in ("task_plan", "updates", "program", "state", "goals")),
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
    """Records topics into a bag that holds everything up to the end of the run.

    Of a launch that ends, the recorder ends last: it goes on until all whose topics it records have ended, and has
    then read what they had sent; ``/rosout`` apart, which every node has. A second signal ends it at once. A recorder
    that is killed leaves ``FILE.active``,
    which holds all but the last second; the next one lays it aside, mended. Where the disk is full or fails, it goes on
    as soon as there is room. Where simulated time goes back, the bag's own time goes on, so that its messages stay in
    their order. What the bag says about itself, as what it lacks, is in the topic ``~notes`` of the bag.

    Parameters
    ----------
        ~topics (list of str, optional): topics to record. Default: those that ``watch``, ``replay`` and ``report`` read
            of a core called rosoclingo, and those of the shipped robots: /rosout, /diagnostics, clock, tf, tf_static,
            map, amcl_pose, odom, base_pose_ground_truth, cmd_vel, out_rosoclingo, in_rosoclingo, packages, rosoclingo/
            with goal, cancel, status, feedback, result, task_plan, updates, program, state and goals, move_base/ with
            the plans of its planners, goal, cancel, status and result, pickup/ and deliver/ with goal, cancel and
            result.
        ~bag (str, default ""): the bag's file; empty: rosoclingo_DATE.bag in the working directory, which is ~/.ros
            for roslaunch.
        ~patience (float, default 10.0): seconds of wall time to wait for the others' end; roslaunch kills after 15.
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
        self._kept_until = self._clock.now()  # all that came before is in the bag
        self._bag = _open_bag(path, rospy.resolve_name(NOTES))
        self._diagnostics = Diagnostics("rosoclingo: recorder", self._describe)
        self._subscribers = [self._subscribe(rospy.resolve_name(topic)) for topic in topics]
        rospy.on_shutdown(self._linger)

    def _subscribe(self, topic: str) -> rospy.Subscriber:
        subscriber = rospy.Subscriber(topic, rospy.AnyMsg, partial(self._take, topic), tcp_nodelay=True)
        subscriber.impl.set_queue_size(None)  # rospy's own of /clock, which is shared, takes the newest only
        return subscriber

    def _take(self, topic: str, message: Any) -> None:
        self._come.append((topic, message, self._clock.now()))

    def _linger(self) -> None:
        if not self._signals:  # rosnode kill: rospy closes all connections behind this
            time.sleep(LINGER)

    def end(self, *_signal: Any) -> None:
        """End when the others have ended; called once more, at once."""
        self._signals += 1
        self._ending.set()

    def run(self) -> None:
        """Record until the end; raises BagError."""
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
            self._bag.flush()
            self._kept_until = before

    def _fail(self, error: BagError) -> None:
        if not self._fault:
            rospy.logerr("%s: recording goes on when that can be done again", error)
        self._fault, self._retry_at = str(error), time.monotonic() + RETRY
        self._come.clear()

    def _resume(self) -> None:
        self._come.clear()
        since, now = self._kept_until.to_sec(), self._clock.now()
        self._bag.resume(f"lacks what came from {since:.3f} s to {now.to_sec():.3f} s: {self._fault}", now)
        rospy.logwarn("recording goes on; the bag lacks what came from %.3f s to %.3f s", since, now.to_sec())
        self._fault, self._kept_until, self._gaps = "", now, self._gaps + 1

    def _describe(self) -> Findings:
        level = DiagnosticStatus.ERROR if self._fault else DiagnosticStatus.OK
        return level, self._fault or "recording", {"bag": self._bag.path}

    def _open_topics(self) -> List[str]:
        """The topics that somebody who has not ended publishes; of all others everything has been taken."""
        me, own = rospy.get_name(), (one for one in self._subscribers if one.resolved_name not in OF_ALL)
        return [one.resolved_name for one in own if any(other.callerid_pub != me for other in one.impl.connections)]

    def _close(self) -> None:
        going_on = self._open_topics()
        if self._fault:
            self._resume()
        self._write()
        whole = "lacks what is said before" if self._gaps else "nothing is lacking"
        lacks = f"lacks what came later on {' '.join(going_on)}" if going_on else f"with the run: {whole}"
        self._bag.note(f"ends, {lacks}", self._clock.now())
        self._bag.close()


class _OnwardClock:
    """ROS time, for all threads; what it goes back by is added to what comes."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._last, self._ahead = rospy.Time(), rospy.Duration()

    def now(self) -> genpy.Time:
        """Return a time that is no earlier than the one before."""
        with self._lock:
            now = rospy.Time.now()
            if now < self._last:
                self._ahead += self._last - now
            self._last = now
            return now + self._ahead


def is_recording(topics: Iterable[str]) -> bool:
    """Whether the node ``/record`` is there, and all that is published on some topics (full names) comes to it."""
    return readers("/record") is not None and all(comes_to("/record", topic) for topic in topics)


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
    """A new bag; what a killed recorder has left of one in the same place gets a name of its own."""
    if active(path).exists():
        other = _free_name(path)
        try:
            mend(path, other, notes)
        except BagError as error:
            rospy.logwarn("%s; it is overwritten", error)
        else:
            rospy.logwarn("an earlier recorder of %s was killed; what it has left is %s now", path, other)
    bag = BagFile(path, notes)
    bag.note("begins", rospy.Time.now())
    return bag


def _free_name(path: Path) -> Path:
    number = 1
    while path.with_name(f"{path.stem}_{number}{path.suffix}").exists():
        number += 1
    return path.with_name(f"{path.stem}_{number}{path.suffix}")
