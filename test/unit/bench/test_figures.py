"""How the benches' figures are written, compared and shown."""

import sys

import pytest
from figures import Figure, Option, main, read
from run import Row, table

UPDATE, PACE = Figure("an update", 2.5, "ms"), Figure("pace", 60.0, "s per s", "higher")


def row(here, there, better="lower"):
    return Row("solver", "an update", "ms", better, tuple(here), tuple(there))


def test_figures_of_a_bench_are_printed_and_written(monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(sys, "argv", ["bench", "--short", "--json", str(tmp_path / "figures")])
    goals = Option(300, "number of goals", 3)
    main("a bench", lambda options: iter([UPDATE, PACE._replace(value=options.goals)]), goals=goals)
    assert read(tmp_path / "figures") == [UPDATE, PACE._replace(value=3.0)]
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert lines[:2] == [["an", "update", "2.5", "ms"], ["pace", "3", "s", "per", "s"]]


@pytest.mark.parametrize(
    ("here", "there", "better", "ratio", "mark"),
    [
        ([2.18], [2.0], "lower", 1.09, ""),
        ([2.5], [2.0], "lower", 1.25, "worse"),
        ([8.0, 5.0], [4.0, 2.0], "higher", 2.0, "better"),
        ([3.0, 5.0], [2.0, 3.0], "lower", 1.5, "worse?"),
        ([0.0], [0.0], "lower", 1.0, ""),
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
