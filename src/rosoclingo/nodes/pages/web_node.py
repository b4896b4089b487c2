"""The node that serves the live page."""

import secrets
import time
from typing import Any, Dict, List, Tuple

import rospy
from diagnostic_msgs.msg import DiagnosticArray
from genpy.message import get_message_class
from std_msgs.msg import String
from tornado.netutil import bind_sockets

from rosoclingo.common.parameters import ParameterError, Parameters
from rosoclingo.nodes.core_connection import CoreConnection
from rosoclingo.nodes.pages.order_desk import OrderDesk, Taken
from rosoclingo.nodes.pages.page_server import LOCAL, PageServer
from rosoclingo.nodes.pages.report_command import web
from rosoclingo.nodes.pages.scan_feed import ScanFeed
from rosoclingo.nodes.run_topics import TYPES, RunTopics
from rosoclingo.reasoning.keywords import shortened
from rosoclingo.runs.orders import read_orders
from rosoclingo.runs.run_view import RunView

#: Limit of components on /diagnostics that a page lists.
MOST_COMPONENTS = 100

#: Seconds of wall time without a report, after which a component is stale, and its level (diagnostic_msgs).
SILENCE, STALE = 10.0, 3


class WebNode:
    """Serves a page that shows a running system in any browser: map, plan, goals, log and figures, live.

    Parameters
    ----------
        ~host (str, default "127.0.0.1"): the address of this machine on which the page is served. With another address,
            or 0.0.0.0 for all, browsers on other machines can open the page with the token.
        ~port (int, default 8080): the port; 0 for any free port.
        ~token (str, default ""): the token for other machines; empty: a new token at each start, printed in the log.
        ~title (str, default "rosoclingo"): the page's title.
        ~orders (list, default []): the orders and facts that the page offers, see ``doc/web_page.md``; empty: the page
            only shows the run, and offers no pause and no stop.
    Subscribes:
        rosoclingo/program, rosoclingo/updates, rosoclingo/mode (std_msgs/String)
        rosoclingo/task_plan (rosoclingo/TaskPlan)
        rosoclingo/goals (rosoclingo/GoalStates): the states of goals, also of goals that were sent before the start.
        rosoclingo/cancel (actionlib_msgs/GoalID)
        rosoclingo/state (rosoclingo/State): the program's beliefs.
        out_rosoclingo, in_rosoclingo (rosoclingo/InterfaceIO), packages (rosoclingo/PackageStates)
        map (nav_msgs/OccupancyGrid), base_pose_ground_truth (nav_msgs/Odometry), amcl_pose
            (geometry_msgs/PoseWithCovarianceStamped), /tf, /tf_static (tf2_msgs/TFMessage)
        move_base/GridPlanner/plan, move_base/NavfnROS/plan, move_base/GlobalPlanner/plan (nav_msgs/Path)
        /rosout (rosgraph_msgs/Log): the log of the core.
        TOPIC (sensor_msgs/LaserScan): the scans of all lasers, as long as a page shows them.
        /diagnostics (diagnostic_msgs/DiagnosticArray): the health of core, interfaces and robot.
    Publishes:
        rosoclingo/goal (rosoclingo/ROSoClingoActionGoal), rosoclingo/cancel (actionlib_msgs/GoalID): orders.
        in_rosoclingo (rosoclingo/InterfaceIO): facts of ~orders that people report.
        ~address (std_msgs/String, latched): the address of the page, without the token.
    Services called:
        rosoclingo/pause (std_srvs/SetBool), rosoclingo/stop (std_srvs/Trigger), rosoclingo/explain (rosoclingo/Explain)

    Raises ParameterError if it cannot start, for example because the port is in use.

    """

    def __init__(self) -> None:
        given = Parameters()
        host, port = given.at("host").text("127.0.0.1"), given.at("port").whole(8080, low=0, high=65535)
        token, title = given.at("token").text(""), given.at("title").text("rosoclingo")
        self._forms = read_orders(given.at("orders"))
        given.check()
        local = host in LOCAL
        token = "" if local else token or secrets.token_urlsafe(12)
        try:
            sockets = bind_sockets(port, host)
        except OSError as error:
            fix = "choose another ~port or ~host"
            raise ParameterError(f"the page cannot be served on {host}:{port}: {error.strerror}; {fix}") from None
        self._view = RunView({"title": title})
        self._topics = RunTopics(self._view, rospy.resolve_name("rosoclingo"))
        self._subscribers: Dict[str, rospy.Subscriber] = {}
        self._scans = ScanFeed(self._on_scan)
        self._server = PageServer(self._look, web(), token, sockets, self._take)
        self._desk = OrderDesk(self._forms, CoreConnection(self._topics.full))
        self._health: Dict[str, Tuple[int, str, float]] = {}
        self._server.start()
        rospy.on_shutdown(self._server.stop)
        self._subscribers = self._subscribe()
        address = f"http://{f'[{host}]' if ':' in host else host}:{sockets[0].getsockname()[1]}/"
        rospy.loginfo("the page is served on %s", address + (f"?token={token}" if token else ""))
        self._address = rospy.Publisher("~address", String, latch=True, queue_size=1)
        self._address.publish(String(address))

    def _subscribe(self) -> Dict[str, rospy.Subscriber]:
        kinds = {"/diagnostics": "diagnostic_msgs/DiagnosticArray", **TYPES}
        return {
            name: rospy.Subscriber(self._topics.full(name), get_message_class(kind), self._on_message, name)
            for name, kind in kinds.items()
        }

    def _on_message(self, message: Any, name: str) -> None:
        now = rospy.get_time()
        if name == "/diagnostics":
            self._server.put(lambda: self._take_health(message))
        elif not self._topics.is_too_soon(name, now):
            self._server.put(lambda: self._topics.pass_on(name, now, message))

    def _on_scan(self, topic: str, message: Any) -> None:
        now = rospy.get_time()
        self._server.put(lambda: self._topics.scan(now, topic, message))

    def _look(self) -> Tuple[RunView, Dict[str, Any]]:
        """Return the view, of limited size, and further data for the page: forms, state and health of the core."""
        self._view.clock(rospy.get_time())
        self._scans.check()
        if self._view.full:
            self._view = RunView(self._view.about)
            self._topics.restart(self._view)
        plan = self._subscribers.get("~task_plan")
        core = plan is not None and plan.get_num_connections() > 0
        state = {"core": core, "mode": self._view.mode_word, "health": self._described_health()}
        return self._view, {**state, "orders": self._desk.describe(self._view), "operates": bool(self._forms)}

    def _take_health(self, message: DiagnosticArray) -> None:
        for one in message.status:
            if one.name in self._health or len(self._health) < MOST_COMPONENTS:
                level = one.level[0] if isinstance(one.level, bytes) else int(one.level)
                self._health[one.name] = min(level, STALE), shortened(one.message), time.monotonic()

    def _described_health(self) -> List[Tuple[str, int, str]]:
        """Return name, level and message of each component."""
        late, found = time.monotonic() - SILENCE, []
        for name, (level, text, heard) in sorted(self._health.items()):
            words = self._view.sentences.replace(text)
            stale = STALE, f"no report; before: {words}"
            found.append((shortened(name), *((level, words) if heard >= late else stale)))
        return found

    def _take(self, message: Dict[str, Any]) -> Taken:
        return self._scans.want() if "scan" in message else self._desk.take(message, self._view)
