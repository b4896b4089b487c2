"""Action servers that tolerate resets of simulated time."""

from typing import Any

import rospy
from actionlib import ActionServer, SimpleActionServer
from actionlib_msgs.msg import GoalStatusArray

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.worker import ending


def announce_server(server: ActionServer) -> None:
    """Announce a server that can take long to start; the server's own publishers share these connections."""
    name = rospy.remap_name(server.ns)
    prompt_publisher(name + "/status", GoalStatusArray, latch=True)
    prompt_publisher(name + "/feedback", server.ActionFeedback)
    prompt_publisher(name + "/result", server.ActionResult)


def start_server(server: ActionServer) -> None:
    """Start a server that sends without a queue, so that no message is lost at shutdown.

    Its status topic survives a jump of simulated time, which would end actionlib's timer.
    """
    announce_server(server)
    server.start()
    if server.status_frequency > 0.0:
        server.status_timer.shutdown()
        period = rospy.Duration(1.0 / server.status_frequency)
        server.status_timer = rospy.Timer(period, lambda event: _publish_status(server, event), reset=True)


def forget_cancels(server: ActionServer) -> None:
    """Forget the last cancel's time: after time went back, the server would cancel all earlier goals on arrival."""
    with server.lock:
        server.last_cancel = rospy.Time()


def forget_goal_times(server: SimpleActionServer) -> None:
    """Forget the times of the last goals and cancels: after time went back, the server would recall earlier goals."""
    with server.lock:
        for handle in (server.current_goal, server.next_goal):
            if handle.get_goal() is not None:
                handle.get_goal_id().stamp = rospy.Time()  # the server compares only stamps, clients only ids
    forget_cancels(server.action_server)


def _publish_status(server: ActionServer, event: Any) -> None:
    try:
        server.publish_status_async(event)
    except rospy.ROSException:  # the topic has just been closed
        if not ending():
            raise
