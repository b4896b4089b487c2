"""The bench of goals that a blocked connection cuts off, with few goals."""

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).resolve().parents[3] / "bench"))

import cut_off  # noqa: E402


@pytest.mark.slow
@pytest.mark.once
def test_cut_off_bench_reports_missing_goals():
    seconds, reported = cut_off.cut_off(4, 4, seed=1)
    assert seconds > 0.0
    assert 0 < reported <= 4
