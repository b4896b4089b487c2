"""The delay after which facts affect actions."""

import pytest
from shipped import shipped

from rosoclingo.oclingo import ReactiveProgram

RULES = """
#external _request/2. #external low/1. #external far/1. #external fire/2. #external wet/2. #external quiet/1.
#external mood/1. #external seen/2. #external base_report/2.
#program base.
reported(X,C) :- base_report(X,C).
#program cumulative(t).
#external door(t).
{{ do(X,t) : _request(X,t+1) }} :- {condition}.
_action_lib(go,X,t) :- do(X,t).
at(X,t) :- do(X,t).
at(X,t) :- at(X,t-1), not do(a,t).
{constraint}
#program volatile(t).
:- quiet(t), not at(home,t).
"""


#: A returned action was executed even if a late fact contradicts it; the fact counts from the next cycle on.
EXECUTED_IF_RETURNED = """{ _action_lib(go,x,t) } :- late(x,t), _return(go,V,t).
old(t) :- late(x,t-1). :- old(t), _action_lib(go,x,t)."""


@pytest.mark.parametrize(
    ("predicate", "condition", "constraint", "delay"),
    [
        ("low/1", "not low(t)", "", 0),
        ("low/1", "#true", ":- _action_lib(go,X,t+1), low(t).", 1),
        ("low/1", "#true", "weak(t) :- low(t-1). weak(t) :- weak(t-1), not door(t). :- do(X,t), weak(t).", 1),
        ("fire/2", "#true", ":- fire(X,t), at(X,t).", 0),
        ("far/1", "#true", "near(t) :- far(T), T < t. :- near(t), do(X,t).", 1),
        ("far/1", "#true", "near(t) :- far(T), T <= t, t-T < 9. :- near(t), do(X,t).", 0),
        ("base_report/2", "#true", ":- reported(X,t-1), do(X,t).", 1),
        ("mood/1", "not mood(good)", "", None),
        (
            "late/2",
            "#true",
            EXECUTED_IF_RETURNED,
            1,
        ),
    ],
)
def test_delay_of_a_predicate_follows_its_rules(predicate, condition, constraint, delay):
    program = ReactiveProgram.from_text(RULES.format(condition=condition, constraint=constraint))
    name, arity = predicate.split("/")
    assert program.delay_of(name, int(arity)) == delay


@pytest.mark.parametrize("files", [("house.lp", "home.lp"), ("mailbot.lp", "office.lp")])
def test_observations_of_shipped_programs_have_delay_one(files):
    program = shipped(*files)
    expected = {"_blocked": 1, "_opened": 1, "_seen": 1 if "house.lp" in files else None}
    assert {name: program.delay_of(name, 3) for name in expected} == expected
