"""The live page in a browser: orders and facts, messages about them, commands of an operator, and explanations."""

from types import SimpleNamespace

import pytest
import yaml
from published_runs import LABELS, delivery
from served_page import serving

from rosoclingo.common.reading import Reader
from rosoclingo.nodes.pages.order_desk import OrderDesk
from rosoclingo.runs.orders import OrderError, read_orders

pytestmark = [pytest.mark.slow, pytest.mark.once]
FORMS = """
- title: Deliver
  goal: "goal({from},{to},{package})"
  choices: {package: packages, from: place of package, to: labels}
- title: Patrol
  goal: "patrol({b},{a})"
  choices: {b: labels, a: labels}
- title: A place is open again
  fact: "_opened({place},now)"
  choices: {place: labels}
"""
HOSTILE = '<img src=x onerror="window.broken = 1">'


class Desk:
    """A page with forms for a view, which receives no goals unless a test sends them."""

    def __init__(self, served, page):
        self.view, self.served, self.page = served.view, served, page
        self.sent, self.canceled, self.facts, self.commands, self.faults = [], [], [], [], []
        self.reason = (["the door of office2 is shut"], "rooms.lp:1:1: :- shut(R,t).")
        core = SimpleNamespace(
            send=self.send,
            cancel=self.canceled.append,
            report=self.facts.append,
            pause=lambda paused: self.command("pause" if paused else "continue"),
            stop=lambda: self.command("stop"),
            explain=lambda _key: self.reason,
        )
        self.desk = OrderDesk(read_orders(Reader(yaml.safe_load(FORMS))), core)
        served.server.take = lambda message: self.desk.take(message, self.view)
        self.state = {"core": True, "mode": "running", "operates": True, "health": [["core", 0, "idle"]]}
        self.lie({"1": "office1", "2": "office2", "3": "office3"})
        page.faults.clear()
        page.open(served.address + "/")
        page.wait_for("document.querySelectorAll('#orders form').length === 3")

    def send(self, text):
        self.sent.append(text)
        return f"order {len(self.sent)}"

    def command(self, name):
        """Execute a command, or fail if a fault is prepared."""
        self.commands.append(name)
        if self.faults:
            raise OrderError(self.faults.pop())
        return f"the core got {name}"

    def now(self, **state):
        """Change the state of the core."""
        self.state.update(state)
        self.lie(dict(self.view.tables["packages"].last["places"]))

    def lie(self, places):
        """Move packages elsewhere."""

        def change(view):
            view.packages(140.0, places.items())
            self.served.extra = {**self.state, "orders": self.desk.describe(view)}

        self.served.do(change)

    def choose(self, **chosen):
        for name, value in chosen.items():
            select = f"document.querySelector('#orders select[name={name}]')"
            self.page.run(f"{select}.value = '{value}'; {select}.dispatchEvent(new Event('change'))")

    def chosen(self, name):
        return self.page.run(f"document.querySelector('#orders select[name={name}]').value")

    def offered(self, name):
        options = f"document.querySelectorAll('#orders select[name={name}] option')"
        return self.page.run(f"[...{options}].filter((one) => !one.disabled).map((one) => one.value)")

    def words(self, name):
        return self.page.texts(f"#orders select[name={name}] option")

    def order(self, number=1):
        self.page.click(f"#orders form:nth-child({number}) button")

    def says(self, text):
        """Expect a message."""
        messages = "[...document.querySelectorAll('#messages .message span')].map((one) => one.textContent)"
        self.page.wait_for(f"{messages}.includes({text!r})")

    def mine(self, *rows):
        """Expect the goals below the form, each as words, state and reason, with its buttons."""
        parts = "th, .state, .outcome > span"
        row = f"[...one.querySelectorAll('{parts}')].map((part) => part.innerText).join('; ')"
        found = f"[...document.querySelectorAll('#orders tbody tr')].map((one) => {row})"
        self.page.wait_for(f"{found}.join('|') === {'|'.join(rows)!r}")

    def push(self, text, within="#orders tbody"):
        """Click on the first button with this text."""
        buttons = f"[...document.querySelectorAll('{within} button')]"
        found = f"{buttons}.find((one) => one.textContent === {text!r} && one.offsetParent !== null)"
        self.page.wait_for(f"{found} !== undefined")
        self.page.run(f"{found}.dataset.pushed = ''")
        self.page.click("[data-pushed]")
        self.page.run("delete document.querySelector('[data-pushed]')?.dataset.pushed")

    def dialog(self):
        """Return the text of the open dialog."""
        self.page.wait_for("document.getElementById('dialog').open")
        return self.page.text("#dialog")


