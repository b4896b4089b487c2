"""Plans lose superfluous actions and idle steps."""

from types import SimpleNamespace

import pytest

from rosoclingo.oclingo import parse_atom
from rosoclingo.planning.history import cycle_of
from rosoclingo.planning.question import UNKNOWN, Reply, StoppedError
from rosoclingo.planning.strategies.trim import trimmed


def actions(*cycles):
    return frozenset(parse_atom(f"_action_lib(go,x,{cycle})") for cycle in cycles)


def found(horizon, *cycles):
    return Reply(True, (actions(*cycles),), horizon)


def some_asking(advises):
    """What the trimming knows of the grounding: any cycle has one action."""
    program = SimpleNamespace(advises=advises)
    return SimpleNamespace(program=program, actions=lambda first, last: sorted(actions(*range(first, last + 1))))


def trim(plan, *plans, step=0, first=1, advises=False, most=99):
    """Trim a plan where there are ``plans``, sets of cycles; return the cycles of the result, its horizon, questions.

    Only cycles after ``step`` have actions that can be left out. There is a stop after ``most`` questions.
    """
    asked, strategy = [], trimmed(plan, some_asking(advises), step, first)

    def reply_to(question):
        asked.append((question.first, question.last))
        assumed = {cycle_of(one): value for one, value in question.given}
        lacked = {*map(cycle_of, question.lacking)}
        for cycles in plans:
            agrees = all((cycle in cycles) == value for cycle, value in assumed.items())
            horizon = max([question.first, *cycles])
            if agrees and horizon <= question.last and not (lacked and lacked <= {*cycles}):
                return found(horizon, *cycles)
        return UNKNOWN

    try:
        question = next(strategy)
        while True:
            stopped = len(asked) >= most
            question = strategy.throw(StoppedError()) if stopped else strategy.send(reply_to(question))
    except StopIteration as end:
        return sorted(map(cycle_of, end.value.answers[-1])), end.value.horizon, asked


@pytest.mark.parametrize(
    ("plan", "plans", "cycles", "horizon"),
    [
        (found(3, 1, 2, 3), [], [1, 2, 3], 3),
        (found(3, 1, 2, 3), [(1, 3)], [1, 3], 3),
        (found(3, 1, 2, 3), [(1, 3), (1, 2)], [1, 2], 2),
        (found(4, 1, 2, 3, 4), [(1, 2, 4), (2, 4)], [2, 4], 4),
        (found(4, 1, 2, 3, 4), [(2, 4), (1, 2)], [1, 2], 2),
        (found(4, 2, 4), [(1, 3)], [2, 4], 4),
        (found(4, 2, 4), [()], [], 1),
        (found(5, 2, 4), [(2, 4)], [2, 4], 4),
        (found(5, 2, 4), [(1, 2)], [1, 2], 2),
        (found(5), [()], [], 1),
    ],
    ids=[
        "minimal",
        "one superfluous",
        "moved together",
        "two superfluous",
        "superfluous and idle",
        "idle but needed",
        "all superfluous",
        "idle at its end",
        "idle",
        "no action",
    ],
)
def test_trimmed_plans_hold_no_superfluous_action(plan, plans, cycles, horizon):
    assert trim(plan, *plans)[:2] == (cycles, horizon)


def test_trimmed_leaves_what_is_done_up_to_the_present():
    assert trim(found(5, 1, 2, 4, 5), (1, 2, 5), (1, 2, 3), step=2)[:2] == ([1, 2, 3], 3)


def test_trimmed_plans_end_no_sooner_than_any_plan_can():
    assert trim(found(5, 1, 2), (1, 2), first=4)[:2] == ([1, 2], 4)


def test_trimmed_trusts_programs_that_advise_but_for_idle_steps():
    assert trim(found(3, 1, 2, 3), (1, 2), advises=True) == ([1, 2, 3], 3, [])
    assert trim(found(4, 1, 3), (1, 2), advises=True) == ([1, 2], 2, [(2, 2)])


def test_trimmed_asks_nothing_more_where_nothing_is_superfluous_or_idle():
    assert trim(found(3, 1, 2, 3))[2] == [(1, 3)]


@pytest.mark.parametrize(("most", "cycles"), [(0, [1, 2, 3, 4]), (1, [1, 2, 4]), (2, [2, 4])])
def test_trimmed_returns_what_it_has_when_it_is_stopped(most, cycles):
    assert trim(found(4, 1, 2, 3, 4), (1, 2, 4), (2, 4), (1, 2), most=most)[0] == cycles
