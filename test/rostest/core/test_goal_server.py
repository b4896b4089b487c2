"""The core's action server alone: statuses while arrivals wait, and ends that actionlib decides by itself."""

import unittest
from unittest import mock

import rospy
from actionlib_msgs.msg import GoalID, GoalStatus, GoalStatusArray
from core_helpers import Client
from interface_helpers import wait_until
from rosoclingo.msg import GoalStates, ROSoClingoActionGoal, ROSoClingoActionResult, ROSoClingoGoal, ROSoClingoResult

from rosoclingo.common.action_servers import start_server
from rosoclingo.nodes.core import goal_handles
from rosoclingo.nodes.core.goal_server import LONGEST_ID, MOST_ARRIVALS, GoalServer
from rosoclingo.reasoning.events import GoalChanged
from rosoclingo.reasoning.goals import GoalEvent, GoalState, Outcome

CANCELED = ROSoClingoResult.CANCELED


class Core:
    """The core's side of a server: the test is its worker, and takes arrivals on demand."""

    def __init__(self, name):
        self.handles, self.cancelled, self.calls = [], [], 0
        self.server = GoalServer(name, self.handles.append, self.cancelled.append, self.call)
        start_server(self.server)

    def call(self):
        """Count how often the worker is asked to take arrivals."""
        self.calls += 1

    def take(self):
        """Wait for an arrival, and take all queued ones, as the worker does."""
        wait_until(lambda: self.server.arrivals, "an arrival")
        while self.server.arrivals:
            self.server.take(self.keep)

    def keep(self):
        """Write the journal."""


class Statuses:
    """All statuses and results from now on."""

    def __init__(self, name):
        self.messages, self.results = [], []
        rospy.Subscriber(name + "/status", GoalStatusArray, self.messages.append, queue_size=10000)
        rospy.Subscriber(name + "/result", ROSoClingoActionResult, self.results.append, queue_size=10000)

    @property
    def goals(self):
        """Return the goals that were ever in a status."""
        return {one.goal_id.id for message in self.messages for one in message.status_list}


