"""Failures that a program cannot handle: no goal is met by an action that failed while nothing was done instead."""

import pytest
from core_driver import Driver, Leaving
from stream_replay import check_replay

from rosoclingo.reasoning import CoreSettings, Problem, StateChanged

#: Goals fetch(Thing,Id) for an arm that grasps: as the paper's programs, without statuses.
FETCH = """
#external _request/2. #external _return/3.
#program cumulative(t).
wanted(X,I,t) :- _request(fetch(X,I),t+1).
wanted(X,I,t) :- wanted(X,I,t-1), not have(X,t-1), not _request(cancel(I),t).
{ _action_lib(arm,X,t) : wanted(X,I,t) } 1.
have(X,t) :- have(X,t-1).
have(X,t) :- _action_lib(arm,X,t)HEEDED.
#program volatile(t).
:- wanted(X,I,t), not have(X,t).
#program base.
#show _action_lib/3. #show _status/3. #show held(X,t) : have(X,t). #defined _status/3.
#program cumulative(t).
"""

STATUS = """
_status(I,accepted,t) :- wanted(X,I,t).
_status(I,succeeded,t) :- wanted(X,I,t-1), have(X,t-1).
_status(I,canceled,t) :- _request(cancel(I),t), wanted(X,I,t-1), not have(X,t-1).
"""

FAILED = "failed(t) :- _return(A,V,t), not _action_lib(A,V,t).\n"

#: Programs that cannot handle a failure.
DEAF = FETCH.replace("HEEDED", "")
UNHANDLED = {
    "a constraint forbids it": DEAF + FAILED + ":- failed(t).\n",
    "a constraint on what the arm returns": DEAF + ":- _return(arm,V,t), not _action_lib(arm,V,t).\n",
    "no rule looks at it": DEAF,
    "no rule looks at that of the arm": DEAF + FAILED.replace("(A,V,t)", "(legs,V,t)"),
    "it is not declared": DEAF.replace("#external _return/3.", ""),
    "it is declared for others": DEAF.replace("#external _return/3.", "")
    + "#external _return(legs,failed,t).\n"
    + FAILED,
}

#: A program that takes failures.
HEEDS = FETCH.replace("HEEDED", ", not failed(t)") + FAILED

UNHEARD, CONTRADICTS = "which no rule of the program looks at", "which contradicts the program"


def why(name):
    return CONTRADICTS if name.startswith("a constraint") else UNHEARD


@pytest.fixture(params=sorted(UNHANDLED))
def name(request):
    return request.param


@pytest.fixture(params=["", STATUS], ids=["without statuses", "with statuses"])
def program(request, name):
    return UNHANDLED[name] + request.param


def test_a_goal_whose_only_action_failed_is_aborted(program, name):
    driver = Driver(program).goal("a", "fetch(cup,1)").fail("failed").finish()
    assert driver.message("a") == f"fetch(cup,1) cannot be met since arm(cup) returned failed in cycle 1, {why(name)}"
    assert driver.states("a")[-1] == "aborted"
    assert driver.goal("b", "fetch(mug,2)").finish().states("b")[-1] == "succeeded"
    check_replay(driver.program, driver.journal)


def test_the_failed_action_counts_as_not_done(program):
    driver = Driver(program).goal("a", "fetch(cup,1)").fail("failed").finish()
    assert driver.journal.actions == ["_action_lib(arm,cup,1)"]
    assert not any("held(cup," in str(one) for event in driver.journal.of(StateChanged)[-1:] for one in event.atoms)
    driver.goal("b", "fetch(cup,2)")
    assert driver.awaited, "what failed has to be done"
    assert driver.finish().states("b")[-1] == "succeeded"


def test_goals_that_do_not_need_the_failed_action_go_on(program):
    driver = Driver(program)
    for key, goal in (("a", "fetch(cup,1)"), ("b", "fetch(mug,2)"), ("c", "fetch(jug,3)")):
        driver.core.add_goal(key, goal)
    failed = str(driver.run().core.awaited[0].parameter)
    driver.fail("failed").finish()
    ends = {key: driver.states(key)[-1] for key in "abc"}
    assert ends.pop({"cup": "a", "mug": "b", "jug": "c"}[failed]) == "aborted"
    assert set(ends.values()) == {"succeeded"}
    done = [one for one in driver.journal.actions if f"arm,{failed}," not in one]
    assert len(done) == 2, "each was fetched"


