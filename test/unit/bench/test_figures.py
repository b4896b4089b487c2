"""How the benches' figures are written, collected and shown."""

import sys

import pytest
from figures import Figure, Option, Row, main, parse, read, rows, table

UPDATE, PACE = Figure("an update", 2.5, "ms"), Figure("pace", 60.0, "s per s", "higher")


def row(here, there, better="lower"):
    return Row("solver", "an update", "ms", better, tuple(here), tuple(there))


OPTIONS = {
    "goals": Option(300, "number of goals", 3),
    "plan_time": Option(1.0, "a time"),
    "kinds": Option(["free", "alone"], "kinds", choices=["free", "alone"]),
    "plain": Option(False, "a flag", True),
}


@pytest.mark.parametrize(
    ("words", "goals", "plain"),
    [
        ([], 300, False),
        (["--short", "--goals", "7"], 7, True),
        (["--goals", "7", "--plain"], 7, True),
    ],
)
def test_figures_short_form_replaces_only_defaults(words, goals, plain):
    options = parse("a bench", OPTIONS, words)
    assert (options.goals, options.plain) == (goals, plain)
    assert (options.plan_time, options.kinds) == (1.0, ["free", "alone"])


def test_figures_of_a_bench_are_printed_and_written(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(sys, "argv", ["bench", "--json", str(tmp_path / "figures")])
    main("a bench", lambda options: iter([UPDATE, PACE._replace(value=options.goals)]), **OPTIONS)
    assert read(tmp_path / "figures") == [UPDATE, PACE._replace(value=300.0)]
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert lines[:2] == [["an", "update", "2.5", "ms"], ["pace", "300", "s", "per", "s"]]


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
        ([2.18], [2.0], "lower", 1.09, ""),
        ([2.5], [2.0], "lower", 1.25, "worse"),
        ([1.0], [2.0], "lower", 0.5, "better"),
        ([8.0, 5.0], [4.0, 2.0], "higher", 2.0, "better"),
        ([3.0, 5.0], [2.0, 3.0], "lower", 1.5, "worse?"),
        ([3.0], [4.0], "higher", 0.75, "worse"),
        ([0.0], [0.0], "lower", 1.0, ""),
        ([1.0], [0.0], "lower", float("inf"), "worse"),
    ],
)
def test_figures_compare_best_with_best(here, there, better, ratio, mark):
    found = row(here, there, better)
    assert found.ratio == pytest.approx(ratio)
    assert found.mark == mark


def test_figures_table_of_two_versions():
    found = [row([3.0, 2.0, 4.0], [4.0, 5.0, 5.0]), Row("tours", "pace", "s per s", "higher", (50.0,), ())]
    assert table(found, "0123abcd").splitlines() == [
        "bench   figure     unit     best  median  0123abcd: best  median  ratio",
        "solver  an update  ms          2       3               4       5   0.50  better?",
        "tours   pace       s per s    50      50               -       -      -",
    ]
