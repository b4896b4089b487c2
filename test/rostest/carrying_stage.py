"""A core node between clients and interfaces with late, repeated and false messages: the plays of carrying_world.py."""

import queue
import sys
from pathlib import Path
from random import Random

import rospy
from actionlib import ActionClient
from actionlib.action_client import CommState
from actionlib_msgs.msg import GoalStatus
from rosoclingo.msg import InterfaceIO, ROSoClingoAction, ROSoClingoGoal

from rosoclingo.common.action_clients import cancel_goal
from rosoclingo.reasoning.goals import Outcome
from rosoclingo.reasoning.keywords import CORE

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "unit"))

from carrying_world import Play
from interface_helpers import wait_for_server, wait_to_hear, wait_until

ENDS = {  # a goal that is recalled before it arrives has no result of its own
    GoalStatus.SUCCEEDED: "succeeded",
    GoalStatus.PREEMPTED: "canceled",
    GoalStatus.RECALLED: "canceled",
    GoalStatus.ABORTED: "aborted",
    GoalStatus.REJECTED: "rejected",
}
SILENCE = 120.0  # seconds of wall time within which an event has to happen, on the slowest machine


class Stage:
    """The core node ``name/rosoclingo``, and a play of ``goals`` around it."""

    def __init__(self, name, domain, seed, goals):
        self._happened = queue.Queue()
        self._handles = {}
        self._cancelled = set()
        self.play = Play(domain, self, Random(seed), goals)
        self._publisher = rospy.Publisher(name + "/in_rosoclingo", InterfaceIO, queue_size=1000)
        self._subscriber = rospy.Subscriber(name + "/out_rosoclingo", InterfaceIO, self._note)
        self._client = ActionClient(name + "/rosoclingo", ROSoClingoAction)
        wait_for_server(self._client)
        core = f"/{name}/rosoclingo"
        wait_until(lambda: self._publisher.impl.has_connection(core), f"{core} to listen")
        wait_to_hear(self._subscriber, nodes=[core])

    def send(self, key, text):
        """Send a goal."""
        goal = ROSoClingoGoal(text)
        self._handles[key] = self._client.send_goal(goal, lambda handle: self._changed(key, handle))

    def cancel(self, key):
        """Cancel a goal once the core is known to have it: actionlib would treat an earlier one as lost."""
        self._cancelled.add(key)
        self._cancel(key, self._handles[key])

    def tell(self, facts):
        """Send facts as an interface."""
        self._publisher.publish(InterfaceIO("world", facts))

    def _note(self, message):
        for fact in message.facts if message.interface != CORE else ():
            self._happened.put((self.play.command, (fact,)))

    def _cancel(self, key, handle):
        if key in self._cancelled and handle.get_comm_state() in (CommState.PENDING, CommState.ACTIVE):
            self._cancelled.discard(key)
            cancel_goal(self._client, handle)

    def _changed(self, key, handle):
        self._cancel(key, handle)
        if handle.get_comm_state() != CommState.WAITING_FOR_GOAL_ACK:
            self._happened.put((self.play.acknowledged, (key,)))
        if handle.get_comm_state() == CommState.DONE:
            status, result = handle.get_terminal_state(), handle.get_result()
            end = ENDS.get(status, "lost")
            if result is not None and result.message and Outcome(result.outcome).name.lower() != end:
                end = f"{result.outcome}, but its status is {status}"
            self._happened.put((self.play.ended, (key, end, handle.get_goal_status_text())))

    def run(self):
        """Play until all goals have ended."""
        if not self.play.live:
            self.play.stir()
        while not self.play.over:
            do, arguments = self._happened.get(timeout=SILENCE)
            do(*arguments)
            if not self.play.live:
                self.play.stir()

    def run_to_the_end(self):
        """Play, then request each thing on the robot and one thing more; nothing fails any more."""
        self.run()
        for _ in range(20):
            if not self.play.request_all_things_on_board():
                break
            self.run()
        before = self.play.ends["succeeded"]
        for _ in range(20):
            if self.play.ends["succeeded"] == before:
                self.play.wish()
                self.run()
        return self.play.ends["succeeded"] > before
