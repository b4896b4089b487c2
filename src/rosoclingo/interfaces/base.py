"""Base class of all interfaces: reads commands, sends actionlib goals, waits and answers."""

import abc
import functools
import io
import time
from collections import deque
from pathlib import Path
from typing import Any, Callable, Deque, Dict, List, Optional, Tuple

import rospkg
import rospy
from clingo import Function

from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.answers import SUCCEEDED, Answer, answer, in_words
from rosoclingo.interfaces.attempt import (
    DEFAULT_LIMITS,
    ActionEvent,
    ActionLimits,
    Attempt,
    Check,
    Effect,
    Instant,
    Phase,
)
from rosoclingo.interfaces.config import DEFAULT_RETRY_ON
from rosoclingo.interfaces.facts import (
    REMEMBERED,
    InterfaceCommand,
    Sender,
    parse_command,
    return_text,
    return_value,
)
from rosoclingo.interfaces.inbox import inbox_of
from rosoclingo.interfaces.interface_state import InterfaceHealth
from rosoclingo.interfaces.link import ServerLink, new_goal_id, progress
from rosoclingo.interfaces.memory import ActionMemory
from rosoclingo.interfaces.outbox import Outbox
from rosoclingo.interfaces.templates import ActionScope, GoalEnd
from rosoclingo.interfaces.values import TermError
from rosoclingo.msg import InterfaceIO
from rosoclingo.reasoning.keywords import Action, KeywordError

IN_TOPIC = "in_rosoclingo"

DEFAULT_MEMORY = Path(rospkg.get_ros_home(), "rosoclingo", "interfaces")

TICK, IDLE_TICK = 0.05, 1.0  # seconds of wall time between two checks, with and without running actions


class RefusalError(ValueError):
    """An action that has no goal: `reason` is the name of the return term, the message is for the log."""

    def __init__(self, reason: str, message: str) -> None:
        super().__init__(message)
        self.reason = reason


