"""Orders, facts, commands and questions that arrive from pages."""

from types import SimpleNamespace

import pytest
from published_runs import LABELS, desk_of

from rosoclingo.nodes.pages.order_desk import MOST_ASKED, MOST_COMMANDS, MOST_OPEN, OrderDesk
from rosoclingo.runs.run_view import RunView

KEY = "a key of a page"


class Counter:
    """A desk with a core that accepts every goal."""

    def __init__(self):
        self.view = RunView({"labels": LABELS})
        self.view.packages(0.0, [("1", "office2"), ("2", "")])
        self.sent, self.canceled, self.facts, self.commands = [], [], [], []
        self.reason = (["the door is shut"], "the rules")
        self.core = SimpleNamespace(
            send=lambda text: self.send(text),
            cancel=self.canceled.append,
            report=self.facts.append,
            pause=self.command,
            stop=lambda: self.command("stop"),
            explain=lambda _key: self.reason,
        )
        self.desk = desk_of(self.core)

    def command(self, value):
        self.commands.append(value)
        return f"the core got {value}"

    def send(self, text):
        self.sent.append(text)
        key = f"id {len(self.sent)}"
        self.view.goal(1.0, key, text)
        return key

    def order(self, key=KEY, **chosen):
        return self.take(order=0, key=key, chosen={"package": "1", "to": "office1", **chosen})

    def take(self, **message):
        return self.desk.take(message, self.view)


@pytest.fixture
def counter():
    return Counter()


def test_desk_order_is_a_goal_that_its_key_cancels(counter):
    assert counter.order() == {"ordered": "id 1", "text": "goal(office2,office1,1)", "words": "Deliver: 1, office1"}
    assert counter.sent == ["goal(office2,office1,1)"]
    for key in ("another key", "a key of a pagE", "ö" * 9):
        assert counter.take(cancel="id 1", key=key) == {"fault": "this page did not send that order, or it has ended"}
    assert counter.take(cancel="id 1", key=KEY) == {"canceled": "id 1"}
    assert counter.canceled == ["id 1"]


NO_ORDER, NO_KEY = "there is no such order", "the page sent no key"
NO_COMMAND = "'pause' needs true or false, and 'stop' true"


@pytest.mark.parametrize(
    ("message", "fault"),
    [
        ({}, "the message needs 'order', 'cancel', 'why', 'pause' or 'stop'"),
        *(({"order": number}, NO_ORDER) for number in (9, -1, "0", "\ud800")),
        ({"order": 0, "chosen": 3}, NO_ORDER),
        *(
            ({"order": 0, "chosen": {"package": "1", "to": "office1"}, "key": key}, NO_KEY)
            for key in (3, "short", "x" * 101)
        ),
        *(({"pause": value}, NO_COMMAND) for value in (1, None)),
        *(({"stop": value}, NO_COMMAND) for value in (False, "yes")),
        ({"stop": True, "pause": True}, NO_COMMAND),
    ],
)
def test_desk_refuses_malformed_messages(counter, message, fault):
    assert counter.take(**{"key": KEY, **message}) == {"fault": fault}
    assert (counter.sent, counter.commands) == ([], [])


def test_desk_burst_accepts_only_free_places():
    """The view learns about a goal only after the burst, so sent goals occupy places."""
    desk = Counter()
    desk.send = lambda text: desk.sent.append(text) or f"id {len(desk.sent)}"
    answers = [desk.order(f"key of page {number % 20}") for number in range(400)]
    assert [("ordered" in one) for one in answers] == [True] * MOST_OPEN + [False] * (400 - MOST_OPEN)
    assert len(desk.sent) == MOST_OPEN
    for number in range(1, MOST_OPEN + 1):
        desk.view.goal(1.0, f"id {number}", "g")
    assert "fault" in desk.order()
    for number in range(1, 11):
        desk.view.status(2.0, f"id {number}", 3, "")
    assert sum("ordered" in desk.order() for _ in range(720)) == 10


def test_desk_forgets_orders_that_have_ended(counter):
    for _ in range(2):
        counter.order()
    counter.view.status(2.0, "id 2", 3, "")
    counter.desk.describe(counter.view)
    assert ["canceled" in counter.take(cancel=one, key=KEY) for one in ("id 1", "id 2")] == [True, False]


def test_desk_reports_an_offered_fact(counter):
    answer = counter.take(order=2, key=KEY, chosen={"place": "office2"})
    assert answer == {
        "reported": "_opened(office2,now)",
        "text": "_opened(office2,now)",
        "words": "A place is open again: office2",
    }
    assert (counter.facts, counter.sent) == (["_opened(office2,now)"], [])
    assert "choose one" in counter.take(order=2, key=KEY, chosen={"place": "office9"})["fault"]
    assert "fault" in counter.take(cancel="_opened(office2,now)", key=KEY)


@pytest.mark.parametrize(
    ("message", "value"), [({"pause": True}, True), ({"pause": False}, False), ({"stop": True}, "stop")]
)
def test_desk_command_waits_for_the_core(counter, message, value):
    wait = counter.take(key=KEY, **message)
    assert counter.commands == []
    assert wait() == {"done": f"the core got {value}"}
    assert counter.commands == [value]


@pytest.mark.parametrize("message", [{"pause": True}, {"stop": True}])
def test_desk_without_orders_accepts_no_command(counter, message):
    desk = OrderDesk((), counter.core)
    assert "only shows the robot" in desk.take({"key": KEY, **message}, counter.view)["fault"]


@pytest.mark.parametrize(("message", "limit"), [({"why": "id 1"}, MOST_ASKED), ({"stop": True}, MOST_COMMANDS)])
def test_desk_limits_requests_that_wait_for_the_core(counter, message, limit):
    counter.order()
    counter.view.status(2.0, "id 1", 4, "cannot be met")
    waits = [counter.take(key=KEY, **message) for _ in range(limit)]
    assert "try again" in counter.take(key=KEY, **message)["fault"]
    counter.reason = None  # an error in the connection frees the place, too
    for wait in waits:
        try:
            wait()
        except TypeError:
            assert "why" in message
    assert not isinstance(counter.take(key=KEY, **message), dict)


@pytest.mark.parametrize(
    ("status", "reason", "lines"),
    [
        (5, "goal(office2,office1,1) is unknown", ["is unknown"]),
        (5, "", ["the core gives no reason"]),
        (0, "", ["the core has not planned for it yet"]),
    ],
)
def test_desk_explains_a_goal_by_its_reason(counter, status, reason, lines):
    counter.order()
    counter.view.status(2.0, "id 1", status, reason)
    assert counter.take(key=KEY, why="id 1") == {"why": lines, "details": ""}


def test_desk_asks_the_core_why_a_goal_has_no_plan(counter):
    counter.order()
    counter.view.status(2.0, "id 1", 4, "cannot be met")
    expected = {"why": ["cannot be met", "the door is shut"], "details": "the rules"}
    assert counter.take(key="a key of another page", why="id 1")() == expected
    for unknown in ("id 2", None, 7, "\ud800"):
        assert counter.take(key=KEY, why=unknown) == {"fault": "there is no such goal"}
