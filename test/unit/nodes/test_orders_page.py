"""The order form in a browser: offers, persistent choices, and messages about an order."""

import pytest
import yaml
from published_runs import LABELS, delivery
from served_page import serving

from rosoclingo.common.reading import Reader
from rosoclingo.nodes.pages.order_desk import OrderDesk
from rosoclingo.runs.orders import read_orders

pytestmark = [pytest.mark.slow, pytest.mark.once]
FORMS = """
- title: Deliver
  goal: "goal({from},{to},{package})"
  choices: {package: packages, from: place of package, to: labels}
- title: Patrol
  goal: "patrol({b},{a})"
  choices: {b: labels, a: labels}
"""


class Desk:
    """A page with forms for a view, which receives no goals unless a test sends them."""

    def __init__(self, served, page):
        self.view, self.served, self.page = served.view, served, page
        self.sent, self.canceled = [], []
        self.desk = OrderDesk(read_orders(Reader(yaml.safe_load(FORMS))), self.send, self.canceled.append)
        served.server.take = lambda message: self.desk.take(message, self.view)
        self.lie({"1": "office1", "2": "office2", "3": "office3"})
        page.faults.clear()
        page.open(served.address + "/")
        page.wait_for("document.querySelectorAll('#orders form').length === 2")

    def send(self, text):
        self.sent.append(text)
        return f"order {len(self.sent)}"

    def lie(self, places):
        """Move packages elsewhere."""

        def change(view):
            view.packages(140.0, places.items())
            self.served.extra = {"core": True, "orders": self.desk.describe(view)}

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

    def says(self, *lines):
        captions = "[...document.querySelectorAll('#orders .caption')].map((one) => one.textContent)"
        self.page.wait_for(f"{captions}.join('|') === {'|'.join(lines)!r}")


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
    desk.says("Ordered: goal(office1,office2,1)")
    desk.served.do(lambda view: view.goal(141.0, "order 1", "goal(office1,office2,1)"))
    desk.served.do(lambda view: view.status(142.0, "order 1", 5, "goal(office1,office2,1) has no way there"))
    desk.says("Rejected: goal(office1,office2,1) (has no way there)")
    desk.choose(package="2", to="office3")
    desk.order()
    desk.served.do(lambda view: view.goal(143.0, "order 2", "goal(office2,office3,2)"))
    desk.served.do(lambda view: view.feedback(143.0, "order 2", "waiting: at most 8 goals are planned for at a time"))
    waits = "Ordered, queued: goal(office2,office3,2) (at most 8 goals are planned for at a time)"
    desk.says(waits, "Rejected: goal(office1,office2,1) (has no way there)")
    desk.served.do(lambda view: view.status(144.0, "order 2", 1, "is accepted"))
    desk.says("Ordered: goal(office2,office3,2)", "Rejected: goal(office1,office2,1) (has no way there)")
    desk.served.do(lambda view: view.status(145.0, "order 2", 4, "the door is shut"))
    aborted = "Aborted: goal(office2,office3,2) (the door is shut)"
    desk.says(aborted, "Rejected: goal(office1,office2,1) (has no way there)")


def test_page_says_cancelled_only_when_it_is(desk):
    desk.choose(package="1", to="office2")
    desk.order()
    desk.served.do(lambda view: view.goal(141.0, "order 1", "goal(office1,office2,1)"))
    desk.page.wait_for("document.querySelector('#goals button') !== null")
    desk.page.click("#goals button")
    desk.says("Cancel requested: goal(office1,office2,1)")
    assert desk.canceled == ["order 1"]
    desk.served.do(lambda view: view.status(142.0, "order 1", 3, "is met"))
    desk.says("Done: goal(office1,office2,1)")


def test_page_keeps_the_choice_while_packages_move(desk):
    desk.choose(package="2", to="office3")
    for places in (
        {"1": "", "2": "office2", "3": "office3"},
        {"1": "office3", "2": "office2", "3": ""},
        {"1": "office3", "2": "office1", "3": "office1"},
    ):
        desk.lie(places)
        lying = [[name, place] for name, place in places.items() if place]
        words = "|".join(f"{name} (at {place})" for name, place in lying)
        found = "[...document.querySelectorAll('#orders select[name=package] option')].map((one) => one.textContent)"
        desk.page.wait_for(f"{found}.join('|') === '{words}'")
        assert (desk.chosen("package"), desk.chosen("to")) == ("2", "office3")
    desk.lie({"1": "office3", "2": "", "3": "office1"})
    desk.page.wait_for("document.querySelector('#orders').textContent.includes('2 (not now)')")
    assert (desk.chosen("package"), desk.offered("package")) == ("2", ["1", "3"])
    desk.order()
    desk.says("Not ordered: package: choose one of the options")
    desk.lie({"1": "office3", "2": "office1", "3": "office1"})
    desk.page.wait_for("!document.querySelector('#orders').textContent.includes('not now')")
    assert desk.chosen("package") == "2"
    desk.order()
    desk.says("Ordered: goal(office1,office3,2)")


def test_page_leaves_the_open_select_in_place(desk):
    desk.page.run("window.before = document.querySelector('#orders select[name=package]')")
    desk.page.run("window.before.focus()")
    desk.lie({"1": "office3", "2": "office2", "3": "office3"})
    desk.page.wait_for("document.querySelector('#orders').textContent.includes('1 (at office3)')")
    assert desk.page.run("document.activeElement === window.before && window.before.isConnected")


def test_page_offers_no_place_twice(desk):
    for package, place in (("1", "office1"), ("2", "office2"), ("3", "office3"), ("1", "office1")):
        desk.choose(package=package)
        assert desk.offered("to") == [one for one in ("office1", "office2", "office3") if one != place]
    desk.choose(package="1", to="office2")
    desk.choose(package="2")
    assert desk.words("to")[-1] == "office2 (not now)"
    desk.order()
    desk.says("Not ordered: to: office2 is already 'from', choose another place")
    assert desk.offered("a") == ["office2", "office3"]
    desk.choose(b="office3")
    assert desk.offered("a") == ["office1", "office2"]
    desk.choose(a="office1")
    desk.order(2)
    desk.says("Ordered: patrol(office3,office1)")
