"""Reasons in words: the author's, where there are some; steps; what is known of more than the bound."""

import pytest

from rosoclingo.oclingo import ReactiveProgram, parse_update
from rosoclingo.planning.explaining.explainer import explain
from rosoclingo.planning.explaining.named_rules import RuleKind
from rosoclingo.planning.explaining.questions import Stream
from rosoclingo.planning.explaining.relaxed_program import RelaxedProgram
from rosoclingo.planning.explaining.why_not import WhyNot, ranges
from rosoclingo.planning.history import History, Taken
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


def why_not(facts, steps=4, text=PROGRAM, log=None, halt=lambda: False):
    program = ReactiveProgram.from_text(text, "walk.lp")
    return explain(program, Stream(log or History(), parse_update(f"#step 1. {facts} #endstep."), steps), halt)


@pytest.mark.slow
def test_reasons_come_in_the_words_of_the_program():
    found = why_not("_request(go(c),2). shut(c,2). shut(c,1). shut(c,3). shut(c,4). shut(c,5).")
    assert (
        found.text()
        == """\
No plan of at most 4 steps; there may be a longer one.
These rules forbid it together:
  walk.lp:14:1: nobody walks through the shut door to c
      :- _action_lib(go,B,t),
         shut(B,t).
    at steps 2-5
    a plan without it breaks it at step 2 with B=c
  walk.lp:21:1: not at c at the end
      :- wanted(P), not at(P,t).
    at the end of the plan, whatever its length
    a plan without it breaks it at step 1 with P=c
given these facts:
  told: shut(c,2).
  told: shut(c,3).
  told: shut(c,4).
  told: shut(c,5).
without one of these there would be nothing to do:
  _request(go(c),2).
There would be a plan without walk.lp:14:
  _action_lib(go,b,1) _action_lib(go,c,2)
"""
    )


def test_what_no_number_of_steps_mends_is_never():
    found = why_not("_request(go(d),2).")
    assert found.never
    assert [one.words for one in found.rules] == ["what is asked for is forbidden"]
    assert found.text().startswith("No plan of at most 4 steps, and none of any length.\nThis rule forbids it:\n")


def test_too_few_steps_are_not_never():
    found = why_not("_request(go(c),2).", steps=0)
    assert not found.never
    assert found.last == 1
    assert why_not("_request(go(c),2).", steps=1) is None


def test_what_a_log_holds_counts_as_told():
    log = History().then(Taken(parse_update("#step 1. shut(b,1). shut(b,2). shut(b,3). #endstep."), 1))
    found = why_not("_request(go(c),2).", steps=2, log=log)
    assert [one.text for one in found.told] == ["_request(go(c),2).", "shut(b,1).", "shut(b,2)."]


def test_rules_without_any_constraint_may_have_no_answer():
    found = why_not("", text="#program base.\np. -p. q(1).\n#program cumulative(t).\n")
    assert found.rules == ()
    assert [one.text for one in found.facts] in ([], ["p.", "-p."])
    assert "No constraint forbids it" in found.text()


def test_a_fact_counts_only_if_the_facts_that_remain_need_it():
    """Without f(0), f(2) is enough: f(1) is needed as long as f(0) is there."""
    text = """\
#program base.
f(0). f(1). f(2).
bad :- f(0), f(1), f(2).
bad :- f(2), not f(0).
#program cumulative(t).
_action_lib(go,home,t) :- f(3).
#program volatile(t).
:- bad.
"""
    assert [one.text for one in why_not("", text=text).facts] == ["f(2)."]


@pytest.mark.slow
def test_a_stop_leaves_what_was_found():
    facts = "_request(go(c),2). shut(c,1). shut(c,2). shut(c,3). shut(c,4). shut(c,5)."
    with pytest.raises(UndecidedError):
        why_not(facts, halt=lambda: True)
    calls = iter(range(10**6))
    total = next(number for number in range(10**6) if _complete(facts, number))
    assert total > 0
    half = why_not(facts, halt=lambda: next(calls) > total // 2)
    assert not half.complete
    assert {one.rule.line for one in half.rules} >= {14, 21}
    assert "not all of it was found out in time" in half.text()


def _complete(facts, most):
    """Whether so many looks at the stop request are enough; only powers of two are tried."""
    if most & (most - 1):
        return False
    calls = iter(range(10**6))
    try:
        return why_not(facts, halt=lambda: next(calls) > most).complete
    except UndecidedError:
        return False


def test_a_reason_is_a_plain_value():
    found = why_not("_request(go(c),2). shut(c,2). shut(c,1). shut(c,3). shut(c,4). shut(c,5).")
    assert WhyNot.from_message(found.to_message()) == found


def test_ranges():
    assert ranges([1, 2, 3, 5, 7, 8]) == "1-3, 5, 7-8"
    assert ranges([]) == ""


def test_every_kind_of_rule_is_known_by_its_text():
    text = """\
#program base.
p(1..2). q(a;b).  :- p(X), q(Y), X > 7.
#program cumulative(t).
{ go(X,t) : p(X) } 1.  { free(t) }.
#count { 1 : s(1,t); 2 : s(2,t) } 1 :- go(1,t).
not s(X,t) :- go(X,t).  fine(t) :- p("%").
#program volatile(t).
:- not go(1,t), p(_).
"""
    relaxed = RelaxedProgram.of(ReactiveProgram.from_text(text))
    assert [(one.kind, one.line, one.text) for one in relaxed.rules] == [
        (RuleKind.FACT, 2, "p(1..2)."),
        (RuleKind.FACT, 2, "q(a)."),
        (RuleKind.FACT, 2, "q(b)."),
        (RuleKind.INTEGRITY, 2, ":- p(X), q(Y), X > 7."),
        (RuleKind.BOUND, 4, "{ go(X,t) : p(X) } 1."),
        (RuleKind.BOUND, 5, "#count { 1 : s(1,t); 2 : s(2,t) } 1 :- go(1,t)."),
        (RuleKind.INTEGRITY, 6, "not s(X,t) :- go(X,t)."),
        (RuleKind.VOLATILE, 8, ":- not go(1,t), p(_)."),
    ]
    assert [one.variables for one in relaxed.constraints] == [("X", "Y"), (), (), ("X",), ()]


@pytest.mark.slow
def test_where_no_rule_stands_in_the_way_something_may_be_missing():
    found = why_not("_request(go(e),2).")
    assert found.never
    assert [one.lacks for one in found.lacking[0].misses] == ["start(e)", "_action_lib(go,e,t)", "way(_,e)"]
    assert "lacks way(_,e), which is never true" in found.text()
    assert "No rule stands in the way" not in why_not("_request(go(d),2).").text()
