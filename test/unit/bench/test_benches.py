"""The benches that have functions to call, with their smallest tasks and without other planners."""

import random
from argparse import Namespace

import comparison
import domains
import golog
import journal
import many_goals
import peers
import pytest

from rosoclingo.oclingo import ReactiveProgram

pytestmark = pytest.mark.slow


def test_bench_of_domains_has_valid_plans_of_planners():
    options = Namespace(seed=1, seconds=0.5, action_time=0.1, limit=60.0, lama_seconds=1.0)
    cells = domains.measure_row("crates", "small", options)
    assert cells["incmode"] == cells["best"] <= cells["improved"] <= cells["out"] <= cells["first"]
    assert cells["executed"] >= cells["best"]
    assert cells["first/lama"] is None, "it has simultaneous actions"


def test_bench_of_domains_leaves_cells_beyond_the_limit_empty(monkeypatch):
    monkeypatch.setattr(peers, "folder_of", lambda package: None)
    cells = domains.measure_row("tiles", "large", Namespace(seed=1, seconds=0.5, action_time=0.1, limit=1e-6))
    assert set(cells.values()) == {None}


def test_bench_of_many_goals_measures_a_batch(monkeypatch):
    monkeypatch.setattr(peers, "folder_of", lambda package: None)
    monkeypatch.setattr(comparison.CoreParameters, "plan_time", 0.05)
    once = many_goals.measure_row("4", 3, "once", Namespace(action_time=0.01, limit=60.0, seed=1))
    assert once["first"] == once["all"] >= once["executed"] == 12
    assert once["wait"] == 0


def test_bench_of_golog_has_plans_of_equal_length():
    dice = random.Random(3)
    first, last = golog.towers(range(1, 6), dice), golog.towers(range(1, 6), dice)
    found = {kind: golog.plan_of(kind, golog.program_of(kind, first, last), 60.0)[0] for kind in golog.KINDS}
    assert len({len(moves) for moves in found.values()}) == 1, found
    for moves in found.values():
        golog.check(moves, first, last)


def test_bench_of_journal_measures_run_and_resumed_cores(tmp_path):
    program = ReactiveProgram.from_files(journal.PROGRAM)
    figures = {one.name: one.value for one in journal.play(program, 2, 1, tmp_path)}
    assert {name.split(",")[0] for name in figures} == {"after 1 goals", "after 2 goals", "writing"}
    assert all(value > 0 for value in figures.values())
