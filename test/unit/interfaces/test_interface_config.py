"""Entries of config/interfaces.yaml: accepted values, and each fault with its place."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.reading import Reader
from rosoclingo.interfaces.attempt import ActionLimits
from rosoclingo.interfaces.config import ConfigError, read_values, survey

TYPE = {"type": "actionlib/TestAction"}


def read_specs(data, values=None):
    """Return all entries; raises ConfigError with all faults, as the node does."""
    reader = Reader(data)
    specs = survey(reader, values)
    reader.check(ConfigError)
    return specs


def test_interface_config_with_all_keys_is_read():
    entry = {
        "server": "/robot/arm",
        "type": "actionlib/TestAction",
        "goal": {"goal": "$1"},
        "timeout": 3,
        "server_timeout": 0.5,
        "retries": 2,
        "retry_on": ["failed"],
        "repeatable": True,
        "done": {"topic": "arm/state", "type": "std_msgs/Int32", "when": {"data": "$1"}},
        "returns": [
            {"status": "aborted", "text": "(?i)stuck", "return": "blocked", "facts": ["stuck(${cycle})"]},
            {"when": {"result": 3}},
        ],
    }
    spec = read_specs({"arm": entry})["arm"]
    assert spec.limits == ActionLimits(3.0, 0.5, 2)
    assert spec.retry_on == ("failed",)
    assert spec.repeatable
    assert spec.done == ("arm/state", "std_msgs/Int32", {"data": "$1"})
    assert spec.rules[0].text.search("It is STUCK")
    assert spec.rules[1].returns == "failed"


@pytest.mark.parametrize(
    ("entry", "fault"),
    [
        ({}, "arm.type: is missing: give an action type like move_base_msgs/MoveBaseAction"),
        ({"type": "Test"}, "arm.type: must be an action type like .*, not 'Test'"),
        (
            {**TYPE, "returns": [{"status": "aborted", "success": True, "return": "$1"}]},
            r"arm.returns\[0\].return: has to be omitted with `success: true`:",
        ),
        ({**TYPE, "returns": [{"facts": ["heard($text,now)"]}]}, r"arm.returns\[0\].facts\[0\]: .* inside a text"),
        (
            {**TYPE, "returns": [{"facts": ["seen", 'heard("${text},now)']}]},
            r"arm.returns\[0\].facts\[1\]: .*not a ground atom",
        ),
        ({**TYPE, "done": {"topic": "state"}}, "arm.done.type: is missing: give a message type like"),
        ({**TYPE, "done": {"topic": "a", "type": "b/C", "when": {}}}, "arm.done.when: names no field"),
        ({**TYPE, "done": {"topic": "a", "type": "b/C", "when": {"x": "$status"}}}, "arm.done.when.x: no .status"),
        ({**TYPE, "goal": {"x": "$paramter"}}, r"no \$paramter \(did you mean \$parameter\?\); known are"),
        (
            {**TYPE, "server": "/{R/arm"},
            "arm.server: must be the name of an actionlib server, of letters, .* not '/{R/arm'",
        ),
        (
            {**TYPE, "done": {"topic": "my state", "type": "b/C"}},
            "arm.done.topic: must be the name of a topic, of letters",
        ),
        ({**TYPE, "server_timeout": 0}, "arm.server_timeout: must be a number above 0"),
        (
            {**TYPE, "returns": [{"status": "lost"}]},
            r"arm.returns\[0\].status: must be one of succeeded, .*, not 'lost'",
        ),
        ({**TYPE, "returns": [{"text": "("}]}, r"arm.returns\[0\].text: '\(' is not a regular expression"),
        (
            {**TYPE, "returns": [{"when": {"x": "/[a-z&&b]/"}}]},
            r"arm.returns\[0\].when.x: .* '\[a-z&&b\]' .* put a backslash .*: Possible set intersection at position 4",
        ),
        ({**TYPE, "returns": [{"return": "$what"}]}, r"arm.returns\[0\].return: no \$what"),
    ],
)
def test_interface_config_faults_name_their_place(entry, fault):
    with pytest.raises(ConfigError, match=fault):
        read_specs({"arm": entry})


FLEET = {
    "server": "/{R}/arm",
    "goal": {"goal": "{R}"},
    "done": {"topic": "{R}/state", "type": "std_msgs/Int32", "when": {"data": "$1"}},
    **TYPE,
}


@pytest.mark.parametrize(
    ("data", "values", "fault"),
    [
        (None, {}, "is missing: give a mapping of interface names"),
        ({}, {}, "has no entries; write one"),
        ({"Left Arm": TYPE}, {}, "Left Arm: the name must be the ASP term"),
        ({"arm(R)": FLEET}, {}, r"arm\(R\): there are no values for R; set ~values, such as {R: \[r1, r2\]}"),
        ({"arm(R)": {**FLEET, "timeout": -1}}, {"R": ["r1", "r2"]}, r"\Aarm\(R\).timeout: must be [^\n]*\Z"),
        ({"arm": FLEET}, {}, r"arm.server: {R} is not a variable of the entry's name \(write a name such as"),
        (
            {"arm(R)": FLEET, "arm(r1)": {**TYPE, "server": "a"}},
            {"R": ["r1"]},
            r"arm\(r1\) has another entry, arm\(R\)",
        ),
        ({"arm(R)": TYPE}, {"R": ["r1"]}, r"arm\(R\).server: is missing: give the name of an actionlib server"),
        ({"arm(S)": FLEET}, {"S": ["s"]}, r"arm\(S\).done.topic: {R} is not a variable .* \(its variables are S\)"),
    ],
)
def test_interface_config_has_entries_whose_variables_have_values(data, values, fault):
    with pytest.raises(ConfigError, match=fault):
        read_specs(data, values)


def test_interface_config_name_with_variables_stands_for_several_entries():
    specs = read_specs({"arm(R)": FLEET, "leg": TYPE}, {"R": ["r1", "r2"]})
    assert list(specs) == ["arm(r1)", "arm(r2)", "leg"]
    second = specs["arm(r2)"]
    assert (second.key, second.name, second.server) == ("arm(R)", "arm(r2)", "/r2/arm")
    assert (second.goal, second.done.topic) == ({"goal": "r2"}, "r2/state")
    hands = read_specs({"hand(R,S)": {**TYPE, "server": "{R}/{S}"}}, {"R": ["r1", "r2"], "S": ["left", "right"]})
    assert list(hands) == ["hand(r1,left)", "hand(r1,right)", "hand(r2,left)", "hand(r2,right)"]


def test_interface_config_without_values_knows_the_instances():
    spec = read_specs({"arm(R)": FLEET})["arm(R)"]
    assert spec.instance("arm(r7)").name == "arm(r7)"
    assert spec.instance("arm(r7)").key == "arm(R)"
    assert spec.instance("leg(r7)") is spec.instance("arm(r7,left)") is spec.instance("arm") is None


@pytest.mark.parametrize(
    ("values", "fault"),
    [
        (["r1"], "~values: must be a mapping of variables to values"),
        ({"R": "r1"}, "~values.R: must be a list of values such as"),
        ({"robot": ["r1"]}, "~values: robot is not a variable: begin it with a capital"),
        ({"R": ["robot(1)"]}, r"~values: 'robot\(1\)' for R is not a constant: write one such as r1"),
    ],
)
def test_interface_config_values_are_lists_of_constants(values, fault):
    reader = Reader(values, "~values")
    read_values(reader)
    with pytest.raises(ConfigError, match=fault):
        reader.check(ConfigError)


SCALARS = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=8), st.just("$parameter"))
ANYTHING = st.recursive(
    SCALARS,
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(SCALARS, inner, max_size=3)),
    max_leaves=8,
)
FIELDS = ["server", "type", "goal", "timeout", "server_timeout", "pause", "retries", "retry_on", "returns", "other"]
RULES = st.lists(st.dictionaries(st.sampled_from(["status", "text", "when", "return", "facts"]), ANYTHING), max_size=3)


@pytest.mark.slow
@given(st.dictionaries(st.sampled_from(FIELDS), st.one_of(ANYTHING, RULES)), SCALARS)
def test_interface_config_of_any_data_is_handled(entry, name):
    try:
        read_specs({name: entry})
    except ConfigError as error:
        assert str(error)  # noqa: PT017
