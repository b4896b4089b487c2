"""What a core tells of goals that it gives up: the stream that has no plan, from which the reasons follow."""

import pytest
from core_driver import Driver

from rosoclingo.oclingo.explaining.explainer import explain
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
