"""The common pattern of all interfaces: read commands, send actionlib goals, wait, answer."""

import abc
import functools
import io
import time
from pathlib import Path
from typing import Any, Callable, Dict, List, Optional, Tuple

import rospkg
import rospy
from clingo import Function

from rosoclingo.common.worker import Worker
from rosoclingo.interfaces.action_runs import DEFAULT_LIMITS, ActionEvent, ActionLimits, Effect, Instant, Phase, Run
from rosoclingo.interfaces.answers import INTERRUPTED, LOST, SUCCEEDED, Answer, answer, in_words
from rosoclingo.interfaces.attempt import Attempt
from rosoclingo.interfaces.config import DEFAULT_RETRY_ON
from rosoclingo.interfaces.doubt import Check, Inquiry, InquiryResult, Listed
from rosoclingo.interfaces.facts import (
    CommandError,
    InterfaceCommand,
    Sender,
    SentActions,
    Verb,
    parse_command,
    return_text,
)
from rosoclingo.interfaces.inbox import inbox_of
from rosoclingo.interfaces.interface_state import InterfaceHealth
from rosoclingo.interfaces.link import ServerLink, new_goal_id, progress
from rosoclingo.interfaces.memory import ActionMemory
from rosoclingo.interfaces.outbox import Outbox
from rosoclingo.interfaces.templates import ActionScope, Ended
from rosoclingo.msg import InterfaceIO
from rosoclingo.reasoning.keywords import Action

IN_TOPIC = "in_rosoclingo"

DEFAULT_MEMORY = Path(rospkg.get_ros_home(), "rosoclingo", "interfaces")

TICK, IDLE_TICK = 0.05, 1.0  # seconds of wall time between two looks at what is under way, and where nothing is
CANCEL_PATIENCE = 1.0  # seconds of wall time that an interface which ends waits for its server to take the cancels


