"""The common pattern of all interfaces: read commands, send actionlib goals, wait, answer."""

import abc
import functools
import io
import time
from typing import Any, Callable, Dict, List, Optional, Tuple

import rospy
from clingo import Function

from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.action_runs import DEFAULT_LIMITS, Effect, Event, Instant, Limits, Phase, Run
from rosoclingo.interfaces.answers import LOST, SUCCEEDED, Answer, answer, conclude
from rosoclingo.interfaces.config import DEFAULT_RETRY_ON
from rosoclingo.interfaces.facts import Command, FactError, Verb, parse_command, return_text
from rosoclingo.interfaces.interface_state import Health
from rosoclingo.interfaces.link import ServerLink
from rosoclingo.interfaces.outbox import Outbox
from rosoclingo.interfaces.templates import Ended, Scope
from rosoclingo.msg import InterfaceIO
from rosoclingo.reasoning.keywords import Action

IN_TOPIC = "in_rosoclingo"
OUT_TOPIC = "out_rosoclingo"

TICK, IDLE_TICK = 0.02, 1.0  # seconds of wall time between two looks at what is under way, and where nothing is
CANCEL_PATIENCE = 1.0  # seconds of wall time that an interface which ends waits for its server to take the cancels

_TAKEN = ("preempted", "recalled")  # the server has cancelled a goal though nobody here has asked for it
_FINAL = ("preempted", "interface_lost")  # verdicts after which nothing is sent again


class RefusalError(ValueError):
    """An action that cannot be turned into a goal: `reason` is the name of the return term, the message says why."""

    def __init__(self, reason: str, message: str) -> None:
        super().__init__(message)
        self.reason = reason


class _Attempt:
    """One goal on its way for one action."""

    def __init__(self, action: Action, goal: Any, asked_by: str, limits: Limits, now: Instant) -> None:
        self.action = action
        self.goal = goal
        self.asked_by = asked_by
        self.limits = limits
        self.run = Run(limits, now)
        self.handle: Optional[Any] = None
        self.ended: Optional[Ended] = None

    def again(self, now: Instant) -> "_Attempt":
        """The next attempt at the same action."""
        limits = self.limits._replace(retries=self.limits.retries - 1)
        return _Attempt(self.action, self.goal, self.asked_by, limits, now)


