"""The core's state as values, and its problems as lines of a log."""

from types import SimpleNamespace

import pytest

from rosoclingo.oclingo import parse_atom, parse_term
from rosoclingo.reasoning.core_state import OK, WARN, describe_core
from rosoclingo.reasoning.events import Mode, PlanMade, Problem
from rosoclingo.reasoning.keywords import action_of
from rosoclingo.reasoning.log_throttle import FEW, MANY, QUIET, LogThrottle


def test_core_state_reports_the_same_problem_once():
    throttle = LogThrottle()
    assert (
        throttle.take(Problem(3, "'_return(a,1,2)' is ignored", "arm"), 0.0) == "cycle 3: '_return(a,1,2)' is ignored"
    )
    for number in range(50):
        assert throttle.take(Problem(3, f"'_return(a,1,{number})' is ignored", "arm"), 1.0) == ""
    assert throttle.count == 51
    assert throttle.latest == "cycle 3: '_return(a,1,49)' is ignored"
    assert throttle.take(Problem(3, "'_return(a,1,2)' is ignored", "leg"), 1.0)
    assert throttle.take(Problem(9, "'_return(a,1,2)' is ignored", "arm"), QUIET + 1.0)
    own = [throttle.take(Problem(9, f"update {number} is dropped"), QUIET + 1.0) for number in (3, 4, 4)]
    assert list(map(bool, own)) == [True, True, False], "texts of the core differ by numbers as well"


def test_core_state_counts_repeated_problems_of_a_kind():
    throttle, origin = LogThrottle(), "eye"
    texts = [f'Head _blocked({"x" * number},hall,"(") came too late' for number in range(1, 501)]
    said = [line for line in (throttle.take(Problem(7, text, origin), 0.1) for text in texts) if line]
    assert [line.split(";")[0] for line in said] == [f"cycle 7: {text}" for text in texts[:FEW]]
    assert said[-1].endswith("; more of this kind are only counted for a minute")
    assert throttle.take(Problem(7, "something else", origin), 0.2)
    assert throttle.counted(QUIET) == []
    assert throttle.counted(QUIET + 0.1) == [f"497 more of this kind in a minute, the last: cycle 7: {texts[-1]}"]
    assert throttle.counted(QUIET + 1.0) == [], "once"
    assert throttle.take(Problem(8, texts[0], origin), QUIET + 1.0)


def core(*awaited, lost=(), mode=Mode.RUNNING, fed=()):
    """Return the attributes of a core that diagnostics show."""
    actions = [action_of(parse_atom(text)) for text in awaited]
    goals = [SimpleNamespace(fed=one) for one in fed]
    interfaces = SimpleNamespace(lost=frozenset(map(parse_term, lost)))
    return SimpleNamespace(cycle=4, live_goals=goals, awaited=actions, interfaces=interfaces, mode=mode)


def test_core_state_makes_a_diagnostics_report():
    level, message, values = describe_core(core(), None, LogThrottle(), [], "", 0.0)
    assert (level, message, values["horizon"]) == (OK, "idle", 1)
    busy = core("_action_lib(a,b,4)", fed=[True, False])
    assert describe_core(busy, PlanMade(4, 7, (), 0.25, 0.5), LogThrottle(), ["c", "d"], "", 0.0) == (
        OK,
        "waits for _action_lib(a,b,4)",
        {
            "cycle": 4,
            "horizon": 7,
            "open goals": 2,
            "waiting goals": 1,
            "awaited actions": "_action_lib(a,b,4)",
            "interfaces": "c, d",
            "last solve time": "0.500",
            "last ground time": "0.250",
            "problems": 0,
            "last error": "",
            "mode": "running",
        },
    )


@pytest.mark.parametrize(
    ("state", "fault", "message"),
    [
        ({"mode": Mode.PAUSED}, "", "paused: idle"),
        ({"mode": Mode.STOPPED, "lost": ["r2", "r1"]}, "", "stopped: lost robots: r1, r2"),
        ({"mode": Mode.PAUSED, "lost": ["r1"]}, "no interface 'a'", "no interface 'a'"),
    ],
)
def test_core_state_warns_of_the_most_urgent_fault(state, fault, message):
    assert describe_core(core(**state), None, LogThrottle(), [], fault, 0.0)[:2] == (WARN, message)


def test_core_state_counts_problems_beyond_the_limit():
    throttle = LogThrottle()
    lines = [throttle.take(Problem(1, "x" * (number + 1)), 0.0) for number in range(100)]
    said = [line for line in lines if line]
    assert len(said) == MANY
    assert said[-1].endswith("only counted for a minute")
    assert throttle.take(Problem(1, "y", "leg"), 0.0), "of another origin"
    assert throttle.counted(QUIET) == [f"90 more of the core's own in a minute, the last: cycle 1: {'x' * 100}"]
    assert throttle.take(Problem(1, "z"), QUIET)
