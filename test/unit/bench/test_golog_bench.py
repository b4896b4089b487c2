"""The bench of control programs, with few blocks: all variants have plans of equal length that reach the end."""

import random

import golog
import pytest
from workloads import sized


@pytest.mark.slow
def test_golog_bench_control_knowledge_keeps_a_shortest_plan():
    dice = random.Random(3)
    for _ in range(sized(1, 3)):
        first, last = golog.towers(range(1, 6), dice), golog.towers(range(1, 6), dice)
        found = {kind: golog.plan_of(kind, golog.program_of(kind, first, last), 60.0)[0] for kind in golog.KINDS}
        assert len({len(moves) for moves in found.values()}) == 1, found
        for moves in found.values():
            golog.check(moves, first, last)
