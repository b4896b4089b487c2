"""Templates of goals and answers."""

import re
from types import SimpleNamespace

import pytest
from clingo import Function
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.labels import LabelTable, UnknownLabelError
from rosoclingo.common.reading import Reader
from rosoclingo.interfaces.answers import Rule, answer, conclude
from rosoclingo.interfaces.config import survey
from rosoclingo.interfaces.templates import (
    ANSWER_NAMES,
    ActionScope,
    FillError,
    GoalEnd,
    evaluate,
    faults,
    label_references,
)
from rosoclingo.interfaces.values import read_atom, read_term

LABELS = LabelTable.from_mapping({"office2": {"x": 3, "y": 4, "yaw": 1}})
RESULT = SimpleNamespace(outcome=3, location="office4", text="Some Words", poses=[SimpleNamespace(x=7)])
ABORTED = GoalEnd("aborted")


def scope(parameter="office2", ended=ABORTED):
    return ActionScope(read_term(parameter), 5, LABELS, ended)


@pytest.mark.parametrize(
    ("template", "parameter", "value"),
    [
        ("$parameter", "office2", Function("office2")),
        ("$2.1", "put(cup,on(table))", Function("table")),
        ("$parameter.x", "office2", 3.0),
        ("$1.frame", "at(office2,9)", "map"),
        ("$cycle", "office2", 5),
        ("box_${1}_of_${cycle}", "7", "box_7_of_5"),
        ("costs $$5", "a", "costs $5"),
        ({"a": [1, "$parameter"]}, "a", {"a": [1, Function("a")]}),
        ("$parameter.pose", "office2", LABELS["office2"]),
    ],
)
def test_template_values_are_filled(template, parameter, value):
    assert not faults(template)
    assert evaluate(template, scope(parameter)) == value


@pytest.mark.parametrize(
    ("template", "parameter", "error"),
    [
        ("$2", "office2", FillError),
        ("$parameter.pose", "office9", UnknownLabelError),
    ],
)
def test_template_reports_fields_that_an_action_lacks(template, parameter, error):
    with pytest.raises(error):
        evaluate(template, scope(parameter))


@pytest.mark.parametrize(
    ("template", "fault"),
    [
        ("$paramter", r"no \$paramter \(did you mean \$parameter\?\); known are \$parameter, \$cycle, \$now, \$1"),
        ("$0", r"argument numbers of at least 1"),
        ("$parameter.colour", r"then one of pose, x, y, yaw, frame"),
        ("$cycle.x", r"\$cycle has no .x"),
        ("for $5 only", r"write \$name alone"),
        ("$result.x", r"no \$result.x"),
        ([{"b": "$x"}], r"goal.a\[0\].b: no \$x"),
    ],
)
def test_template_faults_name_their_place(template, fault):
    [found] = faults(template, place="goal.a")
    assert re.search(fault, found)


def test_template_answers_can_refer_to_the_end():
    assert not faults("$result.poses.0.x", ANSWER_NAMES)
    end = scope(ended=GoalEnd("aborted", "no way", RESULT))
    assert evaluate("$status", end) == "aborted"
    assert evaluate("$text", end) == "no way"
    assert evaluate("$result.poses.0.x", end) == 7
    with pytest.raises(FillError, match=r"the result has no poses.1"):
        evaluate("$result.poses.1", end)
    with pytest.raises(FillError, match=r"the result has no colour"):
        evaluate("$result.colour", end)


def test_template_first_matching_rule_answers():
    rules = (
        Rule("here(${1})", status="succeeded"),
        Rule("not_here", status="aborted", when={"outcome": 3, "location": "/^office/"}, facts=("seen(${1},$$)",)),
        Rule("stuck", status="aborted", text=re.compile("(?i)stuck")),
        Rule("blocked", status="aborted"),
    )
    assert str(answer(rules, scope(ended=GoalEnd("aborted", "It is STUCK"))).value) == "stuck"
    assert str(answer(rules, scope(ended=GoalEnd("succeeded"))).value) == "here(office2)"
    first = answer(rules, scope(ended=GoalEnd("aborted", "", RESULT)))
    assert str(first.value) == "not_here"
    assert str(answer(rules, scope(ended=GoalEnd("aborted", "", None))).value) == "blocked"
    assert str(answer(rules, scope(ended=GoalEnd("rejected"))).value) == "rejected"
    assert first.facts == ()
    assert "is not a ground atom" in first.warnings[0]


def said(words, *facts, returns="$result.message", parameter="office2"):
    """Return what an entry makes of a server's words."""
    return answer(
        (Rule(returns, facts=facts),), scope(parameter, GoalEnd("succeeded", words, SimpleNamespace(message=words)))
    )


