"""Claims of a program that no plan of any length exists, which hold until the next update."""

from itertools import combinations

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from stream_play import planner_of, play
from workloads import sized

from rosoclingo.oclingo import parse_update

BOUND = sized(30, 60)

#: Rooms 0 to 4 in a row; door D, between rooms D and D+1, is shut from the cycle after ``_shut`` until ``_opened``.
ROW = """
#program base.
room(0..4).
at(0,0).
#program cumulative(t).
#external _request/2. #external _shut/2. #external _opened/2.
wanted(X,t) :- _request(go(X),t+1).
wanted(X,t) :- wanted(X,t-1), not reached(X,t-1), not dropped(X,t).
dropped(X,t) :- _request(cancel(X),t).
reached(X,t) :- wanted(X,t), at(X,t).
shut(D,t) :- _shut(D,t-1).
shut(D,t) :- shut(D,t-1), not _opened(D,t-1).
{ _action_lib(move,R+(-1;1),t) : at(R,t-1) } 1.
:- _action_lib(move,R,t), not room(R).
:- _action_lib(move,R,t), at(S,t-1), shut(D,t), D = (R+S-1)/2.
at(R,t) :- _action_lib(move,R,t).
at(R,t) :- at(R,t-1), not _action_lib(move,S,t) : S = -1..5.
#program volatile(t).
:- wanted(X,t), not reached(X,t).
"""
CLAIM = """
#program cumulative(t).
cut(X,t) :- wanted(X,t), at(R,t-1), shut(D,t), R <= D, D < X.
cut(X,t) :- wanted(X,t), at(R,t-1), shut(D,t), X <= D, D < R.
_steps(#sup,t) :- cut(X,t).
"""
SETTINGS = pytest.mark.parametrize("options", [{}, {"plan_time": 0.0}], ids=["shortest", "soon"])


def solver_of(claims, **options):
    return planner_of(ROW + (CLAIM if claims else ""), **options)


def update(solver, step, facts):
    return play(solver, f"#step {step} : {BOUND}. #closed {step - 1}. {facts}")


FACTS = st.one_of(
    st.builds("_shut({},{}).".format, st.integers(0, 3), st.integers(0, 5)),
    st.builds("_opened({},{}).".format, st.integers(0, 3), st.integers(0, 8)),
    st.builds("_request(go({}),{}).".format, st.integers(0, 4), st.integers(2, 6)),
    st.builds("_request(cancel({}),{}).".format, st.integers(0, 4), st.integers(1, 6)),
)
STREAMS = st.lists(st.lists(FACTS, max_size=3, unique=True).map(" ".join), min_size=1, max_size=4)


@pytest.mark.slow
@SETTINGS
@settings(max_examples=max(3, settings.default.max_examples // 5))
@example(["_request(go(3),2). _shut(1,0).", "", "_opened(1,2).", "_shut(2,3).", "_request(cancel(3),5)."])
@example(["_request(go(3),2). _shut(1,0). _opened(1,20)."])
@given(news=STREAMS)
def test_claims_do_not_change_any_answer(options, news):
    claiming, other = solver_of(True, **options), solver_of(False, **options)
    for step, facts in enumerate(news, 1):
        ours, theirs = (update(one, step, facts) for one in (claiming, other))
        assert ours.outcome is theirs.outcome
        assert options or ours.horizon == theirs.horizon
    last = parse_update(f"#step {len(news)} : {BOUND}. #endstep.")
    assumable = frozenset(head for facts in news for head in parse_update(f"{facts} #endstep.").heads)
    few = sorted(assumable)[:4]
    for disabled in (frozenset(some) for count in range(3) for some in combinations(few, count)):
        verdicts = [one.inquire(last, assumable, disabled).satisfiable for one in (claiming, other)]
        assert verdicts[0] == verdicts[1]