class Interface(abc.ABC):
    """Base class of interfaces: turns `_action_lib(A,P,C)` into a goal of an actionlib server, and its end into facts.

    A subclass implements `make_goal` and can override `make_answer`; both run on the worker thread:

        class GripperInterface(Interface):
            def make_goal(self, action):
                return GripperCommandGoal(command=GripperCommand(position=GRASPS[str(action.parameter)]))

        worker = Worker()
        GripperInterface("gripper", GripperCommandAction, "gripper_controller", worker=worker)
        worker.start()

    Several actions can run at once.  Each gets exactly one return: the parameter on success, otherwise a reason
    (answers.DEFAULT_RETURNS).  Invalid commands are logged and dropped.  An exception of a subclass ends its action;
    the traceback is logged once, and diagnostics show the error until an action succeeds.

    If the core announces its run, an action that it sends again is not repeated: a running action continues, and an
    answered action gets the same answer.  If a killed node had begun the action, the interface looks for the goal at
    the server, then calls `make_check`.  If the outcome stays unknown, the action is repeated if it is `repeatable`,
    else it returns `interrupted`.  Actions of a previous run are cancelled without an answer.

    Subscribes:
        out_rosoclingo (rosoclingo/InterfaceIO): `_action_lib(A,P,C)` runs an action, `_cancel(A,P,C)` cancels it.
            The core first announces its run to each subscriber, under the name `rosoclingo`: `_run("ID")`.
            Messages for other interfaces are ignored.
    Publishes:
        in_rosoclingo (rosoclingo/InterfaceIO): the further facts of an answer, if any, and `_return(A,V,C)`. A message
            without facts announces the interface: first to each node that connects, and once a second of wall time.
        /diagnostics (diagnostic_msgs/DiagnosticArray): server, running actions, counts, the last failure and the last
            internal error, once a second and on change.
    Actions called:
        SERVER: the action server, by name and type; it can start late, stop and restart.

    Arguments: the interface's name (the first argument of `_action_lib`), the action type, the server's name, time
    limits and retries, the reasons for which a goal is sent again, the worker for all callbacks, whether repeating an
    action does no harm, and the folder in which begun and answered actions are recorded (None: no file).
    """

    def __init__(
        self,
        name: str,
        action_type: type,
        server: str,
        limits: ActionLimits = DEFAULT_LIMITS,
        retry_on: Tuple[str, ...] = DEFAULT_RETRY_ON,
        *,
        worker: Worker,
        repeatable: bool = False,
        memory: Optional[Path] = DEFAULT_MEMORY,
    ) -> None:
        self.name = name
        self._limits = limits
        self._retry_on = retry_on
        self._repeatable = repeatable
        self._memory = ActionMemory(memory, f"{rospy.get_name()} {name}")
        self._worker = worker
        self._attempts: Dict[Action, Attempt] = {}
        self._sent: Deque[Action] = deque(maxlen=REMEMBERED)  # the latest actions of the core
        self._server = server
        self._goal_class = type(action_type().action_goal.goal)
        self._link = ServerLink(server, action_type)
        self._outbox = Outbox(IN_TOPIC, name)
        self._health = InterfaceHealth(name, server, self._look)
        worker.add(self._settle)
        rospy.on_shutdown(lambda: worker.put(functools.partial(self._guarded, self._shut_down)))
        self._inbox = inbox_of(worker)
        self._inbox.add(name, self._read, self._begin_run)

    @abc.abstractmethod
    def make_goal(self, action: Action) -> Any:
        """Return the goal message for an action.  Raise RefusalError if there is none."""

    def make_answer(self, action: Action, ended: GoalEnd) -> Answer:
        """Return the answer to the core for the end of an action's goal."""
        return answer((), ActionScope(action.parameter, action.cycle, ended=ended))

    def make_check(self, action: Action) -> Optional[Check]:
        """Return a function that checks whether an action was done, None if nothing shows that.

        The function has no arguments and returns True, False, or None for unknown. It is called until it returns True
        or False, at most for `server_timeout` seconds.  Meanwhile no server has the action's goal, unless the server
        ignores cancels.
        """
        return None

    # ---- commands from the inbox, on the worker's thread ------------------------------------------------------------

    def _read(self, message: InterfaceIO, sender: Sender) -> None:
        commands: List[InterfaceCommand] = []
        for fact in message.facts:
            try:
                commands.append(parse_command(fact, self.name))
            except (TermError, KeywordError) as error:
                rospy.logerr("%s: dropped a fact from %s: %s", self.name, sender.node, error)
        self._sent.extend(command.action for command in commands if not command.cancels)
        for command in commands:
            self._guarded(functools.partial(self._obey, command, sender), self._attempts.get(command.action))

    def _obey(self, command: InterfaceCommand, sender: Sender) -> None:
        attempt = self._attempts.get(command.action)
        if attempt is None and command.cancels:
            rospy.logwarn("%s: cannot cancel %s: it is not running", self.name, command.action.atom)
        elif attempt is None:
            self._begin(command.action, sender)
        elif not command.cancels:
            attempt.sender = attempt.sender if sender.run is None else sender
            rospy.loginfo("%s: %s is already running", self.name, command.action.atom)
        elif not sender.can_cancel(attempt.sender):
            text = "%s: ignored the cancel of %s: its sender is a core that has been replaced"
            rospy.logwarn(text, self.name, command.action.atom)
        else:
            attempt.cancelled = True

    def _begin_run(self, run: str) -> None:
        if not self._memory.begin_run(run):
            return
        self._sent.clear()
        for action, attempt in list(self._attempts.items()):
            if attempt.sender.run is not None:
                rospy.logwarn("%s: cancelling %s, which belongs to a previous run", self.name, action.atom)
                del self._attempts[action]
                self._cancel(attempt)

    # ---- one attempt ----------------------------------------------------------------------------------------------

    def _begin(self, action: Action, sender: Sender) -> None:
        known = self._memory.recall(str(action.atom)) if self._remembers(sender) else None
        if known is not None and known.facts is not None:
            rospy.loginfo("%s: %s has already ended: sending the same answer again", self.name, action.atom)
            self._send(list(known.facts), sender)
            return
        try:
            goal = self.make_goal(action)
            if not isinstance(goal, self._goal_class):
                raise TypeError(f"make_goal returned {goal!r}, not a {self._goal_class.__name__}")
            goal.serialize(io.BytesIO())  # an invalid value has to fail here: it would break rospy's publisher
        except RefusalError as error:
            refused = GoalEnd(error.reason, str(error))
        except Exception as error:  # noqa: BLE001 the core needs an answer even if a subclass fails
            refused = GoalEnd("bad_parameter", self._health.fault(error))
        else:
            attempt = self._attempts[action] = Attempt(action, goal, sender, self._limits, _now(), self._repeatable)
            if known is not None:
                rospy.logwarn("%s: a killed node had begun %s", self.name, action.atom)
                attempt.goal_id = known.goal
                self._ask(attempt, self.make_check(action))
            self._settle()
            return
        self._publish(action, refused, self._answer(action, refused), sender)

    def _ask(self, attempt: Attempt, check: Optional[Check]) -> None:
        """Begin to ask about the attempt's goal, which a killed node or this one has sent."""
        attempt.begin_asking(check, _now())
        attempt.handle, attempt.stale_status = None, self._link.last_status
        self._tracked(attempt)

    def _apply(self, attempt: Attempt, effect: Effect) -> None:
        if effect is Effect.SEND:
            handle = self._tracked(attempt)
            if self._remembers(attempt.sender):
                self._memory.note_begun(str(attempt.action.atom), attempt.goal_id)
            self._link.send(handle)
        if effect in (Effect.CANCEL, Effect.ABANDON):
            self._cancel(attempt)
        if effect in (Effect.FINISH, Effect.ABANDON):
            self._finish(attempt)

    def _tracked(self, attempt: Attempt) -> Any:
        attempt.goal_id = attempt.goal_id or new_goal_id()
        if attempt.handle is None:
            attempt.handle = self._link.track(attempt.goal, attempt.goal_id, lambda: self._worker.put(_wake))
        return attempt.handle

    def _cancel(self, attempt: Attempt) -> None:
        if attempt.handle is not None:
            self._link.cancel(attempt.handle)

    def _finish(self, attempt: Attempt) -> None:
        if attempt.needs_check:
            check = self.make_check(attempt.action)
            if check is not None:
                self._ask(attempt, check)
                return
            attempt.uncertain = True
        action, ended = attempt.action, attempt.conclusion
        result = self._answer(action, ended)
        if attempt.should_retry(ended, result.value, self._retry_on):
            rospy.logwarn("%s: %s: %s; retrying", self.name, action.atom, in_words(ended, self._server))
            self._attempts[action] = attempt.next_attempt(ended, _now())
            return
        del self._attempts[action]
        self._publish(action, ended, result, attempt.sender)

    def _answer(self, action: Action, ended: GoalEnd) -> Answer:
        try:
            found = self.make_answer(action, ended)
            if not isinstance(found, Answer):
                raise TypeError(f"make_answer returned {found!r}, not an Answer")
            return found
        except Exception as error:  # noqa: BLE001 as in _begin
            return Answer(Function("failed"), warnings=(self._health.fault(error),))

    # ---- time and shutdown ----------------------------------------------------------------------------------------

    def _settle(self) -> float:
        now = _now()
        gone = bool(self._attempts) and self._link.gone(now.wall)
        for attempt in list(self._attempts.values()):
            self._guarded(functools.partial(self._tick, attempt, now, gone), attempt)
        self._guarded(functools.partial(self._look_at_memory, now.wall))
        self._guarded(self._health.tick)
        return TICK if self._outbox.flush(now.wall) or self._attempts else IDLE_TICK

    def _tick(self, attempt: Attempt, now: Instant, gone: bool) -> None:
        if attempt.phase is Phase.ASKING:
            held = attempt.cancel_ignored  # the server can keep the goal for ever: check the world only
            report = ActionEvent.SERVER_LOST if held else self._link.look_up(attempt.handle, attempt.stale_status)
            outcome = attempt.ask(report, now)
            if outcome:
                rospy.loginfo("%s: %s: %s", self.name, attempt.action.atom, outcome)
            if attempt.done:
                self._finish(attempt)
            return
        for event in (self._event(attempt, gone), ActionEvent.CANCEL if attempt.cancelled else None):
            if event is not None and not attempt.done:
                self._apply(attempt, attempt.process(event, now))
        if attempt.phase is Phase.WAITING and self._link.starting and attempt.wait_on(now):
            rospy.loginfo("%s: waiting for the action server %s to start", self.name, self._server)
        elif not attempt.done:
            self._apply(attempt, attempt.tick(now))

    def _event(self, attempt: Attempt, gone: bool) -> Optional[ActionEvent]:
        """Return the latest event of the server, None before the first."""
        if attempt.phase is Phase.WAITING:
            return ActionEvent.SERVER_FOUND if self._link.connected and not attempt.cancelled else None
        if gone:
            return ActionEvent.SERVER_LOST
        event, ended = progress(attempt.handle)
        attempt.ended = ended or attempt.ended
        return event

    def _look(self) -> Tuple[bool, List[str]]:
        return self._link.connected, [str(action.atom) for action in self._attempts]

    def _shut_down(self) -> None:
        self._settle()  # goals that have ended get their own answers
        for attempt in list(self._attempts.values()):
            attempt.cancelled = True
            self._guarded(functools.partial(self._abort, attempt), attempt)

    def _abort(self, attempt: Attempt) -> None:
        self._apply(attempt, attempt.process(ActionEvent.SHUTDOWN, _now()))

    # ---- internal errors, which must not affect other interfaces of the worker --------------------------------------

    def _guarded(self, job: Callable[[], None], attempt: Optional[Attempt] = None) -> None:
        """Run a job that depends on a subclass, its goals or its server; an exception ends its attempt only."""
        try:
            job()
        except Exception as error:  # noqa: BLE001 a subclass can return anything, such as a goal of another type
            ended = GoalEnd("aborted", self._health.fault(error))
            if attempt is not None and self._attempts.get(attempt.action) is attempt:
                del self._attempts[attempt.action]
                self._cancel(attempt)
                self._publish(attempt.action, ended, Answer(Function("failed")), attempt.sender)

    # ---- out ------------------------------------------------------------------------------------------------------

    def _publish(self, action: Action, ended: GoalEnd, result: Answer, reader: Sender) -> None:
        for warning in result.warnings:
            rospy.logerr("%s: %s: %s", self.name, action.atom, warning)
        succeeded = ended.status == SUCCEEDED
        if not succeeded:
            rospy.logwarn("%s: %s: %s", self.name, action.atom, in_words(ended, self._server))
        self._health.note(succeeded, f"{action.atom}: {in_words(ended, self._server)}")
        done = succeeded if result.success is None else result.success
        value = return_value(action, result.value, done, self._was_sent)
        if value != result.value:
            text = "%s: %s returns %s, since its reason %s is the parameter of an action, which would mean success"
            rospy.logwarn(text, self.name, action.atom, value, result.value)
        facts = [*result.facts, return_text(action, value)]
        if self._remembers(reader):
            self._memory.note_answered(str(action.atom), tuple(facts))
        self._send(facts, reader)

    def _was_sent(self, action: Action) -> bool:
        return action in self._sent or self._memory.recall(str(action.atom)) is not None

    def _send(self, facts: List[str], reader: Sender) -> None:
        """Send facts to the core; they wait only briefly for a core that announces no run, as it does not ask again."""
        wanted = None if reader.run is None else functools.partial(self._inbox.hears, reader)
        self._outbox.put(InterfaceIO(interface=self.name, facts=facts), reader.node, _now().wall, wanted)

    def _remembers(self, sender: Sender) -> bool:
        """Return whether the memory belongs to the sender's run."""
        return sender.run is not None and sender.run == self._memory.run

    def _look_at_memory(self, wall: float) -> None:
        self._memory.tend(wall)
        known, self._health.trouble = self._health.trouble, self._memory.trouble
        if known != self._health.trouble:
            rospy.logerr("%s: %s", self.name, self._health.trouble or "the file of its actions can be written again")


def _wake() -> None:
    """Do nothing: any job makes the worker check the running actions."""


def _now() -> Instant:
    return Instant(rospy.get_time(), time.monotonic())