#: Any text that ASP permits, with more of ASP's own words than random text has.
TEXTS = st.one_of(
    st.text(st.characters(blacklist_categories=["Cs"], blacklist_characters="\0")),
    st.lists(st.sampled_from(['"', "\\", "\n", ",", "(", ")", ".", "a", " ", "%", "$", "{", "}", "X", "\\n", "ä"])).map(
        "".join
    ),
)


@given(TEXTS)
def test_template_any_text_survives_in_a_fact(words):
    given = said(words, 'heard("${result.message}",1,now)', 'noted(f("<${text}>"),"${1}")', returns='told("${text}")')
    assert given.warnings == ()
    heard, noted = map(read_atom, given.facts)
    assert (heard.name, [argument.type.name for argument in heard.arguments]) == (
        "heard",
        ["String", "Number", "Function"],
    )
    assert heard.arguments[0].string == words
    assert noted.arguments[0].arguments[0].string == f"<{words}>"
    assert noted.arguments[1].string == "office2"
    assert given.value.arguments[0].string == words


@given(TEXTS)
def test_template_bare_text_is_one_term_or_reported(words):
    given = said(words, "heard(${result.message},now)", returns="told(${text})")
    if given.facts:
        heard = read_atom(given.facts[0])
        assert (heard.name, len(heard.arguments)) == ("heard", 2)
        assert heard.arguments[0] == read_term(words) == given.value.arguments[0]
    else:
        assert len(given.warnings) == 2
        assert all("which is not a term" in warning for warning in given.warnings)
        assert str(given.value) == "office2", "as without the rule"


@pytest.mark.parametrize(
    ("words", "template", "fact", "warning"),
    [
        ("a\0b\udc80", 'heard("${text}",now)', 'heard("a\ufffdb\ufffd",now)', ""),
        ("f(a, b)", "heard(${text},now)", "heard(f(a,b),now)", ""),
        ("hall", "heard_${text}(${cycle})", "heard_hall(5)", ""),
        ("seen(hall)", "$text", "seen(hall)", ""),
        ("hall", 'heard("$$${text}","${1}",now)', 'heard("$hall","office2",now)', ""),
        (
            "two words",
            "heard(${text},now)",
            None,
            "${text} is 'two words', which is not a term: write \"${text}\", within quotes",
        ),
        (0.5, "heard(${result.message},now)", None, "${result.message} is '0.5', which is not a term"),
        ("a(b", "heard_${text}(now)", None, "which is not part of a name"),
        ("two words", "$text", None, "is not a ground atom"),
    ],
)
def test_template_server_words_in_a_fact(words, template, fact, warning):
    given = said(words, template)
    assert given.facts == (() if fact is None else (fact,))
    assert [warning in one for one in given.warnings] == ([True] if warning else [])


@pytest.mark.parametrize(
    ("rule", "ended", "success"),
    [
        ({"status": "aborted", "return": "$parameter"}, GoalEnd("aborted"), None),
        ({"status": "aborted", "success": True}, GoalEnd("aborted"), True),
        ({"status": "succeeded", "return": "$parameter"}, GoalEnd("succeeded"), None),
        ({"status": "succeeded", "return": "office2"}, GoalEnd("succeeded"), False),
        ({"return": 7}, GoalEnd("succeeded"), False),
        ({"return": "${result.missing}"}, GoalEnd("succeeded"), None),
    ],
)
def test_template_constant_is_a_reason_and_never_success(rule, ended, success):
    spec = survey(Reader({"arm": {"type": "actionlib/TestAction", "returns": [rule]}}))["arm"]
    given = answer(spec.rules, scope(ended=ended))
    assert given.success is success
    if success or success is None:
        assert str(given.value) == "office2"


PIECES = st.sampled_from(
    ["$", "{", "}", "parameter", "1", "2", ".", "0", "pose", "x", "cycle", "now", "result", "a ", "$$"]
)


def test_template_own_verdict_stands_unless_server_succeeded():
    assert conclude("timeout", GoalEnd("preempted")).status == "timeout"
    assert conclude("timeout", GoalEnd("succeeded")).status == "succeeded"


@given(
    st.lists(PIECES, max_size=8).map("".join), st.sampled_from(["office2", "office9", "f(a,office2)", "7", '"text"'])
)
def test_template_that_passes_check_is_filled_or_refused(template, parameter):
    if faults(template):
        return
    try:
        evaluate(template, scope(parameter))
    except (FillError, UnknownLabelError) as error:
        assert str(error)  # noqa: PT017


@pytest.mark.parametrize(
    ("template", "wanted"),
    [
        ({"target_pose": "$parameter.pose"}, ["$parameter"]),
        ({"a": [{"b": "at ${2.1.x}"}]}, ["$2.1"]),
        ({"a": "$1", "b": 3, "c": "$$x"}, []),
        ({"a": "$result.pose"}, []),
    ],
)
def test_template_that_requires_labels(template, wanted):
    assert label_references(template) == wanted
