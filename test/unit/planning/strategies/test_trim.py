"""Trimming plans: superfluous actions and idle steps are removed."""

from types import SimpleNamespace

import pytest
from fake_grounding import actions

from rosoclingo.planning.history import cycle_of
from rosoclingo.planning.question import UNKNOWN, Reply, StoppedError
from rosoclingo.planning.strategies.trim import trimmed


def trim(horizon, cycles, *plans, step=0, first=1, advises=False, most=99):
    """Trim the plan with these ``cycles``; return cycles and horizon of the result, and the questions.

    ``plans`` are the valid plans as sets of cycles, with one action per cycle. Actions up to ``step`` stay. A stop
    comes after ``most`` questions.
    """
    runner = SimpleNamespace(
        program=SimpleNamespace(advises=advises), actions=lambda first, last: sorted(actions(*range(first, last + 1)))
    )
    asked, strategy = [], trimmed(Reply(True, (actions(*cycles),), horizon), runner, step, first)

    def reply_to(question):
        asked.append((question.first, question.last))
        lacked = {*map(cycle_of, question.lacking)}
        for some in plans:
            agrees = all((cycle_of(one) in some) == value for one, value in question.given)
            last = max([question.first, *some])
            if agrees and last <= question.last and not (lacked and lacked <= {*some}):
                return Reply(True, (actions(*some),), last)
        return UNKNOWN

    try:
        question = next(strategy)
        while True:
            stopped = len(asked) >= most
            question = strategy.throw(StoppedError()) if stopped else strategy.send(reply_to(question))
    except StopIteration as end:
        return sorted(map(cycle_of, end.value.answers[-1])), end.value.horizon, asked


@pytest.mark.parametrize(
    ("horizon", "plan", "plans", "options", "cycles", "last"),
    [
        (3, (1, 2, 3), [], {}, [1, 2, 3], 3),
        (3, (1, 2, 3), [(1, 3)], {}, [1, 3], 3),
        (3, (1, 2, 3), [(1, 3), (1, 2)], {}, [1, 2], 2),
        (4, (1, 2, 3, 4), [(1, 2, 4), (2, 4)], {}, [2, 4], 4),
        (4, (1, 2, 3, 4), [(2, 4), (1, 2)], {}, [1, 2], 2),
        # idle steps, also necessary ones and at the end
        (4, (2, 4), [(1, 3)], {}, [2, 4], 4),
        (4, (2, 4), [()], {}, [], 1),
        (5, (2, 4), [(2, 4)], {}, [2, 4], 4),
        (5, (2, 4), [(1, 2)], {}, [1, 2], 2),
        (5, (), [()], {}, [], 1),
        # the present step, and the lowest horizon of a plan
        (5, (1, 2, 4, 5), [(1, 2, 5), (1, 2, 3)], {"step": 2}, [1, 2, 3], 3),
        (5, (1, 2), [(1, 2)], {"first": 4}, [1, 2], 4),
        # stops
        (4, (1, 2, 3, 4), [(1, 2, 4), (2, 4), (1, 2)], {"most": 0}, [1, 2, 3, 4], 4),
        (4, (1, 2, 3, 4), [(1, 2, 4), (2, 4), (1, 2)], {"most": 1}, [1, 2, 4], 4),
        (4, (1, 2, 3, 4), [(1, 2, 4), (2, 4), (1, 2)], {"most": 2}, [2, 4], 4),
    ],
)
def test_trimmed_plans_have_no_superfluous_action(horizon, plan, plans, options, cycles, last):
    assert trim(horizon, plan, *plans, **options)[:2] == (cycles, last)


def test_trimmed_removes_only_idle_steps_with_heuristics():
    assert trim(3, (1, 2, 3), (1, 2), advises=True) == ([1, 2, 3], 3, [])
    assert trim(4, (1, 3), (1, 2), advises=True) == ([1, 2], 2, [(2, 2)])


def test_trimmed_asks_once_if_nothing_is_superfluous():
    assert trim(3, (1, 2, 3))[2] == [(1, 3)]
