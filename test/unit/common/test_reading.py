"""Values read at their places: either read, or refused with place and remedy, all faults at once."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rosoclingo.common.reading import MISSING, Reader, likely, read_yaml

SCALARS = st.one_of(st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=5))
ANYTHING = st.recursive(
    SCALARS,
    lambda inner: st.one_of(st.lists(inner, max_size=3), st.dictionaries(SCALARS, inner, max_size=3)),
    max_leaves=6,
)
READ = {
    "number": lambda one: one.number(low=0.0),
    "whole": lambda one: one.whole(low=1, high=9),
    "numbers": lambda one: one.numbers((2, 3)),
    "text": lambda one: one.text(),
    "texts": lambda one: one.texts(some=True),
    "flag": lambda one: one.flag(),
    "choice": lambda one: one.choice(["a", "b"]),
    "mapping": lambda one: one.mapping(),
    "items": lambda one: one.items(),
    "entries": lambda one: one.entries(),
    "like an integer": lambda one: one.like(3, least=1),
}


@pytest.mark.parametrize(
    ("kind", "value", "wanted"),
    [
        ("number", -1, "a number of at least 0"),
        ("number", math.inf, "a number of at least 0"),
        ("number", True, "a number of at least 0"),
        ("number", 10**400, "a number of at least 0"),
        ("whole", 1.5, "an integer from 1 to 9"),
        ("numbers", [1, math.nan], "2 or 3 finite numbers"),
        ("text", "", "a text"),
        ("texts", ["a", 3], "a list of texts"),
        ("flag", 1, "true or false"),
        ("choice", "c", "one of a, b"),
        ("mapping", [1], "a mapping"),
        ("items", {}, "a list"),
        ("entries", "abc", "a mapping"),
    ],
)
def test_reading_fault_names_place_remedy_and_value(kind, value, wanted):
    reader = Reader({"arm": [{}, {"speed": value}]}, source="map.yaml: ")
    READ[kind](reader.at("arm").items()[1].at("speed"))
    shown = repr(value) if len(repr(value)) < 200 else repr(value)[:200] + " ..."
    assert reader.faults == [f"map.yaml: arm[1].speed: must be {wanted}, not {shown}"]


def test_reading_accepts_the_documented_values():
    data = {"a": 3, "b": "1e-3", "c": 2.0, "d": [1, 2], "e": "x", "f": ["x"], "g": False, "h": {"x": 1, 7: 2}}
    reader = Reader(data)
    assert (reader.at("a").number(), reader.at("b").number(), reader.at("c").whole()) == (3.0, 0.001, 2)
    assert (reader.at("d").numbers((2,)), reader.at("e").text(), reader.at("f").texts()) == ((1.0, 2.0), "x", ("x",))
    assert (reader.at("g").flag(), reader.at("e").choice("xyz")) == (False, "x")
    assert [(name, one.place, one.value) for name, one in reader.at("h").entries()] == [
        ("x", "h.x", 1),
        ("7", "h.7", 2),
    ]
    reader.close()
    assert reader.faults == []


def test_reading_missing_or_empty_value_has_its_default():
    reader = Reader({"empty": None})
    for key in ("empty", "absent"):
        assert reader.at(key).number(1.5) == 1.5
        assert reader.at(key).items() == []
        assert reader.at(key).at("inside").flag(True)
        reader.at(key).close()
    assert reader.faults == []
    assert reader.at("empty").text() == ""
    reader.at("absent").at("inside").text(wanted="a name")
    assert reader.faults == ["empty: is missing: give a text", "absent.inside: is missing: give a name"]


def test_reading_suggests_a_likely_key():
    reader = Reader({"sped": 1, "xyz": 2, 3: 4, "also": 5})
    reader.at("speed").number(1.0)
    reader.close(also=("also",))
    keys = "keys are speed, also"
    assert reader.faults == [
        f"unknown key 'sped' (did you mean speed?); {keys}",
        f"unknown key 'xyz'; {keys}",
        f"unknown key 3; {keys}",
    ]
    assert likely("sped", ["speed"], "~") == " (did you mean ~speed?)"
    assert likely("abc", ["speed"]) == ""


@pytest.mark.parametrize("text", ["a: [", "a: 2026-02-31", None])
def test_reading_reports_unreadable_files(tmp_path, text):
    path = tmp_path / "some.yaml"
    if text is not None:
        path.write_text(text)
    with pytest.raises(LookupError, match=f"map {path}: cannot be read: "):
        read_yaml(path, "map", LookupError)


@given(ANYTHING | st.just(MISSING), st.sampled_from(sorted(READ)))
def test_reading_any_value_gives_its_kind_or_fault(value, kind):
    reader = Reader(value, "here")
    found = READ[kind](reader)
    assert isinstance(found, (float, int, str, tuple, list, dict, bool))
    assert len(reader.faults) <= 1
    if reader.faults:
        with pytest.raises(LookupError, match="here: "):
            reader.check(LookupError)
    for fault in reader.faults:
        assert fault.startswith("here: ")
        assert len(fault) < 400
