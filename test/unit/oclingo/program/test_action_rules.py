"""The recognition of actions."""

import pytest

from rosoclingo.oclingo import parse_atom
from rosoclingo.oclingo.program.action_rules import is_action, is_action_of


@pytest.mark.parametrize(
    ("text", "action", "of"),
    [
        ("_action_lib(go,x,2)", True, True),
        ("_action_lib(go,x,1)", True, False),
        ("_action_lib(go,x,now)", True, False),
        ("-_action_lib(go,x,2)", False, False),
        ("_action_lib(go,2)", False, False),
        ("_return(go,x,2)", False, False),
        ("at", False, False),
    ],
)
def test_is_action_checks_signature_sign_and_cycle(text, action, of):
    assert is_action(parse_atom(text)) is action
    assert is_action_of(2)(parse_atom(text)) is of