class RefusalError(ValueError):
    """An action that cannot be turned into a goal: `reason` is the name of the return term, the message says why."""

    def __init__(self, reason: str, message: str) -> None:
        super().__init__(message)
        self.reason = reason


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

    An action that a core which announces its run sends again is not done again: what is under way goes on, what was
    answered is answered again, and what a node that died had begun is looked for at the server, then by `make_check`;
    if neither can tell, it is done again if `repeatable`, else answered `interrupted`.  Actions of a former run are
    cancelled, and not answered.

    Subscribes:
        out_rosoclingo (rosoclingo/InterfaceIO): `_action_lib(A,P,C)` runs an action, `_cancel(A,P,C)` cancels it;
            under the name `rosoclingo` the core's `_run("ID")`, before anything else that it sends to a listener.
            Messages with another interface's name are dropped unread.
    Publishes:
        in_rosoclingo (rosoclingo/InterfaceIO): `_return(A,V,C)` behind the further facts of the answer, if any; to each
            node that connects first a message without facts, which announces the interface.
        /diagnostics (diagnostic_msgs/DiagnosticArray): server, actions under way, counts, the last failure and
            fault, once a second and on change.
    Actions called:
        SERVER: that of the action, by name and type; it may come, go and come back.

    Arguments: the interface's name (the first argument of `_action_lib`), the action type, the server's name, time
    limits and retries, the reasons after which a goal is sent again, the worker on which all this runs, whether an
    action may be done twice without harm, and the folder that keeps what was begun and answered (None: in no file).
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
        self._sent = SentActions()
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
        """The goal message for an action.  Raise RefusalError if there is none."""

    def make_answer(self, action: Action, ended: Ended) -> Answer:
        """What to tell the core about an action whose goal has ended in this way."""
        return answer((), ActionScope(action.parameter, action.cycle, ended=ended))

    def make_check(self, action: Action) -> Optional[Check]:
        """What tells of an action that may have been done whether it was; None where nothing can.

        It is called without arguments until it says True or False, for at most `server_timeout` seconds; None means
        that it cannot tell yet.  During these calls no server has the action's goal, unless it ignores cancels.
        """
        return None

    # ---- in: what the inbox reads, on the worker's thread -----------------------------------------------------------

    def _read(self, message: InterfaceIO, sender: Sender) -> None:
        commands: List[InterfaceCommand] = []
        for fact in message.facts:
            try:
                commands.append(parse_command(fact, self.name))
            except CommandError as error:
                rospy.logerr("%s: dropped a fact from %s: %s", self.name, sender.node, error)
        self._sent.add(commands)
        for command in commands:
            self._guarded(functools.partial(self._obey, command, sender), self._attempts.get(command.action))

    def _obey(self, command: InterfaceCommand, sender: Sender) -> None:
        attempt = self._attempts.get(command.action)
        if command.verb is Verb.RUN and attempt is None:
            self._begin(command.action, sender)
        elif command.verb is Verb.RUN and attempt is not None:
            attempt.asked_by = attempt.asked_by if sender.run is None else sender
            rospy.loginfo("%s: %s is under way already", self.name, command.action.atom)
        elif attempt is None:
            rospy.logwarn("%s: nothing to cancel, %s is not under way", self.name, command.action.atom)
        elif not sender.may_cancel(attempt.asked_by):
            rospy.logwarn("%s: %s goes on: the core that cancels it has been replaced", self.name, command.action.atom)
        else:
            attempt.unwanted = True

    def _begin_run(self, run: str) -> None:
        if not self._memory.begin_run(run):
            return
        self._sent.clear()
        for action, attempt in list(self._attempts.items()):
            if attempt.asked_by.run is not None:
                rospy.logwarn("%s: %s is of a former run: it is cancelled", self.name, action.atom)
                del self._attempts[action]
                self._cancel(attempt)

    # ---- one attempt ----------------------------------------------------------------------------------------------

    def _begin(self, action: Action, sender: Sender) -> None:
        known = self._memory.recall(str(action.atom)) if self._remembers(sender) else None
        if known is not None and known.facts is not None:
            rospy.loginfo("%s: %s was answered already: it is answered again", self.name, action.atom)
            self._send(list(known.facts), sender)
            return
        try:
            goal = self.make_goal(action)
            if not isinstance(goal, self._goal_class):
                raise TypeError(f"make_goal gave {goal!r}: return a {self._goal_class.__name__}")
            goal.serialize(io.BytesIO())  # a value that does not fit fails here: rospy's publisher would be broken
        except RefusalError as error:
            self._conclude(action, Ended(error.reason, str(error)), sender)
        except Exception as error:  # noqa: BLE001 a subclass's fault must not leave the core without an answer
            self._conclude(action, Ended("bad_parameter", self._health.fault(error)), sender)
        else:
            attempt = self._attempts[action] = Attempt(action, goal, sender, self._limits, _now())
            if known is not None:
                rospy.logwarn("%s: %s was begun by a node that died", self.name, action.atom)
                attempt.goal_id = known.goal
                self._inquire(attempt, self.make_check(action))
            self._settle()

    def _do(self, attempt: Attempt, effect: Effect) -> None:
        if effect is Effect.SEND:
            if self._remembers(attempt.asked_by):
                self._memory.note_begun(str(attempt.action.atom), attempt.goal_id)
            self._link.send(self._tracked(attempt))
        if effect in (Effect.CANCEL, Effect.ABANDON):
            self._cancel(attempt)
        if effect in (Effect.FINISH, Effect.ABANDON):
            self._finish(attempt)

    def _tracked(self, attempt: Attempt) -> Any:
        if attempt.handle is None:
            attempt.handle = self._link.track(attempt.goal, attempt.goal_id, lambda: self._worker.put(_wake))
        return attempt.handle

    def _cancel(self, attempt: Attempt) -> None:
        if attempt.handle is not None:
            self._link.cancel(attempt.handle)

    def _finish(self, attempt: Attempt) -> None:
        ended, sent = attempt.conclusion, attempt.handle is not None and attempt.lost is None
        asks = ended.status == LOST and attempt.lost is None and (sent or attempt.doubtful)
        check = self.make_check(attempt.action) if asks else None
        if check is None:
            attempt.doubtful |= ended.status == LOST and sent
            self._end(attempt, ended)
        else:
            attempt.lost, attempt.handle = ended, None
            self._inquire(attempt, check)

    def _end(self, attempt: Attempt, ended: Ended) -> None:
        action = attempt.action
        result = self._answer(action, ended)
        if attempt.is_worth_another(ended, result.value, self._retry_on):
            rospy.logwarn("%s: %s: %s; once more", self.name, action.atom, in_words(ended, self._server))
            self._attempts[action] = attempt.again(ended, _now())
            return
        del self._attempts[action]
        self._publish(action, ended, result, attempt.asked_by)

    def _conclude(self, action: Action, ended: Ended, sender: Sender) -> None:
        self._publish(action, ended, self._answer(action, ended), sender)

    def _answer(self, action: Action, ended: Ended) -> Answer:
        try:
            found = self.make_answer(action, ended)
            if not isinstance(found, Answer):
                raise TypeError(f"make_answer gave {found!r}: return an Answer")
            return found
        except Exception as error:  # noqa: BLE001 as in _begin
            return Answer(Function("failed"), warnings=(self._health.fault(error),))

    # ---- in doubt: what may have been done --------------------------------------------------------------------------

    def _inquire(self, attempt: Attempt, check: Optional[Check]) -> None:
        attempt.inquiry = Inquiry(check, attempt.limits.server_timeout, _now().wall)
        attempt.stale_status = self._link.last_status
        self._tracked(attempt)

    def _look_for(self, attempt: Attempt, inquiry: Inquiry, now: Instant) -> None:
        """Go on with an attempt in doubt as soon as it is known what has become of its action."""
        held = attempt.run.unheeded  # perhaps for ever: only the world is asked
        listed = Listed.ABSENT if held else self._link.look_up(attempt.handle, attempt.stale_status)
        finding = inquiry.look(listed, now.wall)
        if finding is InquiryResult.OPEN:
            return
        rospy.loginfo("%s: %s: %s", self.name, attempt.action.atom, finding.value)
        attempt.inquiry = None
        if finding in (InquiryResult.UNKNOWN, InquiryResult.NOT_DONE):
            attempt.doubtful = finding is InquiryResult.UNKNOWN
        if finding is InquiryResult.HELD:
            self._take_up(attempt, now)
        elif finding is InquiryResult.DONE:
            self._end(attempt, Ended(SUCCEEDED, "it was done already"))
        elif attempt.lost is not None:
            self._end(attempt, attempt.lost)
        elif finding is InquiryResult.UNKNOWN and (attempt.unwanted or not self._repeatable):
            text = "it was begun by a node that died, and whether it was done is not known"
            self._end(attempt, Ended(INTERRUPTED, text))
        elif inquiry.used:
            attempt.goal_id, attempt.handle = new_goal_id(), None

    def _take_up(self, attempt: Attempt, now: Instant) -> None:
        """Go on with the goal that the server has."""
        attempt.lost, attempt.run = None, Run(attempt.limits, now)
        attempt.run.handle(ActionEvent.SERVER_FOUND, now)
        attempt.run.handle(ActionEvent.ACKNOWLEDGED, now)

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
        if attempt.inquiry is not None:
            self._look_for(attempt, attempt.inquiry, now)
            return
        run = attempt.run
        for event in (self._event(attempt, gone), ActionEvent.CANCEL if attempt.unwanted else None):
            if event is not None and not run.done:
                self._do(attempt, run.handle(event, now))
        if run.phase is Phase.WAITING and self._link.starting and run.wait_on(now):
            rospy.loginfo("%s: waits for the action server %s, which is starting", self.name, self._server)
        elif not run.done:
            self._do(attempt, run.tick(now))

    def _event(self, attempt: Attempt, gone: bool) -> Optional[ActionEvent]:
        """Return what the server has done, None for nothing yet."""
        if attempt.run.phase is Phase.WAITING:
            return ActionEvent.SERVER_FOUND if self._link.connected and not attempt.unwanted else None
        if gone:
            return ActionEvent.SERVER_LOST
        event, ended = progress(attempt.handle)
        attempt.ended = ended or attempt.ended
        return event

    def _look(self) -> Tuple[bool, List[str]]:
        return self._link.connected, [str(action.atom) for action in self._attempts]

    def _shut_down(self) -> None:
        self._settle()  # goals that have ended are answered by their ends
        attempts = list(self._attempts.values())
        for attempt in attempts:
            self._guarded(functools.partial(self._give_up, attempt), attempt)
        self._link.wait_for_cancels([one.handle for one in attempts if one.handle is not None], CANCEL_PATIENCE)

    def _give_up(self, attempt: Attempt) -> None:
        if attempt.inquiry is not None:
            self._cancel(attempt)
        attempt.unwanted = True
        if attempt.lost is not None:
            self._end(attempt, attempt.lost)
        else:
            self._do(attempt, attempt.run.handle(ActionEvent.SHUTDOWN, _now()))

    # ---- faults: of this interface, which others on its worker have no part in --------------------------------------

    def _guarded(self, job: Callable[[], None], attempt: Optional[Attempt] = None) -> None:
        """Do what a subclass, its goals and its server have a hand in; a fault costs no more than its attempt."""
        try:
            job()
        except Exception as error:  # noqa: BLE001 a subclass may give anything, such as a goal of another type
            ended = Ended("aborted", self._health.fault(error))
            if attempt is not None and self._attempts.get(attempt.action) is attempt:
                del self._attempts[attempt.action]
                self._cancel(attempt)
                self._publish(attempt.action, ended, Answer(Function("failed")), attempt.asked_by)

    # ---- out ------------------------------------------------------------------------------------------------------

    def _publish(self, action: Action, ended: Ended, result: Answer, reader: Sender) -> None:
        for warning in result.warnings:
            rospy.logerr("%s: %s: %s", self.name, action.atom, warning)
        succeeded = ended.status == SUCCEEDED
        if not succeeded:
            rospy.logwarn("%s: %s: %s", self.name, action.atom, in_words(ended, self._server))
        self._health.note(succeeded, f"{action.atom}: {in_words(ended, self._server)}")
        done = succeeded if result.success is None else result.success
        value = self._sent.value(action, result.value, done, self._knows)
        if value != result.value:
            text = "%s: %s returns %s: its reason %s is the parameter of an action, which would mean success"
            rospy.logwarn(text, self.name, action.atom, value, result.value)
        facts = [*result.facts, return_text(action, value)]
        if self._remembers(reader):
            self._memory.note_answered(str(action.atom), tuple(facts))
        self._send(facts, reader)

    def _knows(self, action: Action) -> bool:
        return self._memory.recall(str(action.atom)) is not None

    def _send(self, facts: List[str], reader: Sender) -> None:
        """Tell the core. One that has announced its run asks again when it is back; another is waited for a moment."""
        wanted = None if reader.run is None else functools.partial(self._inbox.hears, reader)
        self._outbox.put(InterfaceIO(interface=self.name, facts=facts), reader.node, _now().wall, wanted)

    def _remembers(self, sender: Sender) -> bool:
        """Whether the sender's run is the one that is remembered."""
        return sender.run is not None and sender.run == self._memory.run

    def _look_at_memory(self, wall: float) -> None:
        self._memory.tend(wall)
        known, self._health.trouble = self._health.trouble, self._memory.trouble
        if known != self._health.trouble:
            rospy.logerr("%s: %s", self.name, self._health.trouble or "the file of what it has begun is in order again")


def _wake() -> None:
    """Let the worker settle, which looks at what is under way."""


def _now() -> Instant:
    return Instant(rospy.get_time(), time.monotonic())
