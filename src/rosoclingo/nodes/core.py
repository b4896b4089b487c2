"""The node ``rosoclingo``: the pure core on topics, parameters and an action server."""

import time
from typing import Any, Callable, Dict, List, Optional, Sequence, Set, Tuple, Type

import rospy
from actionlib import ActionServer, ServerGoalHandle
from std_msgs.msg import String

from rosoclingo.msg import InterfaceIO, ROSoClingoAction, TaskPlan
from rosoclingo.nodes.core_parameters import core_parameters, load_program
from rosoclingo.nodes.goal_handles import GoalHandles
from rosoclingo.nodes.worker import Worker
from rosoclingo.oclingo import DroppedError
from rosoclingo.oclingo.process import SolverProcess
from rosoclingo.reasoning import (
    Action,
    ActionsDispatched,
    Core,
    Event,
    GoalChanged,
    GoalProgress,
    GoalRefused,
    Halt,
    PlanMade,
    Problem,
    ReturnTaken,
    UpdateSent,
)

#: Seconds of wall time that a shutdown waits for the worker, so that every client hears of its goal's end.
SHUTDOWN_TIME = 3.0

#: Seconds of wall time that a search may take though a cancel waits; one so short has its plan before.
CANCEL_GRACE = 0.05


class CoreNode:
    """The reasoning layer as a node.

    Parameters
    ----------
        ~program_files (list of str, required): the reactive logic program, files in order.
        ~constants (map, default {}): values of the program's ``#const`` names.
        ~labels (map or list, default {}): named locations; each is given to the program's base part as ``label(Name).``
        ~horizon_limit (int, default 100): steps that a plan may reach beyond the current cycle.
        ~search_timeout (float, default 10.0): seconds of wall time for one search, 0 for no limit.
        ~action_timeout (float, default 600.0): seconds of ROS time until an action that has not returned counts as
            failed and ``_return(A,timeout,C)`` is fed, 0 for no limit.
    Subscribes:
        in_rosoclingo (rosoclingo/InterfaceIO): facts from the interfaces, ``_return(A,V,C)`` and any declared external.
    Publishes:
        out_rosoclingo (rosoclingo/InterfaceIO): the actions of a cycle, one message for each interface. Not latched,
            but a subscriber that comes while actions are under way is sent those.
        ~task_plan (rosoclingo/TaskPlan, latched): the plan of the latest answer.
        ~updates (std_msgs/String): every stream update, as text.
    Actions:
        rosoclingo (rosoclingo/ROSoClingo): goals of any number of clients, each with its own status.

    Raises ParameterError and ProgramError when it cannot start.

    """

    def __init__(self) -> None:
        self._parameters = core_parameters(rospy.get_param("~", {}))
        self._ending = False
        self._cancels: Set[str] = set()  # keys of goals whose cancel waits
        self._last_time = 0.0
        self._handles = GoalHandles()
        self._under_way: Tuple[InterfaceIO, ...] = ()
        program = load_program(self._parameters)
        self._solvers = SolverProcess(program, shortest=True, oclingo_strings=False)
        self._core = Core(program, self._solvers.solver, self._observe, self._parameters.settings, self._watch_search)
        self._worker = Worker(self._settle)
        self._outlets: Dict[Type[Event], Callable[[Any], None]] = {
            UpdateSent: self._update_sent,
            PlanMade: self._plan_made,
            ActionsDispatched: self._actions_dispatched,
            ReturnTaken: self._return_taken,
            GoalChanged: self._handles.changed,
            GoalRefused: self._handles.refused,
            GoalProgress: self._handles.progress,
            Problem: lambda event: rospy.logwarn("cycle %d: %s", event.cycle, event.message),
        }
        self._connect()

    def _connect(self) -> None:
        self._out = rospy.Publisher("out_rosoclingo", InterfaceIO, _Newcomers(lambda: self._under_way), queue_size=100)
        self._task_plan = rospy.Publisher("~task_plan", TaskPlan, latch=True, queue_size=10)
        self._updates = rospy.Publisher("~updates", String, queue_size=100)
        self._worker.put(self._start)
        self._server = ActionServer("rosoclingo", ROSoClingoAction, self._on_goal, self._on_cancel, auto_start=False)
        rospy.Subscriber("in_rosoclingo", InterfaceIO, self._on_facts, queue_size=1000, tcp_nodelay=True)
        rospy.on_shutdown(self._shut_down)
        self._server.start()
        self._worker.start()

    # -- callbacks: they only put things into the queue

    def _on_goal(self, handle: ServerGoalHandle) -> None:
        key, text = handle.get_goal_id().id, handle.get_goal().request
        self._worker.put(lambda: self._goal_came(key, text, handle))

    def _on_cancel(self, handle: ServerGoalHandle) -> None:
        key = handle.get_goal_id().id
        self._cancels.add(key)
        self._worker.put(lambda: self._cancel_came(key))

    def _on_facts(self, message: InterfaceIO) -> None:
        self._worker.put(lambda: self._core.receive(message.interface, message.facts))

    # -- the worker's side

    def _start(self) -> None:
        """Wait for the solver's process, which is no part of the first search's time."""
        try:
            self._solvers.start(lambda: self._ending)
        except DroppedError as error:
            rospy.logwarn("%s", error)
        self._core.start()

    def _goal_came(self, key: str, text: str, handle: ServerGoalHandle) -> None:
        self._handles.add(key, handle)
        self._core.add_goal(key, text)

    def _cancel_came(self, key: str) -> None:
        self._cancels.discard(key)
        self._core.cancel_goal(key)

    def _settle(self) -> None:
        now = rospy.get_time()
        if now < self._last_time:
            rospy.logwarn("time jumped back by %.1f s", self._last_time - now)
            self._server.last_cancel = rospy.Time()  # else it would cancel every goal until that time comes again
        self._last_time = now
        if now == 0.0:
            rospy.logwarn_throttle(10.0, "waiting for /clock")
            return
        self._core.poll(now)
        while not self._ending and not self._worker.waiting and self._core.advance(now):
            now = rospy.get_time()

    def _watch_search(self) -> Callable[[], Optional[Halt]]:
        """End a search that takes too long, or whose result a cancel or the shutdown makes useless."""
        start, limit = time.monotonic(), self._parameters.search_timeout

        def look() -> Optional[Halt]:
            elapsed = time.monotonic() - start
            if self._ending:
                return Halt("the core shuts down", disturbed=True)
            if self._cancels and elapsed >= CANCEL_GRACE:
                return Halt("a goal was cancelled", disturbed=True)
            return Halt(f"it took longer than {limit:g} s") if 0 < limit <= elapsed else None

        return look

    def _shut_down(self) -> None:
        self._ending = True
        self._worker.put(lambda: self._core.abandon("is given up: the core shuts down"))
        self._worker.put(self._solvers.close)
        self._worker.stop(SHUTDOWN_TIME)

    # -- what the core tells

    def _observe(self, event: Event) -> None:
        outlet = self._outlets.get(type(event))
        if outlet is not None:
            outlet(event)

    def _update_sent(self, event: UpdateSent) -> None:
        self._updates.publish(String(event.text))

    def _plan_made(self, event: PlanMade) -> None:
        message = TaskPlan(cycle=event.cycle, horizon=event.horizon, actions=[str(one.atom) for one in event.actions])
        message.ground_time, message.solve_time = event.ground, event.solve
        message.header.stamp = rospy.Time.now()
        self._task_plan.publish(message)

    def _actions_dispatched(self, event: ActionsDispatched) -> None:
        self._under_way = messages = _messages(event.actions)
        for message in messages:
            self._out.publish(message)

    def _return_taken(self, _event: ReturnTaken) -> None:
        self._under_way = _messages(self._core.awaited)


class _Newcomers(rospy.SubscribeListener):
    """Sends the actions under way to an interface node that comes late, and to it alone."""

    def __init__(self, under_way: Callable[[], Tuple[InterfaceIO, ...]]) -> None:
        super().__init__()
        self._under_way = under_way

    def peer_subscribe(self, _topic: str, _publish_all: Callable[..., None], publish: Callable[..., None]) -> None:
        """Called by rospy when a subscriber has connected."""
        for message in self._under_way():
            publish(message)


def _messages(actions: Sequence[Action]) -> Tuple[InterfaceIO, ...]:
    """One message for each interface, in the order of the actions."""
    facts: Dict[str, List[str]] = {}
    for action in actions:
        facts.setdefault(action.interface_name, []).append(str(action.atom))
    return tuple(InterfaceIO(name, texts) for name, texts in facts.items())
