"""Facts between core and interfaces, and terms as plain values."""

import contextlib

import pytest
from clingo import Function, Number, String
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.interfaces.facts import Sender, parse_command, return_text, return_value
from rosoclingo.interfaces.values import (
    TermError,
    as_boolean,
    as_integer,
    as_real,
    as_term,
    as_text,
    read_term,
)
from rosoclingo.reasoning.keywords import Action, KeywordError, return_of
from rosoclingo.reasoning.returns import Dispatch
from rosoclingo.runs.topic_atoms import run_in

OFFICE2 = Function("office2")


#: Parameters and reasons: answers of interfaces and core, words of an entry, terms around them.
WORDS = (
    "failed",
    "rejected",
    "timeout",
    "preempted",
    "server_lost",
    "interrupted",
    "blocked",
    "office2",
    '"failed"',
    "7",
)
TERMS = st.recursive(
    st.sampled_from(WORDS).map(read_term),
    lambda inside: st.builds(
        lambda name, terms: Function(name, terms),
        st.sampled_from(("failed", "")),
        st.lists(inside, min_size=2, max_size=2),
    ),
    max_leaves=3,
)


@given(st.lists(TERMS, min_size=1, max_size=4, unique=True), TERMS, st.data())
def test_facts_reason_never_equals_success_of_an_action(parameters, reason, data):
    actions = [Action(Function("drop"), parameter, 3) for parameter in parameters]
    action = data.draw(st.sampled_from(actions))
    value = return_value(action, reason, False, actions.__contains__)
    assert value not in parameters
    assert value == reason or reason in parameters or reason.arguments[-1] in parameters
    under_way = Dispatch(3, tuple(actions), 0.0)
    under_way.take(return_of(read_term(return_text(action, value))))
    [(_, blamed)] = under_way.failures(under_way.returns)
    assert action in blamed
    assert value == reason or blamed == (action,)


@pytest.mark.parametrize(
    ("sender", "owner", "may"),
    [
        (("core", "new"), ("core", "new"), True),
        (("core", None), ("core", "new"), False),
        (("other_core", "old"), ("core", "new"), False),
        (("rostopic", None), ("core", "new"), True),
        (("core", None), ("core", None), True),
        (("core", "new"), ("core", None), True),
    ],
)
def test_facts_of_a_replaced_core_cancel_nothing(sender, owner, may):
    assert Sender(*sender).can_cancel(Sender(*owner)) is may


def test_facts_run_is_read():
    assert run_in('_run("4f-2 a")') == "4f-2 a"
    assert [run_in(text) for text in ("_run(4)", "_run(a)", '_run("a","b")', '_rum("a")', "_run(", "")] == [None] * 6


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("_action_lib(move_base,office2", "is not a ground atom"),
        ("_action_lib(move_base,office2)", "not of the form"),
        ("-_action_lib(move_base,office2,1)", "not of the form"),
        ("_action_lib(move_base,office2,now)", "cycle 'now' is not a positive integer"),
        ("_action_lib(pickup,office2,1)", "is for pickup, but was sent to move_base"),
    ],
)
def test_facts_report_other_atoms_as_no_command(text, fault):
    with pytest.raises((TermError, KeywordError), match=fault):
        parse_command(text, "move_base")


@given(st.text(max_size=60))
def test_facts_any_text_is_command_or_fact_error(text):
    with contextlib.suppress(TermError, KeywordError):
        parse_command(text, "move_base")


def test_facts_terms_become_values_and_back():
    assert as_text(String("two words")) == "two words"
    assert as_text(Function("f", [Number(1), String("a")])) == 'f(1,"a")'
    assert as_integer(Number(-3)) == as_integer("-3") == -3
    assert (as_real(String("0.25")), as_real(Number(2))) == (0.25, 2.0)
    assert (as_boolean(Function("true")), as_boolean(Number(0)), as_text(True)) == (True, False, "true")
    assert (as_term(OFFICE2), as_term(3), as_term(True)) == (OFFICE2, Number(3), Function("true"))
    assert as_term("at(office2,3)") == Function("at", [OFFICE2, Number(3)])
    assert as_term("Office 3") == String("Office 3")


@pytest.mark.parametrize(
    ("convert", "value"),
    [
        (as_integer, Function("a")),
        (as_integer, String("0.5")),
        (as_integer, True),
        (as_real, String("nan")),
        (as_boolean, Number(2)),
    ],
)
def test_facts_unsuitable_values_are_reported(convert, value):
    with pytest.raises(TermError):
        convert(value)
