"""Which interfaces are registered, and which actions wait for a missing one."""

from rosoclingo.oclingo import parse_atom
from rosoclingo.reasoning.interface_register import GRACE, MOST_NAMES, InterfaceRegister
from rosoclingo.reasoning.keywords import action_of

HOLD, MOVE = (action_of(parse_atom(text)) for text in ("_action_lib(hold,cup,3)", "_action_lib(move_base,hall,3)"))
NODES = frozenset({"/a", "/b"})


def register(**announced):
    found = InterfaceRegister()
    for node, names in announced.items():
        for name in names.split():
            found.announce("/" + node, name)
    return found


def looked(found, awaited, first=0.0):
    """Return the missing interfaces after GRACE."""
    assert found.look(awaited, NODES, NODES, first) == []
    return [(one.action, one.text, one.new) for one in found.look(awaited, NODES, NODES, first + GRACE)]


def test_register_reports_action_without_interface_and_alternatives():
    found = register(a="move_base pickup", b="deliver")
    text = "no interface 'hold' for _action_lib(hold,cup,3): the interfaces are deliver, move_base, pickup"
    assert looked(found, [HOLD, MOVE]) == [(HOLD, text, True)]
    assert looked(found, [], first=5.0) == []
    assert looked(found, [HOLD], first=10.0) == [(HOLD, text, True)], "another action of the kind"
    assert [one.new for one in found.look([HOLD], NODES, NODES, 20.0)] == [False], "each is reported once"
    found.announce("/b", "hold")
    assert found.look([HOLD], NODES, NODES, 30.0) == []
    assert found.names == ["deliver", "hold", "move_base", "pickup"]


def test_register_removes_interfaces_with_their_node():
    found = register(a="move_base", b="hold")
    assert looked(found, [HOLD]) == []
    assert [one.action for one in found.look([HOLD], {"/a"}, {"/a"}, GRACE)] == [HOLD]
    assert found.names == ["move_base"]


def test_register_waits_for_answer_of_unannounced_nodes():
    found = register(a="move_base")
    ((_, text, _),) = looked(found, [HOLD])
    assert text.endswith("the interfaces are move_base, and /b may have others")
    found.answered("hold")
    assert looked(found, [HOLD], first=10.0) == []
    assert found.look([HOLD], {"/a"}, NODES, 20.0), "the one that answered is gone"


def test_register_reports_first_late_action_that_certainly_waits():
    found = register(a="move_base")
    found.look([MOVE, HOLD], {"/a"}, {"/a"}, 0.0)
    text = "no interface 'hold' for _action_lib(hold,cup,3): the interfaces are move_base"
    assert found.fault([MOVE, HOLD], {"/a"}, {"/a"}, GRACE) == text
    assert found.fault([MOVE, HOLD], {"/a"}, {"/a"}, GRACE / 2) == ""
    assert found.fault([MOVE], {"/a"}, {"/a"}, GRACE) == ""
    assert found.fault([MOVE], {"/recorder"}, {"/a"}, GRACE).startswith("no interface 'move_base'"), "its node is deaf"
    assert found.fault([HOLD], NODES, NODES, GRACE) == "", "an unannounced node can have it"
    assert found.fault([], set(), set(), GRACE) == ""


def test_register_limits_the_names_of_a_node():
    found = register()
    for number in range(MOST_NAMES + 10):
        found.announce("/a", f"arm{number}")
    assert len(found.names) == MOST_NAMES
