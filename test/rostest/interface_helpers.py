"""Shared by the tests of the interface layer: the core's side of the two topics, and actionlib servers on demand."""

import os
import queue
import re
import signal
import subprocess
import threading
import unittest
import xmlrpc.client
from contextlib import suppress
from urllib.parse import urlsplit

import rosgraph
import rospy
from actionlib.action_server import ActionServer
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from rosgraph_msgs.msg import Log
from rosoclingo.msg import InterfaceIO
from waiting import PATIENCE, wait_until

from rosoclingo.common.connections import is_delivered_to
from rosoclingo.common.parameters import ParameterError
from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.registration import Registration
from rosoclingo.common.xmlrpc_api import FAULTS, api


def base_at(x, y):
    """Return the transform of a robot at a place of the map."""
    transform = TransformStamped(child_frame_id="base_link")
    transform.header.frame_id = "map"
    transform.transform.translation.x, transform.transform.translation.y = x, y
    transform.transform.rotation.w = 1.0
    return transform


def init_node(name):
    """Initialize the test as a node, which finds publishers that rospy has missed as the package's own nodes do."""
    rospy.init_node(name)
    Registration()


def executable(name):
    """Return the file of a script of this package; rosrun takes longer to find it than a node to start."""
    spaces = os.environ["CMAKE_PREFIX_PATH"].split(os.pathsep)
    files = [os.path.join(space, "lib", "rosoclingo", name) for space in spaces]
    return next(file for file in files if os.path.exists(file))


def wait_to_hear(*subscribers, nodes=()):
    """Wait until all publishers of the topics of these subscribers are connected; also those of these nodes.

    rospy counts a connection at its reading end first: messages published before the writing end does are lost.
    """
    wanted, me = [rospy.resolve_name(node) for node in nodes], rospy.get_name()
    for topic in [one.resolved_name for one in subscribers]:
        wait_until(lambda name=topic: is_delivered_to(me, name, wanted), f"the publishers of {topic} to write to us")


def heard_log(*nodes):
    """Return the list of all messages on /rosout from now on, also of these nodes."""
    lines = []
    log = rospy.Subscriber("/rosout", Log, lambda one: lines.append(one.msg), queue_size=None)
    wait_to_hear(log, nodes=nodes)
    return lines


def wait_for_server(client):
    """Wait in wall time until an actionlib client and its server are connected in both directions."""
    wait_until(lambda: client.pub_goal.get_num_connections() and client.pub_cancel.get_num_connections(), "a server")
    wait_to_hear(client.status_sub, client.feedback_sub, client.result_sub)


class CoreSide:
    """Sends commands as the core does and collects the answers.

    With a run it announces the run and sends the actions under way to each newcomer, as the core does; without a run
    it is a core without runs.
    """

    def __init__(self, run=None, under_way=()):
        self._messages = queue.Queue()
        self.under_way = [InterfaceIO(interface=name, facts=[fact]) for name, fact in under_way]
        self._run = [InterfaceIO(interface="rosoclingo", facts=[f'_run("{run}")'])] if run else []
        self._publisher = prompt_publisher("out_rosoclingo", InterfaceIO, greeting=self._greeting)
        self.announced = set()
        self._subscriber = rospy.Subscriber("in_rosoclingo", InterfaceIO, self._note)

    def _greeting(self):
        return [*self._run, *self.under_way]

    def _note(self, message):
        if message.facts:
            self._messages.put(message)
        else:
            self.announced.add(message.interface)

    def wait_for(self, *nodes):
        """Wait until these nodes are connected in both directions."""
        for node in map(rospy.resolve_name, nodes):
            wait_until(lambda name=node: self._publisher.impl.has_connection(name), f"{node} to listen")
        wait_to_hear(self._subscriber, nodes=nodes)

    def begin(self, interface, fact):
        """Send an action, also to newcomers."""
        self.under_way.append(InterfaceIO(interface=interface, facts=[fact]))
        self.send(interface, fact)

    def cancel(self, interface, fact):
        """Cancel an action, also for newcomers: a node that was killed perhaps missed the cancel."""
        cancellation = fact.replace("_action_lib", "_cancel")
        self.under_way.append(InterfaceIO(interface=interface, facts=[cancellation]))
        self.send(interface, cancellation)

    def die(self):
        """Disconnect in both directions."""
        self._publisher.unregister()
        self._subscriber.unregister()

    def send(self, interface, *facts):
        self._publisher.publish(InterfaceIO(interface=interface, facts=list(facts)))

    def receive(self):
        """Return the facts of the next message."""
        return self._messages.get(timeout=PATIENCE).facts

    def silent(self):
        return self._messages.empty()

    def run(self, interface, *facts):
        """Send one message and wait for the facts that answer it."""
        self.send(interface, *facts)
        return self.receive()


def refuses(node, words, **parameters):
    """Check that a class of nodes refuses these private parameters, with these words."""
    for name, value in parameters.items():
        rospy.set_param("~" + name, value)
    try:
        with unittest.TestCase().assertRaisesRegex(ParameterError, re.escape(words)):
            node()
    finally:
        for name in parameters:
            rospy.delete_param("~" + name)


