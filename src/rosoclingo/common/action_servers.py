"""Action servers in simulated time, which may go back."""

from typing import Any

import rospy
from actionlib import ActionServer, SimpleActionServer
from actionlib_msgs.msg import GoalStatusArray

from rosoclingo.common.prompt_publisher import prompt_publisher
from rosoclingo.common.worker import ending

__all__ = ["announce_server", "forget_cancels", "forget_goal_times", "start_server"]


def announce_server(server: ActionServer) -> None:
    """Let clients know that there will be a server, which may take long to start; its own publishers share these."""
    name = rospy.remap_name(server.ns)
    prompt_publisher(name + "/status", GoalStatusArray, latch=True)
    prompt_publisher(name + "/feedback", server.ActionFeedback)
    prompt_publisher(name + "/result", server.ActionResult)


def start_server(server: ActionServer) -> None:
    """Start a server that sends at once: nothing waits in a queue as the node ends, and who publishes waits for nobody.

    Its status topic outlives a jump of simulated time; actionlib's own timer ends with one.
    """
    announce_server(server)
    server.start()
    if server.status_frequency > 0.0:
        server.status_timer.shutdown()
        period = rospy.Duration(1.0 / server.status_frequency)
        server.status_timer = rospy.Timer(period, lambda event: _publish_status(server, event), reset=True)


def forget_cancels(server: ActionServer) -> None:
    """Forget the last cancel's time; after time went back, each goal until that time would be cancelled on arrival."""
    with server.lock:
        server.last_cancel = rospy.Time()


def forget_goal_times(server: SimpleActionServer) -> None:
    """Forget when the last goals and cancels came; after time went back, each goal until then would be recalled."""
    with server.lock:
        for handle in (server.current_goal, server.next_goal):
            if handle.get_goal() is not None:
                handle.get_goal_id().stamp = rospy.Time()  # the server compares the stamps alone, clients the ids
    forget_cancels(server.action_server)


def _publish_status(server: ActionServer, event: Any) -> None:
    try:
        server.publish_status_async(event)
    except rospy.ROSException:  # the topic has been closed since the server looked
        if not ending():
            raise