@pytest.fixture
def desk(page):
    view = delivery()
    view.describe(labels={**LABELS, "office3": [3.0, 1.0, 0.0]})
    with serving(view) as served:
        yield Desk(served, page)
    assert page.faults == []


def test_page_says_what_became_of_orders(desk):
    desk.choose(package="1", to="office2")
    desk.order()
    desk.says("Ordered: Deliver: 1, office2")
    desk.served.do(lambda view: view.goal(141.0, "order 1", "goal(office1,office2,1)"))
    desk.mine("goal(office1,office2,1); new; ; Cancel\nWhy?")
    desk.served.do(lambda view: view.status(142.0, "order 1", 5, "goal(office1,office2,1) has no way there"))
    desk.says("Rejected: goal(office1,office2,1) (has no way there)")
    rejected = "goal(office1,office2,1); rejected; has no way there; Why?"
    desk.mine(rejected)
    desk.choose(package="2", to="office3")
    desk.order()
    desk.served.do(lambda view: view.goal(143.0, "order 2", "goal(office2,office3,2)"))
    desk.served.do(lambda view: view.status(143.0, "order 2", 0, "at most 8 goals are planned for at a time"))
    desk.says("Queued: goal(office2,office3,2) (at most 8 goals are planned for at a time)")
    desk.served.do(lambda view: view.status(144.0, "order 2", 1, "is accepted"))
    desk.mine(rejected, "goal(office2,office3,2); under way; ; Cancel")
    desk.served.do(lambda view: view.status(145.0, "order 2", 4, "the door is shut"))
    desk.says("Given up: goal(office2,office3,2) (the door is shut)")
    desk.mine(rejected, "goal(office2,office3,2); given up; the door is shut; Why?")


def test_page_says_cancelled_only_when_it_is(desk):
    desk.choose(package="1", to="office2")
    desk.order()
    desk.served.do(lambda view: view.goal(141.0, "order 1", "goal(office1,office2,1)"))
    desk.push("Cancel")
    desk.served.do(lambda view: view.status(142.0, "order 1", 6, ""))
    desk.mine("goal(office1,office2,1); being cancelled; ; ")
    assert desk.canceled == ["order 1"]
    desk.served.do(lambda view: view.status(142.0, "order 1", 3, "is met"))
    desk.says("Done: goal(office1,office2,1)")


def test_page_keeps_own_orders_after_a_reload(desk):
    desk.choose(package="1", to="office2")
    desk.order()
    desk.says("Ordered: Deliver: 1, office2")
    desk.served.do(lambda view: view.goal(141.0, "order 1", "goal(office1,office2,1)"))
    desk.served.do(lambda view: view.goal(141.0, "other", "goal(office1,office2,9)"))
    desk.page.run("location.reload()")
    desk.mine("goal(office1,office2,1); new; ; Cancel\nWhy?")
    assert desk.page.texts("#messages .message") == []


def test_page_explains_why_a_goal_is_not_met(desk):
    goals = {"x": ("goal(office1,office2,1)", 4, "cannot be met"), "y": ("goal(office2,office3,2)", 5, "is unknown")}
    for key, (text, status, reason) in goals.items():
        desk.served.do(lambda view, key=key, text=text: view.goal(141.0, key, text))
        desk.served.do(lambda view, key=key, status=status, reason=reason: view.status(142.0, key, status, reason))
    desk.push("Why?", "#goals")
    assert "Why? goal(office1,office2,1)" in desk.dialog()
    desk.page.wait_for("document.getElementById('dialog').innerText.includes('the door of office2 is shut')")
    assert "cannot be met" in desk.dialog()
    assert "rooms.lp" not in desk.dialog()
    desk.page.click("#dialog summary")
    assert "rooms.lp:1:1" in desk.dialog()
    desk.push("Close", "#dialog")
    desk.page.click("#goals tbody tr:last-child button")
    desk.page.wait_for("document.getElementById('dialog').innerText.includes('is unknown')")
    assert desk.page.run("document.querySelector('#dialog details') === null")


def test_page_reports_facts_and_what_the_core_ignores(desk):
    desk.choose(place="office3")
    desk.order(3)
    desk.says("Reported: A place is open again: office3")
    assert (desk.facts, desk.sent) == (["_opened(office3,now)"], [])
    desk.served.do(lambda view: view.problem(150.0, 1, "'_opened(office3,now)' from 'web' is ignored: it is not shut"))
    desk.page.wait_for("document.querySelector('#messages .message.bad')?.textContent.includes('it is not shut')")