def test_an_action_that_never_returns_has_failed(program, name):
    driver = Driver(program, CoreSettings(horizon_limit=8, action_timeout=10.0)).goal("a", "fetch(cup,1)")
    driver.now = 20.0
    driver.run().facts("_return(arm,cup,1)").finish()
    assert driver.message("a").endswith(f"since arm(cup) returned timeout in cycle 1, {why(name)}")


@pytest.mark.parametrize("number", range(1, 6))
def test_a_failure_after_which_the_search_is_left(program, number):
    watch = Leaving()
    driver = Driver(program, watch=watch).goal("a", "fetch(cup,1)")
    watch.number = number
    driver.fail("failed").finish()
    assert driver.states("a")[-1] == "aborted"


#: Two arms at once, which fail without a name.
JOINT = """
#external _request/2. #external _return/3.
#program cumulative(t).
wanted(X,I,t) :- _request(fetch(X,I),t+1).
wanted(X,I,t) :- wanted(X,I,t-1), not have(X,t-1), not _request(cancel(I),t).
{ _action_lib(arm,X,t) : wanted(X,I,t) }.
have(X,t) :- have(X,t-1).
have(X,t) :- _action_lib(arm,X,t).
#program volatile(t).
:- wanted(X,I,t), not have(X,t).
#program base.
#show _action_lib/3. #show _status/3. #defined _status/3.
#program cumulative(t).
"""


@pytest.mark.parametrize("status", ["", STATUS])
@pytest.mark.parametrize("rules", ["", FAILED + ":- failed(t).\n"])
@pytest.mark.parametrize(
    ("returns", "ends"),
    [
        ("failed(cup) mug", "aborted succeeded"),
        ("failed mug", "aborted succeeded"),
        ("cup failed", "succeeded aborted"),
        ("failed(cup) failed(mug)", "aborted aborted"),
        ("failed failed", "aborted aborted"),
    ],
)
def test_actions_at_once_of_which_some_fail(status, rules, returns, ends):
    driver = Driver(JOINT + rules + status)
    for key, goal in (("a", "fetch(cup,1)"), ("b", "fetch(mug,2)")):
        driver.core.add_goal(key, goal)
    assert len(driver.run().awaited) == 2
    driver.facts(*(f"_return(arm,{value},1)" for value in returns.split())).finish()
    assert " ".join(driver.states(key)[-1] for key in "ab") == ends


#: A program whose goals have no condition: their actions are done once.
ONCE = """
#external _request/2. #external _return/3.
#program cumulative(t).
ACTS :- _request(do(I),t+1).
#program base.
#show _action_lib/3.
"""


@pytest.mark.parametrize("acts", ["_action_lib(arm,I,t)", "{ _action_lib(arm,I,t) } = 1"])
@pytest.mark.parametrize("constraint", ["", "#program cumulative(t).\n:- _return(A,V,t), not _action_lib(A,V,t).\n"])
def test_where_the_action_has_to_have_been_done_the_goal_is_aborted(acts, constraint):
    driver = Driver(ONCE.replace("ACTS", acts) + constraint).goal("a", "do(1)").fail("failed").finish()
    assert driver.states("a")[-1] == "aborted"
    assert driver.goal("b", "do(2)").finish().states("b")[-1] == "succeeded"


def test_failures_that_the_program_takes_are_none_of_these():
    driver = Driver(HEEDS + STATUS).goal("a", "fetch(cup,1)").fail("failed").fail("failed").finish()
    assert driver.states("a")[-1] == "succeeded"
    assert driver.journal.of(Problem) == []


def test_a_program_that_asks_for_success_alone_takes_failures():
    text = FETCH.replace("HEEDED", ", not missed(t)") + (
        "#external _now/1.\nmissed(t) :- _action_lib(A,X,t), _now(C), t < C, not _return(A,X,t).\n"
    )
    driver = Driver(text).goal("a", "fetch(cup,1)")
    driver.facts("_now(2)", "_return(arm,failed,1)").finish()
    assert driver.states("a")[-1] == "succeeded"
    assert len(driver.journal.actions) == 2
