"""The search for a shortest plan: which horizons it asks for, and when more steps are ground."""

import pytest
from fake_grounding import FakeGrounding

from rosoclingo.planning.strategies.shortest import shortest


def grounding(answers, **options):
    return FakeGrounding({horizon: [] for horizon in answers}, **{"most": 9, **options})


def run(world, models=1, hint=0, block=1):
    """Return what was found, None after a stop; and the questions."""
    found, asked = world.run(lambda asking: shortest(asking, models, hint), block)
    assert found is None or found.proven is (found.reply.satisfiable is True)
    return found, asked


@pytest.mark.parametrize(
    ("world", "settings", "horizon", "asked"),
    [
        (grounding([3]), {}, 3, "1..1! >2 2..2! >3 3..3!"),
        (grounding([3, 4]), {"block": 3}, 3, "1..1! >4 2..4 2..3 2..2"),
        (grounding([4], most=4), {"block": 8}, 4, "1..1! >4 2..4 2..3"),
        (grounding([2, 4], horizon=5), {"hint": 4}, 2, "1..3 1..1"),
        (grounding([5], horizon=5), {"hint": 4}, 5, "1..3 4..4 5..5"),
        (grounding([2, 5], horizon=5), {"hint": 1}, 2, "1..1 2..5 2..4"),
        (grounding([5], horizon=5), {"hint": 9}, 5, "1..4 5..5"),
        (grounding([1, 4], step=2, horizon=4), {}, 4, "2..2 3..4 3..3"),
    ],
)
def test_shortest_finds_the_least_horizon(world, settings, horizon, asked):
    found, questions = run(world, **settings)
    assert found.reply.satisfiable is True
    assert (found.reply.horizon, questions) == (horizon, asked)


@pytest.mark.parametrize(("models", "optimizes", "mark"), [(0, False, "!0"), (1, True, "!")])
def test_shortest_asks_for_the_best_at_the_least_horizon(models, optimizes, mark):
    found, questions = run(grounding([2, 3], optimizes=optimizes, horizon=3), models=models, block=2)
    assert (found.reply.horizon, questions) == (2, f"1..1 2..3 2..2 2..2{mark}")


@pytest.mark.parametrize(
    ("world", "settings", "satisfiable", "asked"),
    [
        (grounding([], most=3), {}, False, "1..1! >2 2..2! >3 3..3!"),
        (grounding([], horizon=4, most=4), {"hint": 2}, False, "1..1 2..2 3..4"),
        (grounding([], horizon=4, dead=2), {"hint": 2}, False, "1..1 2..2"),
        (grounding([9], dead=3), {}, False, "1..1! >2 2..2! >3 3..3!"),
        (grounding([4], horizon=4, halts=2, cut=True), {"hint": 2}, None, "1..1 2..2"),
        (grounding([], halts=1, cut=True, dead=1), {}, None, "1..1!"),
        (grounding([1], halts=0), {}, None, ""),
        (grounding([2, 3, 4], horizon=4, halts=2), {"hint": 1}, None, "1..1 2..4"),
    ],
)
def test_shortest_without_answer_or_after_a_stop(world, settings, satisfiable, asked):
    found, questions = run(world, **settings)
    assert (found and found.reply.satisfiable, questions) == (satisfiable, asked)
    assert found is None or found.reply.permanent == (world.dead is not None)
