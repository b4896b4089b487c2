"""Failures that a program does not handle: an action that failed, with no replacement executed, meets no goal."""

import pytest
from core_driver import Driver, FaultyDriver
from core_programs import FAILED, STATUS, fetch
from core_scripts import play
from stream_replay import check_replay

from rosoclingo.reasoning.events import StateChanged

UNHEARD, CONTRADICTS = "which no rule of the program uses", "which contradicts the program"

#: Programs that cannot handle a failure, and why.
UNDECLARED = fetch().replace("#external _return/3.", "")
UNHANDLED = {
    "a constraint forbids it": (fetch(rules=FAILED + ":- failed(t).\n"), CONTRADICTS),
    "a constraint on the arm's return": (
        fetch(rules=":- _return(arm,V,t), not _action_lib(arm,V,t).\n"),
        CONTRADICTS,
    ),
    "no rule uses it": (fetch(), UNHEARD),
    "no rule uses that of the arm": (fetch(rules=FAILED.replace("(A,V,t)", "(legs,V,t)")), UNHEARD),
    "it is not declared": (UNDECLARED, UNHEARD),
    "it is declared for others": (UNDECLARED + "#external _return(legs,failed,t).\n" + FAILED, UNHEARD),
}


@pytest.fixture(params=sorted(UNHANDLED))
def name(request):
    return request.param


@pytest.fixture(params=["", STATUS], ids=["without statuses", "with statuses"])
def program(request, name):
    return UNHANDLED[name][0] + request.param


@pytest.mark.sampled(4)
def test_failed_only_action_aborts_its_goal(program, name):
    """The action counts as not executed: another goal needs it."""
    why = f"since arm(cup) returned failed in cycle 1, {UNHANDLED[name][1]}"
    driver = Driver(program)
    play(driver, f"goal a fetch(cup,1); fail failed; finish; is a aborted; says a fetch(cup,1) cannot be met {why}")
    assert driver.journal.actions == ["_action_lib(arm,cup,1)"]
    assert not any("held(cup," in str(one) for one in driver.journal.of(StateChanged)[-1].atoms)
    play(driver, "goal b fetch(cup,2)")
    assert driver.awaited
    play(driver, "finish; is b succeeded; goal c fetch(mug,3); finish; is c succeeded")
    check_replay(driver.program, driver.journal)


#: The programs, and the searches after which one can stop: three if no rule looks at the failure.
STOPPED = [(name, one) for name, (_, why) in UNHANDLED.items() for one in range(1, 6 if why == CONTRADICTS else 4)]


@pytest.mark.sampled(5)
@pytest.mark.parametrize(("name", "number"), STOPPED)
def test_failure_followed_by_a_stopped_search(program, number):
    play(FaultyDriver(program), f"goal a fetch(cup,1); leave {number}; fail failed; finish; is a aborted")


@pytest.mark.parametrize("rules", ["", FAILED + ":- failed(t).\n" + STATUS])
@pytest.mark.parametrize(
    ("returns", "ends"),
    [
        ("failed mug", "aborted succeeded"),
        ("cup failed", "succeeded aborted"),
        ("failed failed", "aborted aborted"),
    ],
)
def test_failure_of_some_of_concurrent_actions(rules, returns, ends):
    driver = play(Driver(fetch(one="", rules=rules)), "add a fetch(cup,1); goal b fetch(mug,2)")
    assert len(driver.awaited) == 2
    driver.facts(*(f"_return(arm,{value},1)" for value in returns.split())).finish()
    assert " ".join(driver.states(key)[-1] for key in "ab") == ends


def test_failures_are_handled_if_only_success_is_read():
    rules = "#external _now/1.\nmissed(t) :- _action_lib(A,X,t), _now(C), t < C, not _return(A,X,t).\n"
    play(
        Driver(fetch(", not missed(t)", rules=rules)),
        """
        goal a fetch(cup,1); facts _now(2) _return(arm,failed,1); finish; is a succeeded; done arm,cup,1 arm,cup,2""",
    )