def master_answers():
    """Return whether there is a master at the address of ROS_MASTER_URI."""
    with suppress(*FAULTS):
        return api(os.environ["ROS_MASTER_URI"]).getPid("/test")[0] == 1


def process_of(node):
    """Return the process of a node; OSError if another system's node has the address of a dead one."""
    uri = rosgraph.Master(rospy.get_name()).lookupNode(rospy.resolve_name(node))
    there = xmlrpc.client.ServerProxy(uri)
    master = there.getMasterUri(rospy.get_name())[2]
    if urlsplit(master).port != urlsplit(rosgraph.get_master_uri()).port:
        raise ConnectionError(f"at {uri}, where {node} was, there is a node of {master}")
    return there.getPid(rospy.get_name())[2]


def is_another(node, process):
    """Return whether a killed node exists again, as another process."""
    try:
        return process_of(node) != process
    except OSError:
        return False  # the master has the dead one's address


def kill(*nodes):
    """Kill nodes at once, and wait until each is restarted."""
    processes = {node: process_of(node) for node in nodes}
    for process in processes.values():
        os.kill(process, signal.SIGKILL)
    for node, process in processes.items():
        wait_until(lambda one=node, old=process: is_another(one, old), f"{node} to be started again")


def wait_for_diagnosis(name, condition, what):
    """Return the next status of /diagnostics that meets a condition."""
    reports, found = [], []
    subscriber = rospy.Subscriber("/diagnostics", DiagnosticArray, lambda one: reports.extend(one.status))
    wait_until(lambda: found.extend(one for one in list(reports) if one.name == name and condition(one)) or found, what)
    subscriber.unregister()
    return found[0]


def values_of(status):
    """Return the values of a diagnostic status as a dict."""
    return {pair.key: pair.value for pair in status.values}


class Server:
    """A real actionlib server, controlled by the test."""

    def __init__(self, name, action):
        self._goals = queue.Queue()
        self._cancels = queue.Queue()
        self._server = ActionServer(name, action, self._goals.put, self._cancels.put, auto_start=False)
        self._server.start()

    def take(self):
        """Return the next goal's handle."""
        return self._goals.get(timeout=PATIENCE)

    def accept(self):
        """Accept the next goal and return its handle."""
        handle = self.take()
        handle.set_accepted()
        return handle

    def readers(self):
        """Return the connections on which clients receive results."""
        return tuple(self._server.result_pub.impl.connections)

    def wait_for_new_reader(self, node, known):
        """Wait until a node receives results on a connection that is not among the known ones."""
        name = rospy.resolve_name(node)
        wait_until(
            lambda: any(one.endpoint_id == name and one not in known for one in self.readers()),
            f"{node} to hear results",
        )

    def idle(self):
        """Return whether no goal is waiting to be taken."""
        return self._goals.empty()

    def cancelled(self):
        """Return the handle of the next goal that a client cancels."""
        return self._cancels.get(timeout=PATIENCE)


class Process:
    """A command whose standard error is read; it ends with the test."""

    _pipe = "stderr"

    def __init__(self, *command, cwd=None, **environment):
        variables = {**os.environ, "PYTHONUNBUFFERED": "1", **environment}
        settings = {"cwd": cwd, "env": variables, self._pipe: subprocess.PIPE}
        self._process = subprocess.Popen(command, text=True, start_new_session=True, **settings)

    @property
    def running(self):
        """Whether it has not ended."""
        return self._process.poll() is None

    def lines_until(self, words):
        """Return the lines up to the one with these words, which must come before the end."""
        lines = []
        timer = threading.Timer(PATIENCE, self.signal, [signal.SIGKILL])
        timer.start()
        for line in getattr(self._process, self._pipe):
            lines.append(line.rstrip("\n"))
            if words in line:
                break
        timer.cancel()
        assert words in "".join(lines[-1:]), f"nothing of '{words}' in: {lines}"
        return lines

    def signal(self, number):
        os.killpg(self._process.pid, number)

    def wait(self, patience=PATIENCE):
        """Return exit code and the remaining text."""
        texts = self._process.communicate(timeout=patience)
        return self._process.returncode, texts[self._pipe == "stderr"]

    def refuses(self, words):
        """Wait until the node ends at its start, and check its message."""
        code, error = self.wait()
        assert code == 1, error
        assert words in error
        assert "Traceback" not in error

    def __enter__(self):
        return self

    def __exit__(self, *_):
        if self.running:
            self.signal(signal.SIGKILL)
        self._process.communicate()


class OutputProcess(Process):
    """A command whose standard output is read."""

    _pipe = "stdout"


class CommandProcess(OutputProcess):
    """One of the package's commands, whose standard output is read."""

    def __init__(self, name, *words, **environment):
        super().__init__(executable(name), *words, **environment)


def send_request(*words, **environment):
    """Start the command request, which waits patiently for its server."""
    return CommandProcess("request", "--wait", str(PATIENCE), *words, **environment)
