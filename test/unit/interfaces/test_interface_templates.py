"""Templates of goals and answers."""

import re
from types import SimpleNamespace

import pytest
from clingo import Function, Number
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.labels import LabelTable, UnknownLabelError
from rosoclingo.interfaces.answers import Rule, answer, conclude
from rosoclingo.interfaces.templates import (
    ANSWER_NAMES,
    Ended,
    FillError,
    Now,
    Scope,
    evaluate,
    faults,
    uses_labels,
)
from rosoclingo.interfaces.values import read_term

LABELS = LabelTable.from_mapping({"office2": {"x": 3, "y": 4, "yaw": 1}})
RESULT = SimpleNamespace(outcome=3, location="office4", text="Some Words", poses=[SimpleNamespace(x=7)])


def scope(parameter="office2", ended=None):
    return Scope(read_term(parameter), 5, LABELS, ended)


@pytest.mark.parametrize(
    ("template", "parameter", "value"),
    [
        ("$parameter", "office2", Function("office2")),
        ("${parameter}", "7", Number(7)),
        ("$1", "office2", Function("office2")),
        ("$2", "put(cup,table)", Function("table")),
        ("$2.1", "put(cup,on(table))", Function("table")),
        ("$parameter.x", "office2", 3.0),
        ("$1.frame", "at(office2,9)", "map"),
        ("$cycle", "office2", 5),
        ("box_${1}_of_${cycle}", "7", "box_7_of_5"),
        ("costs $$5", "a", "costs $5"),
        ("plain", "a", "plain"),
        (3.5, "a", 3.5),
        ([1, "$parameter"], "a", [1, Function("a")]),
        ({"a": {"b": "$parameter"}}, "a", {"a": {"b": Function("a")}}),
        ("$parameter.pose", "office2", LABELS["office2"]),
    ],
)
def test_values(template, parameter, value):
    assert not faults(template)
    assert evaluate(template, scope(parameter)) == value


def test_now_is_filled_in_later():
    assert isinstance(evaluate("$now", scope()), Now)


@pytest.mark.parametrize(
    ("template", "parameter", "error"),
    [
        ("$2", "office2", FillError),
        ("$3", "f(a,b)", FillError),
        ("$1.1", "office2", FillError),
        ("$parameter.pose", "office9", UnknownLabelError),
        ("to ${parameter.pose}", "office2", FillError),
        ("at ${now}", "office2", FillError),
        ("$result.location", "office2", FillError),
    ],
)
def test_what_an_action_cannot_fill(template, parameter, error):
    with pytest.raises(error):
        evaluate(template, scope(parameter))


@pytest.mark.parametrize(
    ("template", "fault"),
    [
        ("$paramter", r"goal.a: no \$paramter \(is \$parameter meant\?\); known are \$parameter, \$cycle, \$now, \$1"),
        ("$0", r"argument numbers from 1 on"),
        ("$1.0", r"argument numbers from 1 on"),
        ("$parameter.colour", r"at last one of pose, x, y, yaw, frame"),
        ("$parameter.pose.x", r"at last one of"),
        ("$cycle.x", r"\$cycle has no .x"),
        ("for $5 only", r"write \$name alone"),
        ("$result.x", r"no \$result.x"),
        ([{"b": "$x"}], r"goal.a\[0\].b: no \$x"),
    ],
)
def test_faulty_templates_are_told_with_their_place(template, fault):
    [found] = faults(template, place="goal.a")
    assert re.search(fault, found)


def test_answers_may_refer_to_the_end():
    assert not faults("$result.poses.0.x", ANSWER_NAMES)
    end = scope(ended=Ended("aborted", "no way", RESULT))
    assert evaluate("$status", end) == "aborted"
    assert evaluate("$text", end) == "no way"
    assert evaluate("$result.poses.0.x", end) == 7
    with pytest.raises(FillError, match=r"the result has no poses.1"):
        evaluate("$result.poses.1", end)
    with pytest.raises(FillError, match=r"the result has no colour"):
        evaluate("$result.colour", end)


