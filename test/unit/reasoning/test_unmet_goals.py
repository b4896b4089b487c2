"""What a core tells of goals that it gives up: the stream that has no plan, from which the reasons follow."""

import re

import pytest
from core_driver import Driver

from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.reasoning import GoalUnmet

WALK = """
#program base.
way(a,b). way(b,c). at(a,0).
#program cumulative(t).
#external _request/2. #external _return/3. #external _shut/2.
wanted(P,I,t) :- _request(go(P,I),t+1), not _request(cancel(I),t).
wanted(P,I,t) :- wanted(P,I,t-1), not at(P,t-1), not _request(cancel(I),t).
{ _action_lib(go,B,t) : way(A,B), at(A,t-1) } 1 :- wanted(P,I,t).
at(B,t) :- _action_lib(go,B,t).
at(A,t) :- at(A,t-1), not moved(t).
moved(t) :- _action_lib(go,B,t).
shut(P,t) :- _shut(P,t).
shut(P,t) :- shut(P,t-1).
%! {B} is shut
:- _action_lib(go,B,t), shut(B,t), not _return(go,B,t).
#program volatile(t).
:- wanted(P,I,t), not at(P,t).
"""


@pytest.mark.slow
def test_a_goal_that_is_given_up_comes_with_its_stream():
    driver = Driver(WALK)
    driver.core.receive("sensor", ["_shut(c,now)"])
    driver.run()
    driver.core.add_goal("a", "go(c,1)")
    driver.core.add_goal("b", "go(d,2)")
    driver.run()
    unmet = {one.key: one for one in driver.journal.events if isinstance(one, GoalUnmet)}
    assert {key: str(one.term) for key, one in unmet.items()} == {"a": "go(c,1)", "b": "go(d,2)"}
    why = explain(driver.program, unmet["a"].stream)
    assert [one.words for one in why.rules] == ["c is shut", ""]
    assert "_shut(c,2)." in [one.text for one in why.told] or "_shut(c,1)." in [one.text for one in why.told]
    assert not any("go(d,2)" in one.text for one in why.told), "it is given up for itself"
    other = explain(driver.program, unmet["b"].stream)
    assert [one.rule.text for one in other.rules] == [":- wanted(P,I,t), not at(P,t)."]


def test_a_goal_that_is_met_has_no_reasons():
    driver = Driver(WALK)
    driver.core.add_goal("a", "go(c,1)")
    driver.run()
    assert not [one for one in driver.journal.events if isinstance(one, GoalUnmet)]


#: Goals ``fetch(Thing)``: things are known once they are seen, and taken off by ``_gone``; rooms may be shut.
FETCH = """
#external _request/2. #external _return/3. #external _thing/2. #external _gone/2. #external _shut/2.
#program cumulative(t).
thing(X,t) :- _thing(X,t).
thing(X,t) :- thing(X,t-1).
gone(X,t)  :- _gone(X,t).
gone(X,t)  :- gone(X,t-1).
shut(R,t)  :- _shut(R,t).
shut(R,t)  :- shut(R,t-1).
wanted(X,t) :- _request(fetch(X),t+1).
wanted(X,t) :- wanted(X,t-1), not fetched(X,t-1), not _request(cancel(X),t).
{ _action_lib(fetch,X,t) : thing(X,t), not gone(X,t) } 1 :- wanted(_,t), not shut(kitchen,t), not shut(hall,t).
fetched(X,t) :- _action_lib(fetch,X,t), not _return(fetch,failed,t).
#show _action_lib/3.
#program volatile(t).
:- wanted(X,t), not fetched(X,t).
"""

NOISE = [f"_thing(t{number},now)" for number in range(6)]


@pytest.mark.parametrize(
    ("facts", "named"),
    [
        (["_thing(mug,now)", "_gone(mug,now)"], ["_gone(mug,"]),
        ([*NOISE, "_thing(mug,now)", *NOISE, "_gone(mug,now)", *NOISE], ["_gone(mug,"]),
        (["_gone(mug,now)", *NOISE, "_thing(mug,now)"], ["_gone(mug,"]),
        (["_shut(kitchen,now)", "_thing(mug,now)"], ["_shut(kitchen,"]),
        (["_shut(kitchen,now)", "_gone(mug,now)", "_thing(mug,now)"], None),
        (["_thing(mug,now)", "_shut(hall,now)", "_shut(kitchen,now)", "_gone(mug,now)"], None),
        (["_gone(mug,now)", "_thing(cup,now)"], []),
        (NOISE, []),
        ([], []),
    ],
)
def test_unmet_goal_names_the_fact_though_it_needs_others(facts, named):
    driver = Driver(FETCH)
    for one in facts:
        driver.facts(one)
    message = driver.goal("a", "fetch(mug)").message("a")
    if named is None:  # of several that are each enough any one may be told
        assert re.match(
            r"fetch\(mug\) cannot be met since _(gone|shut)\(\w+,[0-9]+\) was told in cycle [0-9]+$", message
        )
    elif named:
        assert message.startswith(f"fetch(mug) cannot be met since {named[0]}"), message
        assert " and " not in message
    else:
        assert message == "fetch(mug) cannot be met: there is no plan of at most 8 steps"
