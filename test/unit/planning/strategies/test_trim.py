"""Trimming plans: superfluous actions and idle steps are removed."""

import pytest
from fake_grounding import FakeGrounding, actions

from rosoclingo.planning.history import cycle_of
from rosoclingo.planning.question import Reply
from rosoclingo.planning.strategies.trim import trimmed


def trim(horizon, cycles, *plans, step=0, first=1, **options):
    """Trim the plan with these ``cycles``; return cycles and horizon of the result, and the questions.

    ``plans`` are the valid plans as sets of cycles, with one action per cycle. Actions up to ``step`` stay.
    """
    first, found = max(first, step + 1), Reply(True, (actions(*cycles),), horizon)
    world = FakeGrounding([(max([first, *some]), some) for some in plans], step + 1, horizon, **options)
    result, asked = world.run(lambda runner: trimmed(found, runner, step, first), block=1)
    return sorted(map(cycle_of, result.answers[-1])), result.horizon, asked


@pytest.mark.parametrize(
    ("horizon", "plan", "plans", "options", "cycles", "last"),
    [
        (3, (1, 2, 3), [(1, 3)], {}, [1, 3], 3),
        (4, (1, 2, 3, 4), [(1, 2, 4), (2, 4)], {}, [2, 4], 4),
        (4, (1, 2, 3, 4), [(2, 4), (1, 2)], {}, [1, 2], 2),
        # idle steps, also necessary ones and at the end
        (4, (2, 4), [(1, 3)], {}, [2, 4], 4),
        (5, (2, 4), [(2, 4)], {}, [2, 4], 4),
        (5, (2, 4), [(1, 2)], {}, [1, 2], 2),
        # the present step, and the lowest horizon of a plan
        (5, (1, 2, 4, 5), [(1, 2, 5), (1, 2, 3)], {"step": 2}, [1, 2, 3], 3),
        (5, (1, 2), [(1, 2)], {"first": 4}, [1, 2], 4),
        # stops
        (4, (1, 2, 3, 4), [(1, 2, 4), (2, 4), (1, 2)], {"halts": 1}, [1, 2, 4], 4),
        (4, (1, 2, 3, 4), [(1, 2, 4), (2, 4), (1, 2)], {"halts": 3}, [2, 4], 4),
    ],
)
def test_trimmed_plans_have_no_superfluous_action(horizon, plan, plans, options, cycles, last):
    assert trim(horizon, plan, *plans, **options)[:2] == (cycles, last)


def test_trimmed_removes_only_idle_steps_with_heuristics():
    assert trim(3, (1, 2, 3), (1, 2), advises=True) == ([1, 2, 3], 3, "")
    assert trim(4, (1, 3), (1, 2), advises=True) == ([1, 2], 2, "2..2+1+2/1000")


def test_trimmed_removes_superfluous_actions_of_several_robots():
    assert trim(3, (1, 2, 3), (1, 3), advises=True, several=True)[0] == [1, 3]
    assert trim(3, (1, 2, 3), advises=True, several=True)[2] == "1..3/1000?"