def test_page_pauses_and_stops_after_confirmation(desk):
    desk.push("Pause", "#commands")
    assert "Pause the robot?" in desk.dialog()
    desk.push("Back", "#dialog")
    assert desk.commands == []
    desk.push("Pause", "#commands")
    desk.push("Pause", "#dialog")
    desk.says("the core got pause")
    desk.now(mode="paused")
    desk.page.wait_for("document.getElementById('now').textContent.startsWith('Paused')")
    desk.push("Continue", "#commands")
    desk.says("the core got continue")
    desk.now(mode="running")
    desk.faults.append("the core does not answer: gone")
    desk.page.press("Enter", "#stop")
    assert "Stop the robot?" in desk.dialog()
    desk.push("Stop", "#dialog")
    desk.says("Not done: the core does not answer: gone")
    assert desk.commands == ["pause", "continue", "stop"]
    assert desk.page.run("document.getElementById('messages').getAttribute('aria-live')") == "polite"
    desk.now(operates=False)
    desk.page.wait_for("document.getElementById('commands').hidden")


def test_page_shows_health_as_one_light(desk):
    assert desk.page.text("#light") == "All is well"
    desk.now(health=[["core", 0, "idle"], ["move_base", 2, HOSTILE]])
    desk.page.wait_for("document.getElementById('light').textContent === 'Error'")
    desk.page.press("Enter", "#light")
    assert desk.page.texts("#reports li") == ["core ok: idle", f"move_base error: {HOSTILE}"]
    desk.now(health=[["core", 3, "no report"]])
    desk.page.wait_for("document.getElementById('light').textContent === 'No reports'")
    desk.now(core=False)
    desk.page.wait_for("document.getElementById('now').textContent === 'The core is not running'")


def test_page_shows_hostile_texts_of_orders_as_text(desk):
    desk.reason = ([HOSTILE], HOSTILE)
    desk.choose(package="1", to="office2")
    desk.order()
    desk.served.do(lambda view: view.goal(141.0, "order 1", HOSTILE))
    desk.served.do(lambda view: view.status(142.0, "order 1", 4, f"no {HOSTILE}"))
    desk.says(f"Given up: {HOSTILE} (no {HOSTILE})")
    desk.push("Why?")
    desk.page.wait_for("document.querySelectorAll('#dialog li').length === 2")
    assert desk.page.texts("#dialog li") == [f"no {HOSTILE}", HOSTILE]
    assert desk.page.run("window.broken === undefined && document.querySelectorAll('img').length === 0")


def test_page_keeps_the_choice_while_packages_move(desk):
    desk.choose(package="2", to="office3")
    desk.page.run("window.before = document.querySelector('#orders select[name=package]')")
    desk.page.run("window.before.focus()")
    desk.lie({"1": "office3", "2": "", "3": "office1"})
    desk.page.wait_for("document.querySelector('#orders').textContent.includes('2 (not now)')")
    assert desk.page.run("document.activeElement === window.before && window.before.isConnected")
    assert (desk.chosen("package"), desk.chosen("to"), desk.offered("package")) == ("2", "office3", ["1", "3"])
    desk.order()
    desk.says("Not sent: package: choose one of the options")
    desk.lie({"1": "office3", "2": "office1", "3": "office1"})
    desk.page.wait_for("!document.querySelector('#orders').textContent.includes('not now')")
    desk.order()
    desk.says("Ordered: Deliver: 2, office3")
    assert desk.sent == ["goal(office1,office3,2)"]


def test_page_offers_no_place_twice(desk):
    for package, place in (("1", "office1"), ("2", "office2"), ("3", "office3"), ("1", "office1")):
        desk.choose(package=package)
        assert desk.offered("to") == [one for one in ("office1", "office2", "office3") if one != place]
    desk.choose(package="1", to="office2")
    desk.choose(package="2")
    assert desk.words("to")[-1] == "office2 (not now)"
    desk.order()
    desk.says("Not sent: to: office2 is already 'from', choose another place")
    assert desk.offered("a") == ["office2", "office3"]
    desk.choose(b="office3")
    assert desk.offered("a") == ["office1", "office2"]
    desk.choose(a="office1")
    desk.order(2)
    desk.says("Ordered: Patrol: office3, office1")
    assert desk.sent == ["patrol(office3,office1)"]
