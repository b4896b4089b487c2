"""With preempt, an action under way that the new plan does not want is ended at once; any other is awaited as ever."""

from core_driver import ERRANDS, Driver, FaultyDriver

from rosoclingo.oclingo import SolverError
from rosoclingo.reasoning import ActionsPreempted, CoreSettings, Halt

#: A drive and an arm movement for each goal, in one cycle; the arm is of use only while the light is on.
TOGETHER = """
#external _request/2. #external _return/3.
#program cumulative(t).
#external _dark(t).
dim(t) :- _dark(t-1).
dim(t) :- dim(t-1).
open(I,t) :- _request(go(I),t+1), not gone(I,t).
open(I,t) :- open(I,t-1), not driven(I,t-1), not gone(I,t).
gone(I,t) :- _request(cancel(I),t).
_action_lib(drive,I,t) :- open(I,t).
_action_lib(arm,I,t) :- open(I,t), not dim(t).
failed(t) :- _return(drive,V,t), not open(V,t).
driven(I,t) :- open(I,t), not failed(t).
#program volatile(t).
:- open(I,t), not driven(I,t).
#program base.
#show _action_lib/3.
"""

#: One way leads through two actions, ``far`` and ``end``; when ``_open`` tells of a shorter one, ``near`` is enough,
#: and ``side(1..5)`` are as good as ``far``.
WAYS = """
#external _request/2. #external _return/3. #external _open/1.
#program cumulative(t).
asked(I,t) :- _request(go(I),t+1).
asked(I,t) :- asked(I,t-1).
{ _action_lib(far,I,t); _action_lib(end,I,t) : half(I,t-1); _action_lib(near,I,t) : _open(near);
  _action_lib(side(1..5),I,t) : _open(side) } 1 :- asked(I,t).
failed(A,t) :- _return(A,preempted,t).
half(I,t) :- _action_lib(far,I,t), not failed(far,t).
half(I,t) :- _action_lib(side(N),I,t), not failed(side(N),t).
half(I,t) :- half(I,t-1).
there(I,t) :- _action_lib(end,I,t), not failed(end,t).
there(I,t) :- _action_lib(near,I,t), not failed(near,t).
there(I,t) :- there(I,t-1).
#program volatile(t).
:- asked(I,t), not there(I,t).
#program base.
#show _action_lib/3.
"""


def driver(text=ERRANDS, preempt=True, **others):
    return Driver(text, CoreSettings(horizon_limit=8, preempt=preempt), **others)


def preempted(one):
    return [str(action.cancellation) for event in one.journal.of(ActionsPreempted) for action in event.actions]


def test_an_action_that_nobody_wants_any_more():
    one = driver().goal("a", "do(walk,1)").cancel("a")
    assert preempted(one) == ["_cancel(walk,1,1)"]
    assert one.awaited == ["_action_lib(walk,1,1)"], "its return is awaited"
    assert len(one.journal.updates) == 1
    one.run().facts("_seen(ball)")
    assert len(preempted(one)) == 1, "it is told once"
    one.facts("_return(walk,preempted,1)")
    assert one.states("a")[-1] == "preempted"
    assert one.awaited == []


#: The program hears which actions are ended, and no action returns ``preempted`` otherwise.
HEARS = (
    ERRANDS
    + """
#external _cancel/3.
#program cumulative(t).
:- _return(W,preempted,t), not _cancel(W,_,t).
"""
)


def test_a_program_may_hear_of_the_actions_that_are_ended():
    one = driver(HEARS).goal("a", "do(walk,1)").cancel("a")
    assert preempted(one) == ["_cancel(walk,1,1)"]
    one.facts("_return(walk,preempted,1)")
    assert one.states("a")[-1] == "preempted"
    assert one.problems == []
    assert one.journal.updates[-1].split()[2:-2] == [
        ":-",
        "not",
        "_action_lib(walk,1,1).",
        "_request(cancel(1),2).",
        "_cancel(walk,1,1).",
        "_return(walk,preempted,1).",
    ]


def test_a_place_named_preempted_is_not_taken_for_reached():
    one = driver().goal("a", "do(walk,preempted)").facts("_seen(ball)")
    assert preempted(one) == [], "were it ended now, it would have to begin again"
    assert one.succeed().states("a")[-1] == "succeeded"


