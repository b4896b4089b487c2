"""The connection of a page or a scenario to the core: goals, facts, and the core's services."""

import json
import uuid
from typing import Any, Callable, List, Tuple

import rospy
from actionlib_msgs.msg import GoalID
from std_srvs.srv import SetBool, Trigger

from rosoclingo.msg import InterfaceIO, ROSoClingoActionGoal
from rosoclingo.runs.orders import OrderError
from rosoclingo.srv import Explain

#: Limit in seconds of wall time for a service of the core to be found.
FOUND = 2.0


class CoreConnection:
    """Sends goals, facts and commands to a core; all methods raise OrderError if the core does not receive them.

    ``full`` returns the absolute name of a topic or service of the core. The methods that call services wait for their
    answers, those of :meth:`explain` for up to a minute.
    """

    def __init__(self, full: Callable[[str], str]) -> None:
        self._goals = rospy.Publisher(full("rosoclingo/goal"), ROSoClingoActionGoal, queue_size=100)
        self._cancels = rospy.Publisher(full("rosoclingo/cancel"), GoalID, queue_size=100)
        self._facts = rospy.Publisher(full("in_rosoclingo"), InterfaceIO, queue_size=100)
        self._pause = rospy.ServiceProxy(full("~pause"), SetBool)
        self._stop = rospy.ServiceProxy(full("~stop"), Trigger)
        self._explain = rospy.ServiceProxy(full("~explain"), Explain)

    def is_connected_to(self, node: str) -> bool:
        """Return whether goals, cancels and facts arrive at a node."""
        return all(one.impl.has_connection(node) for one in (self._goals, self._cancels, self._facts))

    def send(self, text: str, client: str = "") -> str:
        """Send a goal and return its id, which contains the name of its ``client``."""
        _check(self._goals)
        words = filter(None, (rospy.get_name(), client, uuid.uuid4().hex))
        goal = ROSoClingoActionGoal(goal_id=GoalID(rospy.Time.now(), "-".join(words)))
        goal.header.stamp, goal.goal.request = goal.goal_id.stamp, text
        self._goals.publish(goal)
        return str(goal.goal_id.id)

    def cancel(self, key: str) -> None:
        """Cancel the goal of an id."""
        self._cancels.publish(GoalID(id=key))

    def report(self, *facts: str, origin: str = "") -> None:
        """Report facts, as the interface ``origin`` does, or one with the name of this node."""
        _check(self._facts)
        self._facts.publish(InterfaceIO(origin or rospy.get_name().strip("/"), list(facts)))

    def pause(self, paused: bool) -> str:
        """Pause the core, or let it continue; return its answer."""
        return str(_call(self._pause, paused).message)

    def stop(self) -> str:
        """Stop the core; return its answer."""
        return str(_call(self._stop).message)

    def explain(self, key: str) -> Tuple[List[str], str]:
        """Return why a goal has no plan: the words of the rules that exclude it, and the whole explanation.

        There are no words if the core does not know.
        """
        answer = _call(self._explain, key)
        rules = json.loads(answer.reason)["rules"] if answer.success else []
        words = dict.fromkeys(one["words"] or "a rule without words excludes it" for one in rules)
        return list(words), str(answer.message)


def _check(publisher: rospy.Publisher) -> None:
    if not publisher.get_num_connections():
        raise OrderError("the core is not running: try again later")


def _call(service: rospy.ServiceProxy, *arguments: Any) -> Any:
    try:
        service.wait_for_service(FOUND)
        return service(*arguments)
    except (rospy.ROSException, rospy.ServiceException) as error:
        raise OrderError(f"the core does not answer: {error}") from None
