"""The cycle: batching, idling, deferral, returns, cancels, time-outs, and the reported problems."""

import pytest
from core_driver import ERRANDS, DeferringSolver, Driver
from core_scripts import play, scripts

from rosoclingo.reasoning.events import GoalProgress
from rosoclingo.reasoning.keywords import LONGEST
from rosoclingo.reasoning.returns import MOST_FACTS
from rosoclingo.reasoning.settings import CoreSettings

#: Two arms act in the same cycle.
ARMS = """
#external _request/2. #external _return/3.
#program cumulative(t).
_action_lib(left,I,t) :- _request(both(I),t+1).
_action_lib(right,I,t) :- _request(both(I),t+1).
"""

#: Plans one action in cycle 2 without any goal, and reads no returns.
ALONE = "#program cumulative(t).\n_action_lib(wake,up,t) :- t = 2.\n#program volatile(t).\n:- t < 2.\n"

#: Reports the status ``told(Id)`` in the request's cycle or in each cycle, and none for ``asked(Id)``.
WORDS = """
#external _request/2. #external _seen/1.
#program cumulative(t).
_status(I,HOW,t) :- _request(told(I),WHEN).
#program volatile(t).
#show _action_lib/3. #show _status/3.
"""
AT_ONCE, UNDER_WAY = (
    WORDS.replace("HOW", how).replace("WHEN", when) for how, when in (("succeeded", "t"), ("accepted", "_"))
)

#: An errand ``go(Id)`` at every fourth cycle.
SELDOM = """
#external _request/2. #external _return/3. #external _seen/1.
#program cumulative(t).
{ _action_lib(go,I,t) : _request(go(I),_), t \\ 4 = 0 } 1.
done(I,t) :- _action_lib(go,I,t).
done(I,t) :- done(I,t-1).
done(I,t) :- _request(cancel(I),t).
:- _action_lib(go,I,t), done(I,t-1).
#program volatile(t).
:- _request(go(I),_), not done(I,t).
#program base.
#show _action_lib/3.
"""

#: The program, its settings, and the script.
CYCLES = {
    "arrivals while an action runs are batched in order": (ERRANDS, {}, """
        goal a do(walk,1); goal b do(run,2); goal c do(swim,3); cycle 1; facts _seen(ball); cancel a; succeed; cycle 2
        sends :- not _action_lib(walk,1,1). _request(do(run,2),3). _request(do(swim,3),3)...
        sends ... _request(cancel(1),2). _seen(ball). _return(walk,1,1)."""),
    "cycles without actions end at once if something is planned later": (SELDOM, {"horizon_limit": 5}, """
        goal 1 go(1); does go,1,4; finish; is 1 succeeded; sends :- not _action_lib(go,1,4). _return(go,1,4).
        goal 2 go(2); does go,2,8; finish; goal 3 go(3); finish; goal 4 go(4); does go,4,16; finish; goal 5 go(5)
        finish; is 5 succeeded; problems 0"""),
    "return that the program does not know ends the action": (ALONE, {}, """
        does wake,up,2; succeed; does; cycle 3; problem ...declares no external _return/3..."""),
    "goal without actions is judged in the cycle of its request": (AT_ONCE, {}, """
        goal a told(1); goal b asked(2); all a active succeeded
        says b no rule of the program can see asked(2): rules match told(I)"""),
    "program that rejects a goal hears of it with the next update": (UNDER_WAY.replace("accepted", "rejected"), {}, """
        goal a told(1); all a rejected; facts _seen(ball); sends _request(cancel(1),2). _seen(ball)."""),
    "rejected goal that is requested again is not cancelled": (UNDER_WAY.replace("accepted", "rejected"), {}, """
        goal a told(1); all a rejected; goal b told(1); sends _request(told(1),3)."""),
    "actions of a cycle are sent and awaited together": (ARMS, {}, """
        goal a both(1); does left,1,1 right,1,1; facts _return(right,failed,1); cycle 1
        facts _return(left,1,1); cycle 2; sends :- not _action_lib(left,1,1). :- not _action_lib(right,1,1)..."""),
    "action that does not return in time": (ERRANDS, {"action_timeout": 10.0}, """
        goal a do(walk,1); wait 9.9; cycle 1; wait 0.1; cycle 2; sends ..._return(walk,timeout,1).; problem ...10 s...
        finish; is a succeeded"""),
    "program that declares no requests": (ERRANDS.replace("_request/2.", "_request/1."), {}, """
        goal a do(walk,1); all a rejected; says a ...no external _request/2..."""),
    "malformed actions are reported and ignored": (ERRANDS + "_action_lib(odd,x,never).", {}, """
        goal a do(walk,1); finish; is a succeeded; problem ..._action_lib(odd,x,never)..."""),
    "warnings of the solver are reported": (ERRANDS.replace("_seen/1.", "_seen(1..2)."), {}, """
        facts _seen(3); problem Head _seen(3) has not been declared external. The entire rule will be ignored."""),
    "identities of live goals are unique": (ERRANDS, {}, """
        goal first do(walk,1); goal second do(run,1); says second the identifier '1' is in use: do(walk,1) has not ended
        goal first do(run,2); says first the goal handle 'first' is in use; succeed; goal third do(run,1)
        is third succeeded"""),
}  # fmt: skip


