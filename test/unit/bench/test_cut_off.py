"""The bench of goals that a blocked connection cuts off, with few goals."""

import cut_off
import pytest


@pytest.mark.slow
def test_cut_off_bench_reports_missing_goals():
    seconds, reported = cut_off.cut_off(4, 4, seed=1)
    assert seconds > 0.0
    assert 0 < reported <= 4
