"""The bench of the journal, with few goals."""

import journal
import pytest

from rosoclingo.oclingo import ReactiveProgram


@pytest.mark.slow
def test_journal_bench_measures_run_and_resumed_cores(tmp_path):
    program = ReactiveProgram.from_files(journal.PROGRAM)
    figures = {one.name: one.value for one in journal.play(program, 2, 1, tmp_path)}
    assert figures["after 2 goals, largest files"] * 1000 >= (tmp_path / "journal.db").stat().st_size > 0
    assert {name.split(",")[0] for name in figures} == {"after 1 goals", "after 2 goals", "writing"}
    assert all(value > 0 for value in figures.values())
