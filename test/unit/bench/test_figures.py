"""How the benches' figures are written, collected and shown."""

import argparse
import json
import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[3] / "bench"))
# ruff: noqa: E402

from figures import Figure, FigureError, Row, number, parse, read, rows, table, turns, write

UPDATE, PACE = Figure("an update", 2.5, "ms"), Figure("pace", 60.0, "s per s", "higher")


def row(here, there, better="lower"):
    return Row("solver", "an update", "ms", better, tuple(here), tuple(there))


def command_line(monkeypatch, *words):
    monkeypatch.setattr(sys, "argv", ["bench", *words])
    parser = argparse.ArgumentParser()
    parser.add_argument("--goals", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    return parse(parser, goals=3)


@pytest.mark.parametrize(
    ("words", "goals"), [([], 300), (["--short"], 3), (["--short", "--goals", "7"], 7), (["--goals", "7"], 7)]
)
def test_figures_short_form_replaces_only_defaults(monkeypatch, words, goals):
    options = command_line(monkeypatch, *words)
    assert (options.goals, options.seed) == (goals, 1)


def test_figures_are_read_as_written(tmp_path):
    write(tmp_path / "figures", [UPDATE, PACE])
    assert read(tmp_path / "figures") == [UPDATE, PACE]
    first = json.loads((tmp_path / "figures").read_text().splitlines()[0])
    assert first == {"name": "an update", "value": 2.5, "unit": "ms", "better": "lower"}


def test_figures_are_not_written_without_a_file():
    write(None, [UPDATE])


@pytest.mark.parametrize(
    "line",
    [
        "median 3 ms",
        "[1]",
        "{}",
        '{"name": "a", "value": "3", "unit": "ms"}',
        '{"name": "a", "value": 3, "unit": "ms", "better": "more"}',
        '{"name": "a", "value": 3, "unit": "ms", "worst": 4}',
    ],
)
def test_figures_report_a_malformed_line(tmp_path, line):
    write(tmp_path / "figures", [UPDATE])
    with (tmp_path / "figures").open("a") as file:
        file.write(line + "\n")
    with pytest.raises(FigureError, match="figures:2: "):
        read(tmp_path / "figures")


def test_figures_alternate_between_both_sides():
    assert list(turns(["here", "there"], 3)) == ["here", "there"] * 3
    assert list(turns(["here"], 2)) == ["here", "here"]


def test_figures_collect_runs_by_name():
    here = [[UPDATE, PACE], [UPDATE._replace(value=2.0), PACE]]
    there = [[UPDATE._replace(value=3.0), Figure("gone", 1.0, "")]]
    assert rows("solver", here, there) == [
        Row("solver", "an update", "ms", "lower", (2.5, 2.0), (3.0,)),
        Row("solver", "pace", "s per s", "higher", (60.0, 60.0), ()),
        Row("solver", "gone", "", "lower", (), (1.0,)),
    ]


@pytest.mark.parametrize(
    ("here", "there", "better", "ratio", "mark"),
    [
        ([3.0, 2.0], [9.0, 2.0], "lower", 1.0, ""),
        ([2.18], [2.0], "lower", 1.09, ""),
        ([2.5], [2.0], "lower", 1.25, "worse"),
        ([1.0], [2.0], "lower", 0.5, "better"),
        ([1.0, 8.0], [4.0, 2.0], "higher", 2.0, "better?"),
        ([8.0, 5.0], [4.0, 2.0], "higher", 2.0, "better"),
        ([3.0, 5.0], [2.0, 3.0], "lower", 1.5, "worse?"),
        ([4.0, 5.0], [2.0, 3.0], "lower", 2.0, "worse"),
        ([3.0], [4.0], "higher", 0.75, "worse"),
        ([0.0], [0.0], "lower", 1.0, ""),
        ([1.0], [0.0], "lower", float("inf"), "worse"),
        ([1.0], [0.0], "higher", float("inf"), "better"),
    ],
)
def test_figures_compare_best_with_best(here, there, better, ratio, mark):
    found = row(here, there, better)
    assert found.ratio == pytest.approx(ratio)
    assert found.mark == mark


@pytest.mark.parametrize(("here", "there"), [([], [1.0]), ([1.0], [])])
def test_figures_missing_on_one_side_have_no_ratio(here, there):
    assert row(here, there).ratio is None
    assert row(here, there).mark == ""


@pytest.mark.parametrize(
    ("value", "text"),
    [(0, "0"), (0.01234, "0.0123"), (2.5, "2.5"), (99.94, "99.9"), (2189.4, "2189"), (123456.0, "123456")],
)
def test_figures_numbers_are_short(value, text):
    assert number(value) == text


def test_figures_table_of_one_version():
    assert table([row([3.0, 2.0, 4.0], [])]).splitlines() == [
        "bench   figure     unit  best  median",
        "solver  an update  ms       2       3",
    ]


def test_figures_table_of_two_versions():
    found = [row([3.0, 2.0, 4.0], [4.0, 5.0, 5.0]), Row("tours", "pace", "s per s", "higher", (50.0,), ())]
    assert table(found, "0123abcd").splitlines() == [
        "bench   figure     unit     best  median  0123abcd: best  median  ratio",
        "solver  an update  ms          2       3               4       5   0.50  better?",
        "tours   pace       s per s    50      50               -       -      -",
    ]
