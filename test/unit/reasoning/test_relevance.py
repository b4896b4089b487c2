"""Which requests the rules of a program can see, and suggestions for those that they cannot see."""

import pytest
from shipped import shipped

from rosoclingo.checking.lint.stream_lint import lint_stream
from rosoclingo.oclingo import ReactiveProgram, parse_atom
from rosoclingo.reasoning.relevance import RelevanceAnalysis

VISITS = """
#const depth = 3.
#program base.
room(hall). room(kitchen). room(R) :- cell(R,N), N < depth.
cell(pantry,1). cell(attic,5). number(1..9).
{ spare(den) }.
seen(R) :- _map(R).
#program cumulative(t).
#external _request/2. #external _map/1.
asked(R,t)    :- _request(visit(R),t+1).
wanted(R,t)   :- asked(R,t), room(R).
wanted(R,t)   :- wanted(R,t-1), not at(R,t-1).
both(A,B,t)   :- _request(both(A,B),t+1), room(A), room(B), A != B.
lots(N,t)     :- _request(lots(N),t+1), number(N), M = N-2, M > 3.
far(R,t)      :- _request(far(R),t+1), not room(R).
use(R,t)      :- _request(use(R),t+1), spare(R).
map(R,t)      :- _request(map(R),t+1), seen(R).
near(R,t)     :- _request(near(R),t+1), at(R,t-1).
early(t)      :- _request(early(X),2).
ever(X,t)     :- _request(ever(X),T), T <= t, 0 < t-T, t-T < 3.
twice(X,t)    :- _request(twice(X),2*t).
{ go(t)       :  _request(run((x;y;z)),t+1) }.
{ at(R,t) : room(R), _request(dash(R),t+1) } 1 :- wanted(_,t).
full(t)       :- 2 < #count { R : _request(count(R),t), room(R) }.
none(t)       :- one(t) : _request(cond(R),t), room(R).
stopped(t)    :- not _request(halt(home),t+1).
forgotten(R,t) :- forgotten(R,t-1), not _request(both(_,R),t+1).
_status(I,rejected,t) :- _request(text("abc",I),t).
:- _request(range(1..3),t).
:- _request(sum(X+1,X),t).
:- at(R,t), wanted(R,t), both(A,B,t), lots(N,t), far(R,t), stopped(t).
#show shown(R) : _request(shown(R),t).
#program volatile(t).
:- wanted(R,t), not at(R,t).
"""


@pytest.fixture(scope="module")
def visits():
    return RelevanceAnalysis(ReactiveProgram.from_text(VISITS, "visits.lp"))


def is_relevant(relevance, goal):
    return relevance.is_relevant(parse_atom(f"_request({goal},2)"))


@pytest.mark.parametrize(
    "goal",
    [
        *("visit(hall)", "visit(pantry)", "both(hall,kitchen)", "lots(7)", "far(mars)", "use(den)", "map(mars)"),
        *("near(mars)", "early(1)", "ever(a)", "twice(1)", "run(z)", "dash(hall)", "count(hall)"),
        *("cond(kitchen)", "halt(home)", 'text("abc",1)', "range(2)", "sum(3,2)"),
    ],
)
def test_relevance_accepts_requests_that_some_rule_sees(visits, goal):
    assert is_relevant(visits, goal)


@pytest.mark.parametrize(
    ("goal", "advice"),
    [
        ("vISIT(hALL)", "did you mean visit(hall)?"),
        ('visit("kitchen")', "did you mean visit(kitchen)?"),
        ("both(hall,hall)", "the conditions of visits.lp:13 exclude it"),
        ("both(hall,mars)", "mars is none of hall, kitchen, pantry"),
        ("use(hut)", "hut is none of den"),
        ("text(abc,1)", 'did you mean text("abc",1)?'),
        ("hall", None),
    ],
)
def test_relevance_rejects_requests_that_no_rule_sees(visits, goal, advice):
    assert not is_relevant(visits, goal)
    reported = visits.advice(parse_atom(f"_request({goal},2)"))
    assert reported == advice if advice else reported


@pytest.mark.mostly_slow
@pytest.mark.parametrize(
    ("files", "goals", "others"),
    [
        (["paper.lp"], ["goal(office3,office2,1)", 'goal(office3,office2,"mail")', "cancel(1)"], ["goal(1)"]),
        (["mailbot.lp", "office.lp"], ["goal(office3,office2,1)", "goal(office9,office2,1)"], ["gaol(a,b,1)"]),
        (["house.lp", "home.lp"], ["bring(bedroom,cup)", "bring(attic,cup)", 'bring(bedroom,"cup")'], ["bring(cup)"]),
    ],
    ids=lambda value: value[0] if isinstance(value, list) else None,
)
def test_relevance_of_the_shipped_programs(files, goals, others):
    relevance = RelevanceAnalysis(shipped(*files))
    assert [goal for goal in goals if not is_relevant(relevance, goal)] == []
    assert [goal for goal in others if is_relevant(relevance, goal)] == []


STEPS = "#external _request/2.\n#program cumulative(t).\n"


@pytest.mark.parametrize(
    ("rules", "goal"),
    [
        ("p(X,t) :- _request(do(X),t), known(X,t). known(X,t) :- _told(X,t). #external _told/2.", "do(it)"),
        ("#defined room/1. p(X,t) :- _request(do(X),t), not room(X).", "do(it)"),
        ("#minimize { 1,X : _request(do(X),t) }.", "do(it)"),
        ("p(X,Y,t) :- _request(do(X),t), pair(X,Y). pair(1..4,1..4). :- p(1,2,t).", "do(1)"),
    ],
)
def test_relevance_of_unusual_rules(rules, goal):
    assert is_relevant(RelevanceAnalysis(ReactiveProgram.from_text(STEPS + rules)), goal)


def test_relevance_checks_stream_for_excluded_base_facts():
    program = ReactiveProgram.from_text(VISITS, "visits.lp")
    stream = "#step 1.\n_request(visit(hall),2).\n_request(visit(attic),2).\n#end step.\n"
    found = [(one.line, one.message) for one in lint_stream(program, stream, "day.txt")]
    assert found == [(3, "no rule can ever see _request(visit(attic),2)")]
