"""Unusual YAML files: duplicate keys, words that YAML reads as values, and endless lines and lists."""

import pytest

from rosoclingo.interfaces.checking.yaml_places import YamlFile


def read(folder, text):
    path = folder / "labels.yaml"
    path.write_text(text, encoding="utf-8")
    return YamlFile(str(path), lambda reader: None)


@pytest.mark.parametrize(
    ("text", "places"),
    [
        ("hall: [1, 2]\nkitchen: [1, 2]\nhall: [3, 4]\n", [(3, 1, "hall is already in line 1")]),
        ("hall: {x: 1, y: 2,\n  x: 3}\n", [(2, 3, "x is already in line 1")]),
        ("- {title: a, title: b}\n", [(1, 14, "title is already in line 1")]),
        ("hall: &a {x: 1}\nkitchen: {<<: *a, x: 2}\n", []),
    ],
)
def test_yaml_places_report_duplicate_keys(tmp_path, text, places):
    found = read(tmp_path, text)
    assert found.faults == []
    assert len(found.doubles) == len(places)
    for one, (line, column, words) in zip(found.doubles, places):
        assert (one.line, one.column, one.kind) == (line, column, "configuration")
        assert words in one.message


def test_yaml_places_fault_points_to_effective_key(tmp_path):
    found = read(tmp_path, "hall: [1, 2]\nyes: [1, 2]\nhall: [x]\n")
    assert found.fault("hall: must be numbers", "configuration").line == 3
    assert found.fault("True: the name is not an ASP term", "configuration").line == 2


def test_yaml_places_nested_aliases_take_no_time(tmp_path):
    rows = ["a0: &a0 [x, x]", *(f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 25))]
    found = read(tmp_path, "\n".join(rows) + "\n")
    assert found.fault("a24: must be a pose", "configuration").line == 25