class GoalServerTest(unittest.TestCase):
    def start(self, name):
        """Start a server, a client of it, and a recorder of all statuses."""
        core, statuses = Core(name), Statuses(name)
        return core, Client(name), statuses

    def test_goal_cancelled_before_worker_takes_it_is_not_lost(self):
        core, client, statuses = self.start("waits")
        other = client.send("do(walk,0)")
        core.take()
        goal = client.send("do(walk,1)")
        wait_until(lambda: core.server.arrivals, "the goal")
        goal.handle.cancel()
        with mock.patch.object(core.server.status_pub, "publish") as publish:
            core.handles[0].set_accepted("it")  # each of these publishes the status
            core.server.publish_status()
            core.server.publish_status_async(None)
            wait_until(lambda: core.server.arrivals == 2, "the cancel")
        publish.assert_not_called()
        before = len(statuses.messages)
        core.take()
        wait_until(lambda: len(statuses.messages) > before, "the status that was held back")
        core.cancelled[0].set_canceled(ROSoClingoResult(CANCELED, "as you like"), "as you like")
        self.assertEqual(goal.wait()[0], GoalStatus.RECALLED)
        core.handles[0].set_succeeded(ROSoClingoResult(), "met")
        other.ends_as(GoalStatus.SUCCEEDED)

    def test_status_has_goals_and_cancels_once_in_journal(self):
        core, client, statuses = self.start("keeps")
        goals, reported = [client.send(f"do(walk,{number})") for number in range(3)], []
        core.keep = lambda: (reported.append(set(statuses.goals)), core.server.publish_status())
        wait_until(lambda: core.server.arrivals == 3, "the goals")
        client.raw.cancel_all_goals()
        wait_until(lambda: core.server.arrivals == 4, "the cancel")
        core.take()
        wait_until(lambda: len(statuses.goals) == 3, "the status after the journal")
        self.assertEqual(reported, [set()])
        for handle in core.handles:
            handle.set_canceled(ROSoClingoResult(CANCELED, "ended"), "ended")
        for goal in goals:
            goal.ends_as(GoalStatus.RECALLED)

    def test_ends_by_actionlib_have_outcome_and_text(self):
        core, client, statuses = self.start("recalled")
        raw = client.raw
        raw.pub_cancel.publish(GoalID(id="early"))
        core.take()
        raw.pub_goal.publish(ROSoClingoActionGoal(goal_id=GoalID(id="early"), goal=ROSoClingoGoal("do(walk,1)")))
        core.take()
        stamp = rospy.Time.now()
        raw.cancel_goals_at_and_before_time(stamp)
        core.take()
        old = GoalID(id="old", stamp=stamp)
        raw.pub_goal.publish(ROSoClingoActionGoal(goal_id=old, goal=ROSoClingoGoal("do(walk,2)")))
        core.take()
        wait_until(lambda: len(statuses.results) == 2, "two results")
        for one in statuses.results:
            self.assertEqual((one.status.status, one.result.outcome), (GoalStatus.RECALLED, CANCELED))
            self.assertTrue(one.result.message and one.status.text)
        self.assertEqual(core.handles, [], "neither was a goal of the core's")

    def test_arrivals_of_one_node_are_bounded_without_loss(self):
        core, client, _ = self.start("floods")
        raw = client.raw
        raw.pub_goal.publish(ROSoClingoActionGoal(goal_id=GoalID(id="x" * (LONGEST_ID + 1))))  # is dropped
        number = 3 * MOST_ARRIVALS
        for one in range(number):
            raw.pub_goal.publish(ROSoClingoActionGoal(goal_id=GoalID(id=str(one)), goal=ROSoClingoGoal("do(walk,1)")))
        wait_until(lambda: core.server.arrivals == MOST_ARRIVALS, "the limit of the queue")
        self.assertEqual(core.calls, MOST_ARRIVALS, "the worker is called for each of them")
        while len(core.handles) < number:  # there is room again after each time
            core.take()
        self.assertEqual([one.get_goal_id().id for one in core.handles], [str(one) for one in range(number)])

    def test_open_goals_of_one_node_are_bounded(self):
        core, client, _ = self.start("crowds")
        found = []
        rospy.Subscriber("~goals", GoalStates, found.append)
        with mock.patch.object(goal_handles, "MOST_OPEN", 2):
            handles = goal_handles.GoalHandles(lambda: "")
            texts = ["do(walk,1)", "do({},2)".format("x" * 50000), "do(walk,3)"]
            goals = [self.admit(core, client, handles, text) for text in texts]
            self.assertIn(" has 2 open goals", goals[2].ends_as(GoalStatus.REJECTED))
            rejected = GoalEvent.REJECT, GoalState.REJECTED, Outcome.REJECTED
            handles.changed(GoalChanged(1, core.handles[0].get_goal_id().id, *rejected, "y" * 50000))
            self.assertEqual(len(goals[0].ends_as(GoalStatus.REJECTED)), 50000)
            self.admit(core, client, handles, "do(walk,4)")
        handles.flush()
        wait_until(lambda: found and len(found[-1].goals) == 3, "the goals that were admitted")
        for one in found[-1].goals:
            self.assertLess(len(one.request) + len(one.reason), 1200)
        self.assertIn("(50006 characters)", found[-1].goals[1].request)

    def admit(self, core, client, handles, text):
        """Send a goal, and take it as the core's node does if there is room."""
        goal = client.send(text)
        core.take()
        handle = core.handles[-1]
        if handles.has_room(handle):
            handles.add(handle.get_goal_id().id, handle)
        return goal

    def test_restored_goal_is_in_the_first_status(self):
        core = Core.__new__(Core)
        core.handles = []
        core.server = GoalServer("restored", core.handles.append, core.handles.append, lambda: None)
        core.server.restore("before", "do(walk,1)", rospy.Time(1), GoalStatus.ACTIVE)
        start_server(core.server)
        message = rospy.wait_for_message("restored/status", GoalStatusArray)
        self.assertEqual([one.goal_id.id for one in message.status_list], ["before"])
