"""Clients of action servers: cancelling a goal, acknowledged or not."""

from actionlib import ActionClient, ClientGoalHandle
from actionlib_msgs.msg import GoalID

__all__ = ["cancel_goal", "goal_id"]


def goal_id(handle: ClientGoalHandle) -> str:
    """Return actionlib's id of a goal that was sent."""
    return str(handle.comm_state_machine.action_goal.goal_id.id)


def cancel_goal(client: ActionClient, handle: ClientGoalHandle) -> None:
    """Ask the server to cancel a goal; it ends when the server says so.

    actionlib's own ``cancel`` takes a goal for lost that the server has not acknowledged yet: so the server is asked
    without the client's knowledge. For a server, a cancel that comes before its goal counts as well.
    """
    client.pub_cancel.publish(GoalID(id=goal_id(handle)))
