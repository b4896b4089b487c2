"""Recorded streams get the recorded answers: a sample, or all with ROSOCLINGO_STREAMS=1000."""

import os
from statistics import median

import pytest
from recorded_streams import KINDS, LATE, PLANNED, first_plans, play, recorded, what_if, why

pytestmark = pytest.mark.slow
SAMPLE = int(os.environ.get("ROSOCLINGO_STREAMS", "8"))
FEW = 15  # in a sample this small, explanations are compared for all kinds except day


def streams(kind):
    """Return the sampled streams of a kind."""
    return [one for one in recorded()[:SAMPLE] if one["kind"] == kind]


@pytest.mark.parametrize("kind", KINDS)
def test_updates_get_the_recorded_answers(kind):
    """Plans of equal length can differ in their number of actions, so their total is compared."""
    before, now = 0, 0
    for record in streams(kind):
        for (update, *expected), found in zip(record["updates"], play(record)):
            if kind in PLANNED:
                before, now = before + (expected[2] or 0), now + (found[2] or 0)
                expected[2], found[2] = expected[2] is None, found[2] is None
            assert found == expected, (record.get("program"), update)
    assert now <= 1.05 * before or kind not in PLANNED


@pytest.mark.parametrize("kind", PLANNED)
def test_questions_get_the_recorded_verdicts(kind):
    for record in streams(kind):
        assert what_if(record) == record["verdicts"], record["updates"]
        if "why" in record and (SAMPLE > FEW or kind != "day"):
            assert why(record) in (record["why"], LATE), record["updates"]


def test_first_plans_are_not_longer_in_the_median():
    ratios = []
    for record in recorded()[: SAMPLE // 2]:
        for (_, _, shortest, *_), before, now in zip(record["updates"], record.get("first", ()), first_plans(record)):
            assert (before is None) == (now is None), record["updates"]
            if now is not None:
                assert now >= shortest, "no plan is shorter than the shortest"
                ratios.append(now / before)
    assert median(ratios) <= 1.0
