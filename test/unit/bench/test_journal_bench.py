"""The bench of the journal, with few goals."""

import sys
from argparse import Namespace
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[3] / "bench"))

import journal  # noqa: E402
from long_run import load  # noqa: E402

OPTIONS = Namespace(goals=4, batch=2, every=2, failures=0.0)


@pytest.mark.slow
@pytest.mark.once
def test_journal_bench_measures_run_and_resumed_cores(tmp_path, capsys):
    figures = {one.name: one.value for one in journal.play(*load("mailbot"), OPTIONS, tmp_path)}
    assert figures["largest files"] * 1000 >= (tmp_path / "journal.db").stat().st_size > 0
    assert figures["writing"] > 0
    assert [line.split(",")[0].split() for line in capsys.readouterr().out.splitlines()] == [
        ["goal", "2"],
        ["goal", "4"],
    ]
