"""The live page in a browser: orders and facts, messages about them, commands of an operator, and explanations."""

from types import SimpleNamespace

import pytest
from published_runs import LABELS, delivery, desk_of
from served_page import serving

pytestmark = [pytest.mark.slow, pytest.mark.once]
HOSTILE = '<img src=x onerror="window.broken = 1">'


class Desk:
    """A page with forms for a view, which receives no goals unless a test sends them."""

    def __init__(self, served, page):
        self.view, self.served, self.page = served.view, served, page
        self.sent, self.canceled = [], []
        self.reason = (["the door of office2 is shut"], "rooms.lp:1:1: :- shut(R,t).")
        core = SimpleNamespace(
            send=self.send,
            cancel=self.canceled.append,
            explain=lambda _key: self.reason,
        )
        self.desk = desk_of(core)
        served.server.take = lambda message: self.desk.take(message, self.view)
        self.lie({"1": "office1", "2": "office2", "3": "office3"})
        page.faults.clear()
        page.open(served.address + "/")
        page.wait_for("document.querySelectorAll('#orders form').length === 3")

    def send(self, text):
        self.sent.append(text)
        return f"order {len(self.sent)}"

    def lie(self, places):
        """Move packages elsewhere."""

        def change(view):
            view.packages(140.0, places.items())
            self.served.extra = {"core": True, "operates": True, "orders": self.desk.describe(view)}

        self.served.do(change)

    def choose(self, **chosen):
        for name, value in chosen.items():
            self.page.choose(f"#orders select[name={name}]", value)

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


@pytest.fixture
def desk(page):
    view = delivery()
    view.describe(labels={**LABELS, "office3": [3.0, 1.0, 0.0]})
    with serving(view) as served:
        yield Desk(served, page)
    assert page.faults == []


def test_page_says_cancelled_only_when_it_is(desk):
    desk.choose(package="1", to="office2")
    desk.order()
    desk.served.do(lambda view: view.goal(141.0, "order 1", "goal(office1,office2,1)"))
    desk.page.push("Cancel", "#orders tbody")
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
    desk.page.reload()
    desk.mine("goal(office1,office2,1); new; ; Cancel\nWhy?")
    assert desk.page.texts("#messages .message") == []


def test_page_shows_hostile_texts_of_orders_as_text(desk):
    desk.reason = ([HOSTILE], HOSTILE)
    desk.choose(package="1", to="office2")
    desk.order()
    desk.served.do(lambda view: view.goal(141.0, "order 1", HOSTILE))
    desk.served.do(lambda view: view.status(142.0, "order 1", 4, f"no {HOSTILE}"))
    desk.says(f"Given up: {HOSTILE} (no {HOSTILE})")
    desk.page.push("Why?", "#orders tbody")
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