class Interface(abc.ABC):
    """Base of every interface: turns `_action_lib(A,P,C)` into a goal of one actionlib server, its end into facts.

    A subclass supplies `make_goal` and, where the defaults do not do, `make_answer`; both run on the worker thread:

        class GripperInterface(Interface):
            def make_goal(self, action):
                return GripperCommandGoal(command=GripperCommand(position=GRASPS[str(action.parameter)]))

        worker = Worker()
        GripperInterface("gripper", GripperCommandAction, "gripper_controller", worker=worker)
        worker.start()

    Several actions may be under way at once.  Whatever happens, each is answered by exactly one return: the parameter
    itself on success, otherwise a reason (answers.DEFAULT_RETURNS).  Commands that cannot be read are logged and
    dropped.  An exception of a subclass ends the action that it belongs to, its traceback is logged once, and
    diagnostics has it until an action succeeds.

    Subscribes:
        out_rosoclingo (rosoclingo/InterfaceIO): `_action_lib(A,P,C)` runs an action, `_cancel(A,P,C)` cancels it.
            Messages with another interface's name are dropped unread.
    Publishes:
        in_rosoclingo (rosoclingo/InterfaceIO): `_return(A,V,C)` behind the further facts of the answer, if any; to each
            node that connects first a message without facts, which announces the interface.
        /diagnostics (diagnostic_msgs/DiagnosticArray): server, actions under way, counts, the last failure and
            fault, once a second and on change.
    Actions called:
        SERVER: that of the action, by name and type; it may come, go and come back.

    Arguments: the interface's name (the first argument of `_action_lib`), the action type, the server's name, time
    limits and retries, the reasons after which a goal is sent again, and the worker on which all this runs.
    """

    def __init__(
        self,
        name: str,
        action_type: type,
        server: str,
        limits: Limits = DEFAULT_LIMITS,
        retry_on: Tuple[str, ...] = DEFAULT_RETRY_ON,
        *,
        worker: Worker,
    ) -> None:
        self.name = name
        self._limits = limits
        self._retry_on = retry_on
        self._worker = worker
        self._attempts: Dict[Action, _Attempt] = {}
        self._server = server
        self._goal_class = type(action_type().action_goal.goal)
        self._link = ServerLink(server, action_type)
        self._outbox = Outbox(IN_TOPIC, name)
        self._health = Health(name, server, self._look)
        worker.add(self._settle)
        rospy.on_shutdown(lambda: self._post(self._shut_down))
        self._subscriber = rospy.Subscriber(OUT_TOPIC, InterfaceIO, self._on_message)

    @abc.abstractmethod
    def make_goal(self, action: Action) -> Any:
        """The goal message for an action.  Raise RefusalError if there is none."""

    def make_answer(self, action: Action, ended: Ended) -> Answer:
        """What to tell the core about an action whose goal has ended in this way."""
        return answer((), Scope(action.parameter, action.cycle, ended=ended))

    # ---- in: ROS callbacks only enqueue ---------------------------------------------------------------------------

    def _on_message(self, message: InterfaceIO) -> None:
        if message.interface == self.name:
            self._post(functools.partial(self._read, message))

    def _read(self, message: InterfaceIO) -> None:
        sender = message._connection_header["callerid"]
        for fact in message.facts:
            try:
                command = parse_command(fact, self.name)
            except FactError as error:
                rospy.logerr("%s: dropped a fact from %s: %s", self.name, sender, error)
            else:
                job = functools.partial(self._obey, command, sender)
                self._guarded(job, self._attempts.get(command.action))

    def _obey(self, command: Command, sender: str) -> None:
        attempt = self._attempts.get(command.action)
        if command.verb is Verb.RUN and attempt is None:
            self._begin(command.action, sender)
        elif command.verb is Verb.RUN:
            rospy.logwarn("%s: %s is under way already", self.name, command.action.atom)
        elif attempt is None:
            rospy.logwarn("%s: nothing to cancel, %s is not under way", self.name, command.action.atom)
        else:
            self._handle(attempt, Event.CANCEL)

    # ---- one attempt ----------------------------------------------------------------------------------------------

    def _begin(self, action: Action, sender: str) -> None:
        try:
            goal = self.make_goal(action)
            if not isinstance(goal, self._goal_class):
                raise TypeError(f"make_goal gave {goal!r}: return a {self._goal_class.__name__}")
            goal.serialize(io.BytesIO())  # a value that does not fit its field is told now: rospy could send no more
        except RefusalError as error:
            self._conclude(action, Ended(error.reason, str(error)), sender)
        except Exception as error:  # noqa: BLE001 a subclass's fault must not leave the core without an answer
            self._conclude(action, Ended("bad_parameter", self._health.fault(error)), sender)
        else:
            self._attempts[action] = _Attempt(action, goal, sender, self._limits, _now())
            self._settle()

    def _handle(self, attempt: _Attempt, event: Event, ended: Optional[Ended] = None) -> None:
        if ended is not None and not attempt.run.done:
            attempt.ended = ended
        self._do(attempt, attempt.run.handle(event, _now()))

    def _do(self, attempt: _Attempt, effect: Effect) -> None:
        if effect is Effect.SEND:
            attempt.handle = self._link.send(attempt.goal, functools.partial(self._report, attempt))
        if effect in (Effect.CANCEL, Effect.ABANDON) and attempt.handle is not None:
            self._link.cancel(attempt.handle)
        if effect in (Effect.FINISH, Effect.ABANDON):
            self._finish(attempt)

    def _report(self, attempt: _Attempt, event: Event, ended: Optional[Ended]) -> None:
        taken = event is Event.ENDED and ended is not None and ended.status in _TAKEN
        self._post(functools.partial(self._handle, attempt, Event.TAKEN if taken else event, ended), attempt)

    def _finish(self, attempt: _Attempt) -> None:
        action, ended = attempt.action, conclude(attempt.run.verdict, attempt.ended)
        result = self._answer(action, ended)
        if self._is_worth_another(attempt, ended, result):
            rospy.logwarn("%s: %s: %s; once more", self.name, action.atom, self._words(ended))
            self._attempts[action] = attempt.again(_now())
            return
        del self._attempts[action]
        self._publish(action, ended, result, attempt.asked_by)

    def _conclude(self, action: Action, ended: Ended, sender: str) -> None:
        self._publish(action, ended, self._answer(action, ended), sender)

    def _answer(self, action: Action, ended: Ended) -> Answer:
        try:
            found = self.make_answer(action, ended)
            if not isinstance(found, Answer):
                raise TypeError(f"make_answer gave {found!r}: return an Answer")
            return found
        except Exception as error:  # noqa: BLE001 as in _begin
            return Answer(Function("failed"), warnings=(self._health.fault(error),))

    def _is_worth_another(self, attempt: _Attempt, ended: Ended, result: Answer) -> bool:
        if ended.status == SUCCEEDED or attempt.run.verdict in _FINAL or attempt.limits.retries < 1:
            return False
        return str(result.value).partition("(")[0] in self._retry_on

    # ---- time and shutdown ----------------------------------------------------------------------------------------

    def _settle(self) -> float:
        now = _now()
        gone = bool(self._attempts) and self._link.gone(now.wall)
        for attempt in list(self._attempts.values()):
            self._guarded(functools.partial(self._tick, attempt, now, gone), attempt)
        self._guarded(self._health.tick)
        return TICK if self._outbox.flush(now.wall) or self._attempts else IDLE_TICK

    def _tick(self, attempt: _Attempt, now: Instant, gone: bool) -> None:
        if attempt.run.phase is Phase.WAITING and self._link.connected:
            self._handle(attempt, Event.SERVER_FOUND)
        elif attempt.run.phase is Phase.WAITING and self._link.starting and attempt.run.wait_on(now):
            rospy.loginfo("%s: waits for the action server %s, which is starting", self.name, self._server)
        elif attempt.run.phase is not Phase.WAITING and gone:
            self._handle(attempt, Event.SERVER_LOST)
        else:
            self._do(attempt, attempt.run.tick(now))

    def _look(self) -> Tuple[bool, List[str]]:
        return self._link.connected, [str(action.atom) for action in self._attempts]

    def _shut_down(self) -> None:
        attempts = list(self._attempts.values())
        for attempt in attempts:
            self._guarded(functools.partial(self._handle, attempt, Event.SHUTDOWN), attempt)
        self._link.wait_for_cancels([one.handle for one in attempts if one.handle is not None], CANCEL_PATIENCE)

    # ---- faults: of this interface, which others on its worker have no part in --------------------------------------

    def _post(self, job: Callable[[], None], attempt: Optional[_Attempt] = None) -> None:
        self._worker.put(functools.partial(self._guarded, job, attempt))

    def _guarded(self, job: Callable[[], None], attempt: Optional[_Attempt] = None) -> None:
        """Do what a subclass, its goals and its server have a hand in; a fault costs no more than its attempt."""
        try:
            job()
        except Exception as error:  # noqa: BLE001 a subclass may give anything, such as a goal of another type
            ended = Ended("aborted", self._health.fault(error))
            if attempt is not None and self._attempts.pop(attempt.action, None) is not None:
                if attempt.handle is not None:
                    self._link.cancel(attempt.handle)
                self._publish(attempt.action, ended, Answer(Function("failed")), attempt.asked_by)

    # ---- out ------------------------------------------------------------------------------------------------------

    def _publish(self, action: Action, ended: Ended, result: Answer, reader: str) -> None:
        for warning in result.warnings:
            rospy.logerr("%s: %s: %s", self.name, action.atom, warning)
        succeeded = ended.status == SUCCEEDED
        if not succeeded:
            rospy.logwarn("%s: %s: %s", self.name, action.atom, self._words(ended))
        self._health.note(succeeded, f"{action.atom}: {self._words(ended)}")
        facts = [*result.facts, return_text(action, result.value)]
        self._outbox.put(InterfaceIO(interface=self.name, facts=facts), reader, _now().wall)

    def _words(self, ended: Ended) -> str:
        """How an action ended, for people."""
        why = ended.text or (f"the action server {self._server} does not answer" if ended.status == LOST else "")
        return f"{ended.status}: {why}" if why else ended.status


def _now() -> Instant:
    return Instant(rospy.get_time(), time.monotonic())
