"""Shared by the tests of the core: a manual interface layer, and clients that record the course of their goals."""

import queue
import threading
from pathlib import Path

import rospy
from actionlib import ActionClient
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus, GoalStatusArray
from interface_helpers import PATIENCE, Process, executable, wait_for_server, wait_to_hear, wait_until
from rosoclingo.msg import GoalState, InterfaceIO, ROSoClingoAction, ROSoClingoGoal
from std_msgs.msg import String

from rosoclingo.common.action_clients import cancel_goal
from rosoclingo.reasoning.keywords import CORE

ERRANDS = str(Path(__file__).resolve().parents[1] / "data" / "errands.lp")


def start_core(namespace, *words, **parameters):
    """Start a core as a process; its topics are /NAMESPACE/..., and its program has errands by default."""
    given = {"program_files": f"[{ERRANDS}]", **parameters}
    values = [f"_{name}:={value}" for name, value in given.items()]
    return Process(executable("core"), "__name:=rosoclingo", f"__ns:={namespace}", *words, *values)


class ManualInterfaces:
    """A manual interface layer: receives the core's commands and answers them on demand, or at once."""

    def __init__(self, core="rosoclingo"):
        self._core = rospy.resolve_name(core)
        space = rospy.names.namespace(self._core)
        self._commands = queue.Queue()
        self._open = []
        self.seen, self.runs = [], []
        self.at_once = False
        self._publisher = rospy.Publisher(space + "in_rosoclingo", InterfaceIO, queue_size=1000)
        self._subscriber = rospy.Subscriber(space + "out_rosoclingo", InterfaceIO, self._note)
        self.connect()

    def connect(self):
        """Wait until the connections with the core exist in both directions."""
        wait_until(lambda: self._publisher.impl.has_connection(self._core), "the core to listen")
        wait_to_hear(self._subscriber, nodes=[self._core])

    def renew_publisher(self):
        """Send facts over another connection from now on; commands arrive over the same one."""
        self._publisher.unregister()
        self._publisher = rospy.Publisher(self._publisher.name, InterfaceIO, queue_size=1000)
        self.connect()

    def _note(self, message):
        if message.interface == CORE:
            self.runs += message.facts
            return
        for fact in message.facts:
            self.seen.append(fact)
            if self.at_once:
                self.succeed(fact)
            else:
                self._commands.put(fact)

    def take(self):
        """Return the next command."""
        command = self._commands.get(timeout=PATIENCE)
        self._open.append(command)
        return command

    def clear(self):
        """Answer the remaining commands, so that the next test starts clean; return those that nobody took."""
        left = [self._commands.get() for _ in range(self._commands.qsize())]
        for command in self._open + left:
            self.succeed(command)
        return left

    def succeed(self, command):
        """Answer a command with success."""
        self._open = [other for other in self._open if other != command]
        self.tell(command.replace("_action_lib", "_return"))

    def fail(self, command, reason="failed"):
        """Answer a command with a reason."""
        self._open.remove(command)
        interface, _, cycle = command[len("_action_lib(") : -1].split(",")
        self.tell(f"_return({interface},{reason},{cycle})")

    def tell(self, *facts, origin="hands"):
        """Send facts."""
        self._publisher.publish(InterfaceIO(origin, list(facts)))


class Client:
    """A client with any number of goals."""

    def __init__(self, server="rosoclingo"):
        self.raw = ActionClient(server, ROSoClingoAction)
        wait_for_server(self.raw)

    def send(self, text):
        """Send a goal."""
        return SentGoal(self.raw, text)


class SentGoal:
    """A goal and its course."""

    def __init__(self, client, text):
        self.text = text
        self.states = []
        self.feedback = []
        self._done = threading.Event()
        self._client = client
        self.handle = client.send_goal(ROSoClingoGoal(text), self._changed, lambda _, one: self.feedback.append(one))

    def _changed(self, handle):
        self.states.append(handle.get_comm_state())
        if handle.get_comm_state() == CommState.DONE:
            self._done.set()

    def entry(self, goals):
        """Return its entry in a message of all goals."""
        key = self.handle.comm_state_machine.action_goal.goal_id
        return next((one for one in goals.goals if one.id == key), GoalState())

    @property
    def has_ended(self):
        """Whether the client knows its end."""
        return self._done.is_set()

    def wait(self, patience=PATIENCE):
        """Return status and result at the end, which comes within some seconds of wall time."""
        assert self._done.wait(patience), f"the goal has not ended: {self.states}"
        return self.handle.get_terminal_state(), self.handle.get_result()

    def ends_as(self, status):
        """Wait for the end, check the status, return the message."""
        found, result = self.wait()
        assert found == status, f"ended as {found} with {result}"
        return result.message

    def arrived(self):
        """Wait until the server has it."""
        wait_until(lambda: self.handle.get_comm_state() != CommState.WAITING_FOR_GOAL_ACK, "the goal to arrive")

    def has_arrived(self):
        """Return whether the server has it; otherwise send it again with its id, since a killed core can lack it."""
        if self.handle.get_comm_state() != CommState.WAITING_FOR_GOAL_ACK:
            return True
        self._client.pub_goal.publish(self.handle.comm_state_machine.action_goal)
        return False

    def cancel(self):
        """Cancel it once the server has it; actionlib's own cancel can lose a goal, even one that has ended."""
        self.arrived()
        cancel_goal(self._client, self.handle)

    def cancelled(self):
        """Cancel it, and wait until the core knows, since a cancel and an answer of an interface race.

        The server publishes the status before it calls the core, and no other status until that call has ended.
        """
        self.cancel()
        cancelling = (GoalStatus.RECALLING, GoalStatus.PREEMPTING)
        wait_until(lambda: self.handle.get_goal_status() in cancelling, "the cancel to arrive")
        rospy.wait_for_message(self._client.ns + "/status", GoalStatusArray, PATIENCE)


class Updates:
    """All stream updates from now on."""

    def __init__(self, core="rosoclingo"):
        self.texts = []
        self._subscriber = rospy.Subscriber(core + "/updates", String, lambda message: self.texts.append(message.data))
        wait_to_hear(self._subscriber)

    def wait_for(self, words):
        """Return the first update with ``words``; a message about a goal can come before the update that caused it."""
        wait_until(lambda: any(words in text for text in self.texts), f"an update with {words}")
        return next(text for text in self.texts if words in text)