@scripts(CYCLES)
def test_core_cycle_follows_the_script(row):
    text, settings, script = row
    play(Driver(text, CoreSettings(**{"horizon_limit": 8, **settings})), script)


def test_core_defers_a_plan_for_limited_cycles_after_arrival():
    driver = Driver(settings=CoreSettings(horizon_limit=5), solver=lambda _program: DeferringSolver(), start=False)
    driver.begin().facts("_seen(ball)")
    assert driver.core.cycle == 5 + 1 + 5
    assert driver.problems == ["the plan was deferred 5 times in a row: it is dropped"] * 2


@pytest.mark.parametrize(
    ("fact", "reason"),
    [
        ("_return(walk,1,2)", "no action of cycle 2 is under way"),
        ("_return(swim,1,1)", "no action of 'swim'"),
        ("_return(walk,1)", "not of the form"),
        ("_return(walk,1,soon)", "not a positive integer"),
        *((fact, "reserved for the core") for fact in ("_request(do(run,9),2)", "_action_lib(walk,1,1)")),
        *((fact, "reserved for the core") for fact in ("_status(1,succeeded,1)", "_explain(1,tired,1)")),
        ("_cancel(walk,1,1)", "reserved for the core"),
        ("_unheard(1)", "declares no external _unheard/1"),
        *((fact, "1:") for fact in ("_seen(X)", "garbage(((", "")),
    ],
)
def test_core_reports_and_ignores_senseless_facts(fact, reason):
    driver = Driver().goal("a", "do(walk,1)").facts(fact, "_seen(ball)")
    (problem,) = driver.problems
    assert reason in problem
    assert f"'{fact}' from 'interface' is ignored" in problem
    driver.succeed()
    assert "_seen(ball)." in driver.journal.updates[1]
    assert driver.states("a")[-1] == "succeeded"


def test_core_limits_the_length_of_a_fact():
    longest = f'_seen("{"x" * (LONGEST - 9)}")'
    driver = Driver().facts(longest, longest.replace("x", "xx", 1))
    (problem,) = driver.problems
    assert f"is ignored: it is too long: write at most {LONGEST} characters" in problem
    assert len(problem) < 400
    assert f"{longest}." in driver.journal.updates[0]


def test_core_limits_the_number_of_facts_per_message():
    driver = Driver().facts(*(f"_seen({number})" for number in range(MOST_FACTS + 7)))
    assert driver.problems == [
        f"a message from 'interface' has {MOST_FACTS + 7} facts, only the first {MOST_FACTS} are accepted:"
        " send several messages"
    ]
    assert f"_seen({MOST_FACTS - 1})." in driver.journal.updates[0]
    assert f"_seen({MOST_FACTS})." not in driver.journal.updates[0]


def test_core_sends_feedback_after_each_answer():
    driver = Driver().goal("a", "do(walk,1)").goal("b", "do(run,2)").succeed()
    reported = [(one.key, one.cycle, len(one.actions), one.position) for one in driver.journal.of(GoalProgress)]
    assert reported == [("a", 1, 1, 0), ("a", 2, 2, 1), ("b", 2, 2, 1)]


def test_core_abandon_ends_every_goal():
    driver = Driver(settings=CoreSettings(horizon_limit=8, goals_at_once=1))
    driver.goal("a", "do(walk,1)").goal("b", "do(run,2)").core.abandon("is aborted: the core shuts down")
    assert driver.states("a")[-1] == driver.states("b")[-1] == "aborted", "also one that waits"
    assert "shuts down" in driver.message("a")
    driver.succeed()
    assert not driver.core.advance(2.0)
