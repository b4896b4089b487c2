"""Plays a scenario: sends goals, cancels and facts, and waits until all goals have ended."""

import time
from contextlib import suppress
from functools import partial
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, Optional, Set

import genpy
import rospy
import rosservice
from actionlib_msgs.msg import GoalStatusArray
from clingo import Symbol

from rosoclingo.nodes.account_node import AccountNode
from rosoclingo.nodes.core_connection import CoreConnection
from rosoclingo.reasoning.goals import GoalError, read_goal
from rosoclingo.runs.account import Account
from rosoclingo.runs.orders import OrderError
from rosoclingo.runs.scenario import Scenario, ScenarioEvent
from rosoclingo.runs.topic_names import USUAL, full_name

#: Seconds of wall time between two checks of the clock.
_TURN = 0.02

#: Limit in seconds of wall time for a standstill of ROS time.
STILL = 60.0


#: Limit in seconds, of wall time and of ROS time, for a further cycle once all goals have ended.
QUIET = 30.0

#: Limit in seconds of wall time by which other topics can be later than the goals' status.
LATE_NEWS = 5.0


class PlayError(RuntimeError):
    """A scenario that could not be played to its end; the text has the reason."""


class ScenarioPlayer:
    """Plays one scenario against a running system.

    Attributes:
        account: the account of the run, which is printed meanwhile.
        goals: the goals of the scenario by actionlib's ids; goals of an earlier scenario can end in the same account.
        begun: the times at which the core's cycles began, by their first plans.

    Subscribes:
        NAME/status (actionlib_msgs/GoalStatusArray): of each required action server in ``wait_for``.
    Publishes:
        rosoclingo/goal (rosoclingo/ROSoClingoActionGoal), rosoclingo/cancel (actionlib_msgs/GoalID)
        in_rosoclingo (rosoclingo/InterfaceIO): the scenario's facts.
    Services called:
        office/put_package (rosoclingo/PutPackage): for packages of the scenario.
        SERVICE: each service of the scenario.

    """

    def __init__(
        self,
        scenario: Scenario,
        wait_for: List[str],
        say: Callable[[str], None],
        check: Callable[[], None] = lambda: None,
    ) -> None:
        """Connect; ``check`` is called regularly, and can raise an exception to end all waiting."""
        self._scenario = scenario
        self._say = say
        self._check = check
        self.account = Account(say)
        self._node = AccountNode(self.account)
        self._core = rospy.resolve_name(USUAL)
        self._connection = CoreConnection(partial(full_name, core=self._core))
        self._missing = set(wait_for)
        for name in wait_for:
            rospy.Subscriber(name + "/status", GoalStatusArray, self._on_status, callback_args=name)
        self.goals: Dict[str, str] = {}
        self.begun: Dict[int, float] = {}
        self._opening = 0.0  # when the scenario began
        self._earlier: Set[int] = set()  # the core's cycles with updates before that

    def prepare(self, timeout: float) -> None:
        """Wait for ROS time and all servers, each at most ``timeout`` seconds of wall time; place the packages.

        Raises PlayError.
        """
        if not rospy.get_time():
            self._say("waiting for ROS time to begin")
        self.wait_until(lambda: rospy.get_time() > 0.0, timeout, lambda: "ROS time has not begun: no /clock")
        self.wait_until(
            lambda: not self._missing, timeout, lambda: "no action server {}".format(", ".join(self._missing))
        )
        self.wait_until(lambda: bool(self.begun), timeout, lambda: "no plan on rosoclingo/task_plan")
        server = f"no action server {USUAL}"
        self.wait_until(lambda: self._connection.is_connected_to(self._core), timeout, lambda: server)
        self.wait_until(lambda: self._node.connected, timeout, lambda: "no connection to the core's topics")
        for package, label in self._scenario.packages.items():
            call_service("office/put_package", {"package": package, "location": label}, timeout)

    def finish(self) -> None:
        """End the account."""
        self._node.finish()

    def differences(self) -> List[str]:
        """Return the differences of the run from the scenario's expectations."""
        return self.account.differences(self._scenario.expect, self.before or 0, self.goals)

    def play(self) -> None:
        """Play all events and wait until each goal has ended; raises PlayError after the scenario's timeout.

        Topics arrive independently: the expected end can be at most LATE_NEWS seconds later.
        """
        waiting = list(self._scenario.events)
        self._turn()
        self._opening, self._earlier = rospy.get_time(), self._cycles_with("updates")
        clock, quiet = _Unchanged(), _Unchanged()
        while waiting or self._open_goals:
            elapsed = rospy.get_time() - self._opening
            if rospy.is_shutdown():
                raise PlayError("shut down before the scenario's end")
            if elapsed > self._scenario.timeout:
                raise PlayError(f"not done after {elapsed:g} s: {self._open(waiting)}")
            if clock.lasts(rospy.get_time()).wall > STILL:
                raise PlayError(f"time has stood still for {STILL:g} s: is the simulator paused or gone?")
            for event in [one for one in waiting if one.due(elapsed, self.cycles)]:
                waiting.remove(event)
                self._do(event)
            idle = self._awaits_a_cycle(waiting)
            if min(quiet.lasts((idle, len(self.begun), len(waiting)))) > QUIET and idle:
                raise PlayError(
                    f"never happened: {self._open(waiting)}; all goals have ended in cycle {self._reached} of the "
                    f"scenario, and no further cycle began within {QUIET:g} s"
                )
            self._turn()
        with suppress(PlayError):  # then the run does not end as expected
            self.wait_until(lambda: not self.differences(), LATE_NEWS, lambda: "not as expected")

    @property
    def before(self) -> Optional[int]:
        """The number of the core's cycles before the scenario's first update; None before that update."""
        cycles = self._cycles_with("updates") - self._earlier
        return min(cycles) - 1 if cycles else None

    @property
    def cycles(self) -> Dict[int, float]:
        """The scenario's cycles, each with the seconds from the scenario's beginning until it began."""
        found: Dict[int, float] = {}
        before = self.before
        for cycle, moment in sorted(self.begun.items()):
            number = 1 if before is None else max(1, cycle - before)
            found.setdefault(number, max(0.0, moment - self._opening))
        return found

    def _cycles_with(self, part: str) -> Set[int]:
        """Return the core's cycles with ``updates`` or ``plans``."""
        return {one["cycle"] for one in self.account.tables["cycles"] if one[part]}

    @property
    def _reached(self) -> int:
        """The latest cycle, counted in the scenario."""
        return max(self.cycles, default=1)

    def _awaits_a_cycle(self, waiting: List[ScenarioEvent]) -> bool:
        """Return whether no goal is open, and all remaining events wait for later cycles."""
        later = all(one.cycle is not None and one.cycle > self._reached for one in waiting)
        return bool(waiting) and later and not self._open_goals

    @property
    def _open_goals(self) -> List[str]:
        return [text for key, text in self.goals.items() if not self.account.has_ended(key)]

    def _turn(self) -> None:
        self._check()
        self._node.tick(_TURN)
        for cycle in self._cycles_with("plans"):
            self.begun.setdefault(cycle, rospy.get_time())

    def _open(self, waiting: List[ScenarioEvent]) -> str:
        return ", ".join([*map(str, waiting), *self._open_goals])

    def _do(self, event: ScenarioEvent) -> None:
        try:
            if event.verb == "request":
                self.goals[self._connection.send(event.value, event.client)] = event.value
            elif event.verb == "facts":
                self._connection.report(*map(str, event.value), origin=event.origin)
            elif event.verb == "cancel":
                self._cancel(event)
            else:
                call_service(event.value, event.fields)
                fields = ", ".join(f"{key} {value}" for key, value in event.fields.items())
                self._say(f"called {event.value}: {fields}")
        except OrderError as error:
            raise PlayError(f"{event}: {error}") from error

    def _cancel(self, event: ScenarioEvent) -> None:
        named = [key for key, text in self.goals.items() if _identifier(text) == str(event.value)]
        if named:
            self._connection.cancel(named[-1])
        else:
            raise PlayError(f"{event}: no goal {event.value} was sent before")

    def wait_until(self, condition: Callable[[], bool], timeout: float, missing: Callable[[], str]) -> None:
        """Wait for a condition, at most ``timeout`` s of wall time; raises PlayError with the text of ``missing``."""
        end = time.monotonic() + timeout
        while not condition():
            if rospy.is_shutdown():
                raise PlayError(f"shut down while waiting: {missing()}")
            if time.monotonic() > end:
                raise PlayError(f"{missing()} within {timeout:g} s")
            self._turn()

    def _on_status(self, _message: GoalStatusArray, name: str) -> None:
        self._missing.discard(name)


