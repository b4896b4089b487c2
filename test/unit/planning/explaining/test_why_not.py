"""The text of explanations: the author's comments, steps, and whether longer plans could help."""

from itertools import count

import pytest
from stream_logs import stream_of

from rosoclingo.oclingo import ReactiveProgram
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.minimal_sets import UndecidedError

PROGRAM = """\
#program base.
start(a).  way(a,b).  way(b,c).
at(P,0) :- start(P).
#program cumulative(t).
#external _request/2.
#external shut/2.
wanted(P) :- _request(go(P),2).
{ _action_lib(go,B,t) : way(A,B), at(A,t-1) } 1 :- wanted(P), not at(P,t-1).
at(B,t) :- _action_lib(go,B,t).
at(A,t) :- at(A,t-1), not _action_lib(go,B,t) : way(A,B).

%! nobody walks through the shut door
%! to {B}
:- _action_lib(go,B,t),   % a walk
   shut(B,t).
%! what is asked for is forbidden
:- _request(go(d),2).

#program volatile(t).
%! not at {P} at the end
:- wanted(P), not at(P,t).
"""
GO = "_request(go(c),2)."
SHUT = f"{GO} " + " ".join(f"shut(c,{step})." for step in range(1, 6))


def why_not(facts, steps=4, text=PROGRAM, before=(), halt=lambda: False):
    return explain(ReactiveProgram.from_text(text, "walk.lp"), stream_of(f"#step 1. {facts}", steps, *before), halt)


def test_explanation_excludes_plans_of_any_length():
    found = why_not("_request(go(d),2).")
    assert found.never
    assert [one.words for one in found.rules] == ["what is asked for is forbidden"]
    assert found.text().startswith("No plan of at most 4 steps, and none of any length.\nThis rule excludes a plan:\n")


def why_not_after(looks):
    """Return the explanation found within ``looks`` polls of the stop, or None."""
    calls = count()
    try:
        return why_not(SHUT, halt=lambda: next(calls) >= looks)
    except UndecidedError:
        return None


@pytest.mark.slow
def test_explanation_is_incomplete_after_a_stop():
    assert why_not_after(0) is None
    total = next(2**number for number in count() if getattr(why_not_after(2**number), "complete", False))
    half = why_not_after(total // 2)
    assert not half.complete
    assert {one.rule.line for one in half.rules} >= {14, 21}
    assert "incomplete: out of time" in half.text()