@pytest.mark.parametrize(
    ("status", "value"),
    [
        ("succeeded", "office2"),
        ("aborted", "failed"),
        ("rejected", "rejected"),
        ("preempted", "preempted"),
        ("recalled", "preempted"),
        ("timeout", "timeout"),
        ("server_lost", "server_lost"),
        ("interface_lost", "interface_lost"),
        ("unknown_label", "unknown_label"),
        ("bad_parameter", "bad_parameter"),
    ],
)
def test_default_return_terms(status, value):
    assert str(answer((), scope(ended=Ended(status))).value) == value


def test_the_first_matching_rule_answers():
    rules = (
        Rule("here(${1})", status="succeeded"),
        Rule("not_here", status="aborted", when={"outcome": 3, "location": "/^office/"}, facts=("seen(${1},$$)",)),
        Rule("blocked", status="aborted"),
    )
    assert str(answer(rules, scope(ended=Ended("succeeded"))).value) == "here(office2)"
    first = answer(rules, scope(ended=Ended("aborted", "", RESULT)))
    assert str(first.value) == "not_here"
    assert str(answer(rules, scope(ended=Ended("aborted", "", None))).value) == "blocked"
    assert str(answer(rules, scope(ended=Ended("rejected"))).value) == "rejected"
    assert first.facts == ()
    assert "is no ground atom" in first.warnings[0]


def test_further_facts_and_terms_from_the_result():
    rule = Rule("$result.location", facts=("at(${result.location},${cycle})", "$result.missing"))
    given = answer((rule,), scope(ended=Ended("succeeded", "", RESULT)))
    assert str(given.value) == "office4"
    assert given.facts == ("at(office4,5)",)
    assert len(given.warnings) == 1


def test_an_answer_that_cannot_be_filled_falls_back():
    given = answer((Rule("$result.missing"),), scope(ended=Ended("aborted", "", RESULT)))
    assert str(given.value) == "failed"
    assert "the result has no missing" in given.warnings[0]


def test_text_that_is_no_term_is_returned_as_a_string():
    assert str(answer((Rule("$result.text"),), scope(ended=Ended("succeeded", "", RESULT))).value) == '"Some Words"'


@pytest.mark.parametrize(
    ("verdict", "ended", "status"),
    [
        (None, Ended("aborted"), "aborted"),
        (None, None, "aborted"),
        ("timeout", None, "timeout"),
        ("timeout", Ended("preempted"), "timeout"),
        ("timeout", Ended("succeeded"), "succeeded"),
        ("server_lost", None, "server_lost"),
    ],
)
def test_the_own_verdict_stands_unless_the_server_succeeded(verdict, ended, status):
    assert conclude(verdict, ended).status == status


PIECES = st.sampled_from(
    ["$", "{", "}", "parameter", "1", "2", ".", "0", "pose", "x", "cycle", "now", "result", "a ", "$$"]
)


@given(
    st.lists(PIECES, max_size=8).map("".join), st.sampled_from(["office2", "office9", "f(a,office2)", "7", '"text"'])
)
def test_a_template_that_passes_the_check_is_filled_or_refused_for_a_reason(template, parameter):
    if faults(template):
        return
    try:
        evaluate(template, scope(parameter))
    except (FillError, UnknownLabelError) as error:
        assert str(error)  # noqa: PT017


@pytest.mark.parametrize(
    ("template", "wanted"),
    [
        ({"target_pose": "$parameter.pose"}, True),
        ({"a": [{"b": "at ${2.1.x}"}]}, True),
        ({"a": "$1", "b": 3, "c": "$$x"}, False),
        ({"a": "$result.pose"}, False),
    ],
)
def test_templates_that_ask_for_labels(template, wanted):
    assert uses_labels(template) is wanted
