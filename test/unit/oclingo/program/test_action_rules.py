"""Rules that exclude actions beyond the horizon, and the recognition of actions."""

import pytest

from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.oclingo.program.action_rules import closing_text, is_action, is_action_of

PROGRAM = """
_action_lib(wait,x,7).
#program cumulative(t).
{ _action_lib(go,X,t) : d(X) }.
_action_lib(go,x,t+1) :- _action_lib(go,x,t-1), d(t).
_action_lib(see,x,C) :- d(C).
_action_lib(see,x,C+t) :- d(C).
_action_lib(see,x,t+C) :- d(C).
_action_lib(say,x,|t|).
_action_lib(two,x,2*t+(0..1)).
_action_lib(abs,x,t+|C|) :- C = -2.
d(t).
#external _action_lib(far,x,t+9).
#program volatile(k).
_action_lib(end,x,k-1).
:- _action_lib(go,x,k-5).
"""
EXPECTED = {
    ("base", "7", ""),
    ("cumulative(k)", "(k-1)", ""),
    ("cumulative(t)", "(t+1)", ""),
    ("cumulative(t)", "C__", " : _action_lib(_,_,C__)"),
    ("cumulative(t)", "t", ""),
}


def test_closing_text_has_one_rule_per_cycle_term():
    program = ReactiveProgram.from_text(PROGRAM)
    expected = [
        f"#program {part}.\n#external __oclingo_beyond({cycle}){domain}.\n"
        f":- _action_lib(A__,P__,{cycle}), __oclingo_beyond({cycle}).\n"
        for part, cycle, domain in sorted(EXPECTED)
    ]
    assert closing_text(program.parts).text.split("\n#program") == "\n".join(["", *expected]).split("\n#program")


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