def call_service(name: str, fields: Mapping[str, Any], timeout: float = 10.0) -> None:
    """Call a service; raises PlayError if it is not up within ``timeout`` seconds, refuses or fails."""
    try:
        rospy.wait_for_service(name, timeout)
        kind = rosservice.get_service_class_by_name(rospy.resolve_name(name))
        request = kind._request_class()
        genpy.message.fill_message_args(request, [dict(fields)])
        answer = rospy.ServiceProxy(name, kind)(request)
    except (
        rospy.ROSException,
        rospy.ServiceException,
        rosservice.ROSServiceException,
        genpy.MessageException,
    ) as error:
        raise PlayError(f"{name}: {error}") from error
    if not getattr(answer, "success", True):
        raise PlayError("{} refuses {}: {}".format(name, dict(fields), getattr(answer, "message", "")))


class _Seconds(NamedTuple):
    ros: float
    wall: float


class _Unchanged:
    """Measures for how long a value has been the same."""

    def __init__(self) -> None:
        self._value: object = None
        self._since = _Seconds(0.0, 0.0)

    def lasts(self, value: object) -> _Seconds:
        """Return the seconds since this value was first seen, 0 for a new value."""
        now = _Seconds(rospy.get_time(), time.monotonic())
        if value != self._value:
            self._value, self._since = value, now
        return _Seconds(now.ros - self._since.ros, now.wall - self._since.wall)


def _identifier(text: str) -> str:
    try:
        goal: Symbol = read_goal(text)
    except GoalError:
        return ""
    return str(goal.arguments[-1])
