"""Cancel goals of action servers, acknowledged or not."""

from actionlib import ActionClient, ClientGoalHandle
from actionlib_msgs.msg import GoalID


def goal_id(handle: ClientGoalHandle) -> str:
    """Return actionlib's id of a goal that was sent."""
    return str(handle.comm_state_machine.action_goal.goal_id.id)


def cancel_goal(client: ActionClient, handle: ClientGoalHandle) -> None:
    """Ask the server to cancel a goal; the goal ends when the server ends it.

    actionlib's ``cancel`` treats a goal that the server has not acknowledged yet as lost. This function bypasses the
    client instead. A server also accepts a cancel that arrives before its goal.
    """
    client.pub_cancel.publish(GoalID(id=goal_id(handle)))
