"""``check --orders``: orders are compared with the program, and tried by --plan and --verify."""

import json
import re

import pytest
from verified_programs import VISITS, more

from rosoclingo.checking import check_command
from rosoclingo.interfaces.checking.robot_files import RobotFiles

PROGRAM = more(VISITS, "_status(X,rejected,t) :- _request(ring(X),t+1), place(X).")
ORDERS = """
- title: Have a room visited
  goal: "visit({room})"
  choices: {room: [hall, den]}
"""


@pytest.fixture
def ask(tmp_path, capsys):
    """Run check on the program with a file of orders; return its exit code and output."""

    def run(orders, *options):
        (tmp_path / "program.lp").write_text(PROGRAM)
        (tmp_path / "orders.yaml").write_text(orders)
        words = [str(tmp_path / "program.lp"), "--orders", str(tmp_path / "orders.yaml"), *options]
        return check_command.main(words, RobotFiles()), capsys.readouterr().out

    return run


@pytest.mark.slow
def test_order_file_goals_are_tried(ask):
    _, output = ask(ORDERS, "--plan", "--verify", "1")
    assert "goals: visit(hall) visit(den)\n" in output, "and no other"
    assert re.findall(r"^(\S+): a plan up to step", output, re.MULTILINE) == ["visit(hall)"]


@pytest.mark.parametrize(
    ("orders", "kind", "line", "words"),
    [
        (ORDERS.replace("visit({room})", "visits({room})"), "unheard-order", 3, "did you mean visit(hall)?"),
        (ORDERS.replace("visit({room})", "visit({room},1)"), "unheard-order", 3, "visit(hall,1) (rules match visit(P)"),
        (ORDERS.replace("{room: [", "{rom: ["), "configuration", 2, "'room' has to be in the goal"),
        (ORDERS.replace("den]", "Den]"), "configuration", 4, "'Den' is not a ground term"),
        ('[{title: A, fact: "_nosuch(now)", choices: {}}]', "unheard-order", 1, "declares no external _nosuch/1"),
        ("- ]", "configuration", 1, "invalid YAML"),
    ],
)
def test_order_file_reports_useless_orders(ask, orders, kind, line, words):
    code, output = ask(orders, "--json")
    found = [one for one in json.loads(output)["findings"] if one["file"].endswith(".yaml")]
    assert (code, {(one["kind"], one["line"]) for one in found}) == (1, {(kind, line)})
    assert any(words in one["message"] for one in found)
