"""Orders: the goals that people can choose, and malformed declarations."""

import pytest
import yaml

from rosoclingo.common.reading import Reader
from rosoclingo.runs.orders import OrderError, read_orders

DELIVER = """
- title: Deliver a package
  goal: "goal({from},{to},{package})"
  choices: {package: packages, from: place of package, to: labels}
- title: Clean
  goal: "clean({how})"
  choices: {how: [wet, dry, 3]}
"""
LABELS = ("office1", "office2")
PACKAGES = {"1": "office2", "2": ""}


def read(text):
    reader = Reader(yaml.safe_load(text), "orders")
    found = read_orders(reader)
    return found, reader.faults


def forms(text=DELIVER):
    found, faults = read(text)
    assert faults == []
    return found


def test_orders_show_the_declared_form():
    deliver, clean = (form.describe(LABELS, PACKAGES) for form in forms())
    assert deliver == {
        "title": "Deliver a package",
        "fact": False,
        "fields": [
            {"name": "package", "options": [["1", "1 (at office2)"]]},
            {
                "name": "to",
                "options": [["office1", "office1"], ["office2", "office2"]],
                "apart": [{"field": "package", "places": PACKAGES}],
            },
        ],
    }
    assert clean["fields"] == [{"name": "how", "options": [["wet", "wet"], ["dry", "dry"], ["3", "3"]]}]


def test_orders_offer_goals_without_knowledge_of_the_world():
    deliver, clean = forms()
    found = list(deliver.samples(["a", "b"], ["box"]))
    assert found[0] == "goal(a,b,1)", "the first choice is the likely one"
    assert sorted(found) == ["goal(a,b,1)", "goal(a,b,box)", "goal(b,a,1)", "goal(b,a,box)"]
    assert list(clean.samples([], [])) == ["clean(wet)", "clean(dry)", "clean(3)"]


def test_orders_become_goals():
    deliver, clean = forms()
    assert deliver.fill({"package": "1", "to": "office1"}, LABELS, PACKAGES) == "goal(office2,office1,1)"
    assert clean.fill({"how": "3"}, LABELS, PACKAGES) == "clean(3)"


@pytest.mark.parametrize(
    "chosen",
    [
        {},
        {"package": "2", "to": "office1"},
        {"package": "1", "to": "office9"},
        {"package": ["1"], "to": "office1"},
        {"package": "1", "to": "office1),cancel(1"},
    ],
)
def test_orders_refuse_unknown_choices(chosen):
    with pytest.raises(OrderError, match="choose one of the options"):
        forms()[0].fill(chosen, LABELS, PACKAGES)


PATROL = """
- title: Patrol
  goal: "patrol({a},{b},{c})"
  choices: {a: labels, b: labels, c: [office1, office2]}
"""


def test_orders_require_different_places():
    deliver, _ = forms()
    with pytest.raises(OrderError, match="to: office2 is already 'from', choose another place"):
        deliver.fill({"package": "1", "to": "office2"}, LABELS, PACKAGES)
    (patrol,) = forms(PATROL)
    assert "apart" not in patrol.describe(LABELS, PACKAGES)["fields"][0]
    assert patrol.describe(LABELS, PACKAGES)["fields"][1]["apart"] == [{"field": "a", "places": None}]
    with pytest.raises(OrderError, match="a: office1 is already 'b'"):
        patrol.fill({"a": "office1", "b": "office1", "c": "office1"}, LABELS, PACKAGES)
    assert patrol.fill({"a": "office1", "b": "office2", "c": "office1"}, LABELS, PACKAGES).startswith("patrol")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("3", "a list of orders"),
        ("- {title: A, goal: g}", "choices"),
        ("- {title: A, goal: 'g({a})', choices: {}}", "'a' has to be in the goal, as {a}, and among the choices"),
        ("- {title: A, goal: 'g({a})', choices: {a: [X]}}", "'X' is not a ground term"),
        ("- {title: A, goal: 'g({a}', choices: {a: [x]}}", "is not a ground term"),
        ("- {title: A, goal: 'g({a})', choices: {a: nonsense}}", "a list of terms, 'labels', 'packages'"),
        ("- {title: A, goal: 'g({a})', choices: {a: place of b}}", "'b' is not a choice of packages"),
        ("- {title: A, goal: 'g({a})', choices: {a: [x]}, choose: 1}", "choose"),
        # facts that no sensor reports
        ("- {title: A, fact: '_opened(X,now)', choices: {}}", "is not a ground atom"),
        ("- {title: A, fact: '7', choices: {}}", "is not a ground atom"),
        ("- {title: A, fact: '_return(pickup,1,1)', choices: {}}", "is reserved"),
        ("- {title: A, fact: '_request(go(1),1)', choices: {}}", "is reserved"),
        ("- {title: A, goal: 'g(1)', fact: '_f(now)', choices: {}}", "goal"),
    ],
)
def test_orders_declaration_faults_are_reported(text, message):
    assert message in "\n".join(read(text)[1])


def test_orders_can_be_facts():
    [found] = forms('[{title: Open, fact: "_opened({a},{b},now)", choices: {a: labels, b: labels}}]')
    assert found.describe(LABELS, {})["fact"]
    chosen = {"a": "office1", "b": "office2"}
    assert found.fill(chosen, LABELS, {}) == "_opened(office1,office2,now)"
    assert found.words(chosen) == "Open: office1, office2"
    assert found.words(chosen, {"office2": "the lab"}) == "Open: office1, the lab"
    titled = found.describe(LABELS, {}, {"office2": "the lab"})["fields"][0]["options"]
    assert titled == [["office1", "office1"], ["office2", "the lab"]]
    with pytest.raises(OrderError, match="another place"):
        found.fill({"a": "office1", "b": "office1"}, LABELS, {})