def test_an_action_that_is_still_wanted():
    one = driver().goal("a", "do(walk,1)").goal("b", "do(run,2)").facts("_seen(ball)")
    assert preempted(one) == [], "another plan is as short, but none shorter"
    assert one.cancel("b").finish().states("a")[-1] == "succeeded"
    assert preempted(one) == []


def test_the_next_cycle_is_another_matter():
    one = driver().goal("a", "do(walk,1)").goal("b", "do(run,2)").cancel("a").facts("_return(walk,preempted,1)")
    assert one.awaited == ["_action_lib(run,2,2)"]
    one.cancel("b")
    assert preempted(one) == ["_cancel(walk,1,1)", "_cancel(run,2,2)"]


def test_one_of_two_actions():
    one = driver(TOGETHER).goal("a", "go(1)")
    assert one.awaited == ["_action_lib(arm,1,1)", "_action_lib(drive,1,1)"]
    one.facts("_dark(1)")
    assert preempted(one) == ["_cancel(arm,1,1)"]
    one.facts("_return(arm,preempted,1)")
    assert one.awaited == ["_action_lib(drive,1,1)"]
    one.cancel("a")
    assert preempted(one) == ["_cancel(arm,1,1)", "_cancel(drive,1,1)"]


def test_a_shorter_way_opens():
    one = driver(WAYS).goal("a", "go(1)")
    assert one.awaited == ["_action_lib(far,1,1)"]
    one.facts("_open(near)")
    assert preempted(one) == ["_cancel(far,1,1)"], "there is a plan with it, but not among the shortest"
    assert one.facts("_return(far,preempted,1)").awaited == ["_action_lib(near,1,2)"]


def test_ways_that_are_as_short_open():
    one = driver(WAYS).goal("a", "go(1)").facts("_open(side)")
    assert preempted(one) == []
    one.finish()
    assert [action.partition(",")[0] for action in one.journal.actions] == ["_action_lib(far", "_action_lib(end"]


def test_a_way_that_is_as_short_but_better_opens():
    one = driver(WAYS + ":~ _action_lib(far,I,C). [1,I,C]").goal("a", "go(1)").facts("_open(side)")
    assert preempted(one) == [], "there is a plan with it among the shortest"


def test_no_plan_begins_in_the_past():
    text = WAYS.replace(
        " 1 :- asked(I,t).", " :- asked(I,t).\n:- _action_lib(X,I,t), _action_lib(Y,I,t), X != Y, t > 1."
    )
    one = driver(text).goal("a", "go(1)")
    assert one.awaited == ["_action_lib(far,1,1)"]
    one.facts("_open(side)")
    assert preempted(one) == [], "a side in cycle 1 would be half the way"


def test_a_solver_that_refuses_the_thought():
    one = FaultyDriver(settings=CoreSettings(horizon_limit=8, preempt=True))
    one.fault = lambda update: SolverError("not this one") if "preempted" in str(update) else None
    one.goal("a", "do(walk,1)").cancel("a")
    assert preempted(one) == []
    assert one.succeed().states("a")[-1] == "preempted"


def test_a_program_that_does_not_know_the_return():
    text = ERRANDS.replace("#external _return/3.", "#external _return(walk,(1;failed),1..9).")
    one = driver(text).goal("a", "do(walk,1)").cancel("a")
    assert preempted(one) == []
    assert one.succeed().states("a")[-1] == "preempted"


def test_no_plan_preempts_nothing():
    one = driver().goal("a", "do(walk,1)").goal("b", "do(never,2)")
    assert preempted(one) == []
    assert one.finish().states("b")[-1] == "aborted"


def test_thinking_of_it_may_be_left_for_what_comes():
    halt = []
    one = driver(watch=lambda: lambda: halt[0] if halt else None)
    one.goal("a", "do(walk,1)")
    halt.append(Halt("the test", disturbed=True))
    one.cancel("a")
    assert preempted(one) == []
    halt.clear()
    one.run()
    assert preempted(one) == ["_cancel(walk,1,1)"]


def test_the_stream_is_not_touched():
    with_it, without = driver().goal("a", "do(walk,1)"), driver(preempt=False).goal("a", "do(walk,1)")
    for one in (with_it, without):
        one.cancel("a").goal("b", "do(run,2)").facts("_return(walk,preempted,1)").finish()
    assert with_it.journal.updates == without.journal.updates
    assert with_it.journal.actions == without.journal.actions
